// Planned torques while the robot runs the plan, for comparison with measured torques.

/** The current run: joint positions at its start; by the clock of the drive, the time of the last
    sample there, and the time at which the plan began. */
const watched = { from_rad: null, rested_s: null, left_s: null };

/** Joint deviation from the start, in rad, that counts as departure: more than noise. */
const LEFT_RAD = 2e-3;

const minus = (a, b) => a.map((v, j) => v - b[j]);
const farthest = (a, b) => Math.max(...minus(a, b).map(Math.abs));

/** Registers the start or the end of a run. A page that is opened during a run cannot determine its
    progress. */
function watchRun(isRunning) {
  const START_RAD = 0.02;
  const [q, start] = [live.newest?.joints_rad, desk.plan?.start_rad];
  const isAtStart = isRunning && q && start && farthest(q, start) < START_RAD;
  watched.from_rad = isAtStart ? q : null;
  watched.rested_s = live.newest?.t_s ?? null;
  watched.left_s = null;
}

/** Time of the plan, in s, at which it is nearest to `q`: from its start to `within_s` after its
    departure. The first sample after the departure is late if the page was busy. */
function timeAt(plan, q, within_s) {
  const { t_s, q_rad, count } = plan.arms[0].poses;
  const at = (i) => Array.from(q_rad.subarray(7 * i, 7 * i + 7));
  const dot = (a, b) => a.reduce((sum, v, j) => sum + v * b[j], 0);
  let [time, nearest, departure] = [0, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  for (let i = 0; i + 1 < count && t_s[i] <= departure + within_s; i++) {
    const [from, to] = [at(i), at(i + 1)];
    if (farthest(to, at(0)) > LEFT_RAD) departure = Math.min(departure, t_s[i + 1]);
    const [way, off] = [minus(to, from), minus(q, from)];
    const square = dot(way, way);
    const share = square > 0 ? Math.min(Math.max(dot(way, off) / square, 0), 1) : 0;
    const apart = farthest(
      off,
      way.map((v) => share * v),
    );
    if (apart < nearest) [time, nearest] = [t_s[i] + share * (t_s[i + 1] - t_s[i]), apart];
  }
  return time;
}

/** Planned joint torques, in Nm, with the robot at `q` at a time of the drive; NaN while the robot
    does not run the plan. */
function plannedTorques(t, q) {
  const unknown = Array(7).fill(Number.NaN);
  const { plan } = desk;
  if (!plan || !watched.from_rad) return unknown;
  if (watched.left_s === null) {
    if (farthest(q, watched.from_rad) <= LEFT_RAD) {
      watched.rested_s = t;
      return unknown;
    }
    watched.left_s = t - timeAt(plan, q, t - watched.rested_s);
  }
  const [at, { torque }] = [t - watched.left_s, plan.arms[0]];
  const { t_s, low, high } = torque;
  if (!t_s.length || at > t_s[t_s.length - 1]) return unknown;
  const i = Math.max(countUpTo(t_s, at) - 1, 0);
  return unknown.map((_, j) => (low[7 * i + j] + high[7 * i + j]) / 2);
}
