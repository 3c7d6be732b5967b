// Planned torques while the robot runs the plan, for comparison with measured torques.

/** The current run: joint positions at its start, and the time of departure by the drive clock. */
const watched = { from_rad: null, left_s: null };

/** Joint deviation from the start, in rad, that counts as departure: more than noise. */
const LEFT_RAD = 2e-3;

const farthest = (a, b) => Math.max(...a.map((v, j) => Math.abs(v - b[j])));

/** Registers the start or the end of a run. A page that is opened during a run cannot determine its
    progress. */
function watchRun(isRunning) {
  const START_RAD = 0.02;
  const [q, start] = [live.newest?.joints_rad, desk.plan?.start_rad];
  const isAtStart = isRunning && q && start && farthest(q, start) < START_RAD;
  [watched.from_rad, watched.left_s] = [isAtStart ? q : null, null];
}

/** Time, in s, at which the plan has moved by `LEFT_RAD` from its start. */
function leavesAt(plan) {
  const { poses, end_s } = plan.arms[0];
  const at = (i) => Array.from(poses.q_rad.subarray(7 * i, 7 * i + 7));
  for (let i = 1; i < poses.count; i++) if (farthest(at(i), at(0)) > LEFT_RAD) return poses.t_s[i];
  return end_s;
}

/** Planned joint torques, in Nm, with the robot at `q` at a time of the drive; NaN while the robot
    does not run the plan. */
function plannedTorques(t, q) {
  const unknown = Array(7).fill(Number.NaN);
  const { plan } = desk;
  if (!plan || !watched.from_rad) return unknown;
  if (watched.left_s === null) {
    if (farthest(q, watched.from_rad) <= LEFT_RAD) return unknown;
    watched.left_s = t - leavesAt(plan);
  }
  const [at, { torque }] = [t - watched.left_s, plan.arms[0]];
  const { t_s, low, high } = torque;
  if (!t_s.length || at > t_s[t_s.length - 1]) return unknown;
  const i = Math.max(countUpTo(t_s, at) - 1, 0);
  return unknown.map((_, j) => (low[7 * i + j] + high[7 * i + j]) / 2);
}
