// What the plan's joints exert while the robot runs it, beside what is measured.

/** The run that is under way: where the arm stood when it was begun, and when it left, by the drive's clock. */
const watched = { from_rad: null, left_s: null };

/** The arm has left where it stood once a joint is this far away, in rad: more than noise. */
const LEFT_RAD = 2e-3;

const farthest = (a, b) => Math.max(...a.map((v, j) => Math.abs(v - b[j])));

/** Notes that a run begins, or that none is under way. A page that is opened in the middle of one cannot tell how far it is. */
function watchRun(isRunning) {
  const START_RAD = 0.02;
  const [q, start] = [live.newest?.joints_rad, desk.plan?.start_rad];
  const isAtStart = isRunning && q && start && farthest(q, start) < START_RAD;
  [watched.from_rad, watched.left_s] = [isAtStart ? q : null, null];
}

/** How long after its beginning the plan leaves its start as far, in s. */
function leavesAt(plan) {
  const { poses, end_s } = plan.arms[0];
  const at = (i) => Array.from(poses.q_rad.subarray(7 * i, 7 * i + 7));
  for (let i = 1; i < poses.count; i++) if (farthest(at(i), at(0)) > LEFT_RAD) return poses.t_s[i];
  return end_s;
}

/** What the plan's joints exert while the robot is at `q` at a time of the drive, in Nm; not numbers while it runs no plan. */
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
