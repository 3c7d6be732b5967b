//! All tuned numbers of the jerk-limited solver.
//!
//! They trade the solver's time against how close it comes to the optimum and to the limits. How they were
//! found: each was varied by itself, by factors of 1.5 to 3 either way, over the reference programs of an
//! independent solver and some thousand random programs, and stands where the duration had stopped to fall
//! (to within 1e-4) while the number of steps or cells had not yet begun to rise. None is a property of the
//! robot: lengths are relative to segments, times relative to how long jerk takes to build up acceleration.

use iiwa_program::ByKind;

/// The settings of the solver, with a value each in [`SETTINGS`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) mesh: MeshSettings,
    pub(crate) interior_point: InteriorPointSettings,
    pub(crate) refinement: RefinementSettings,
    pub(crate) window: WindowSettings,
}

/// Sizes of cells, each relative to what it is a share of. Smaller is finer; all are in (0, 1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshSettings {
    /// Duration of a cell where the acceleration-limited stamps switch from one limit to another, as a share
    /// of the time in which jerk builds up acceleration there.
    pub(crate) switch: f64,
    /// Growth of that duration per time from the switch.
    pub(crate) fade: f64,
    /// Length of a cell in a blend, as a share of the blend.
    pub(crate) blend: f64,
    /// Length of a cell at a blend's ends, as a share of the blend; on the neighbouring line as well.
    pub(crate) blend_end: f64,
    /// Growth of that length per distance from the end.
    pub(crate) blend_end_growth: f64,
    /// Length of a cell on a line, as a share of the line.
    pub(crate) line: f64,
    /// Length of a cell in the middle of a blend that turns back, as a share of the distance on which it does.
    pub(crate) turn: f64,
    /// Growth of that length per distance from the middle.
    pub(crate) turn_growth: f64,
    /// Length of a cell that touches rest, as a share of the distance on which jerk builds up acceleration.
    pub(crate) rest: f64,
    /// Growth of that length per distance from rest.
    pub(crate) rest_growth: f64,
    /// What the curve's bend adds to jerk in such a cell at most, as a share of the limit.
    pub(crate) rest_bend: f64,
    /// Length of a cell with further limits, in rad: inertia and gravity, for example, change along it.
    pub(crate) row_rad: f64,
    /// Jump of d2s/dt2 that counts as a switch in a blend, as a share of its largest value there.
    pub(crate) switch_jump: f64,
    /// Most nodes of a segment; some tens are usual. A guard against stamps without sense.
    pub(crate) most_nodes: usize,
}

/// The primal-dual interior-point method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InteriorPointSettings {
    /// Share of the distance to the boundary that a step goes at most, in (0, 1).
    pub(crate) to_boundary: f64,
    /// Share of x that a step may take away, in (0, 1).
    pub(crate) largest_decrease: f64,
    /// Least share of itself that a step leaves of a slack or a dual.
    pub(crate) least_share: f64,
    /// How many times as long as the common step to the boundary slacks and x go, and duals: each stops at a
    /// boundary of its own.
    pub(crate) beyond: [f64; 2],
    /// Largest x to start from, as a multiple of what jerk allows at a steady speed.
    pub(crate) start_jerk: f64,
    /// Growth of x next to such a place, as a share of what constant jerk makes it.
    pub(crate) start_growth: f64,
    /// Start without a solution near by.
    pub(crate) cold: WarmStart,
    /// Centring: mu aims at this share of the present gap, for steps of at least the length beside it. Long
    /// steps are far from the boundary and may aim closer to it.
    pub(crate) centring: [(f64, f64); 3],
    /// Share of the final gap below which mu is not lowered.
    pub(crate) least_mu: f64,
    /// Duality gap, relative to the duration, at which the problem counts as solved.
    pub(crate) gap: f64,
    /// Duality gap at which limits are checked for the first time.
    pub(crate) first_gap: f64,
    /// The same where x does not settle at that gap, because some segment takes less of the time than it.
    pub(crate) last_gap: f64,
    /// Largest residual of a limit, relative to its bound, at which the problem counts as solved.
    pub(crate) residual: f64,
    /// Least primal step length at which it does.
    pub(crate) last_step: f64,
    /// Share of gap and residual at which a problem with further limits does, whatever its last step.
    pub(crate) closer: f64,
    /// Most steps.
    pub(crate) steps: usize,
    /// Steps after which they are halved: where the curvature is a bound of the true one, they may cycle.
    pub(crate) patience: usize,
    /// Step length below which a step counts as stalled, and the most of them in a row.
    pub(crate) stalled: (f64, usize),
    /// Least share of the duration's curvature that is kept where the duals would make it vanish.
    pub(crate) kept_curvature: f64,
    /// Lines between two blends that are shorter than this share of the cells on either side have no limits
    /// of their own.
    pub(crate) sliver: f64,
    /// Bound of jerk in the middle of cells in curves, of the limit: what keeps it at both ends may overshoot
    /// a little in between.
    pub(crate) mid_jerk: f64,
}

/// Where slacks and duals start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WarmStart {
    /// Their products, as a share of what balances with the duration.
    pub(crate) mu: f64,
    /// Least slack, as a share of the bound.
    pub(crate) slack: f64,
    /// Factor by which duals may be off what balances with their slacks, at least 1: duals that are near to a
    /// solution are worth keeping.
    pub(crate) kept: f64,
}

/// How cells are brought below the limits between the places at which the solver keeps them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefinementSettings {
    /// Largest shares of the limits that are handed out.
    pub(crate) tolerance: ByKind<f64>,
    /// Shares from which on a cell's limits are lowered early, when the first check finds them: below the
    /// tolerance, for what is near to it then may be above it in the end.
    pub(crate) early: ByKind<f64>,
    /// Shares that a cell is brought down to once it is above the tolerance.
    pub(crate) target: ByKind<f64>,
    /// Tolerance, early share and target of further limits.
    pub(crate) rows: RowSettings,
    /// Start after limits were lowered by little.
    pub(crate) close: WarmStart,
    /// The same in a cautious attempt: duals start anew.
    pub(crate) cautious: WarmStart,
    /// Start after limits were lowered by more than `abrupt`.
    pub(crate) far: WarmStart,
    /// Excess over a limit that calls for the far start, as a ratio.
    pub(crate) abrupt: f64,
    /// Most stretches of a slow cell that are checked one by one.
    pub(crate) stretches: f64,
    /// Stretches for each doubling of x in a cell.
    pub(crate) doublings: f64,
    /// Duration from which on a cell is slow, over that in which jerk builds up acceleration: it is checked more
    /// finely.
    pub(crate) slow: f64,
    /// Largest share of a limit that checks may miss between samples on a curve: above it, cells are checked more finely.
    pub(crate) missed: f64,
    /// Most times that limits of cells are lowered.
    pub(crate) rounds: usize,
    /// Duration over that of the optimum (as the duality gap bounds it) with which an attempt is good enough,
    /// and with which it is taken if no other is better.
    pub(crate) longer: [f64; 2],
    /// Attempts, one after the other until one is good enough.
    pub(crate) attempts: [AttemptSettings; 5],
    /// Share of the acceleration-limited x from which the others start.
    pub(crate) start: f64,
}

/// Largest shares of further limits, as those of velocity, acceleration and jerk: what is handed out, what is lowered early,
/// and what a cell is brought down to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSettings {
    pub(crate) tolerance: f64,
    pub(crate) early: f64,
    pub(crate) target: f64,
}

/// One attempt to solve the problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AttemptSettings {
    /// Refinement of the mesh.
    pub(crate) refinement: f64,
    /// Whether it starts from where all limits are kept, which is far away where one spot needs to be slow.
    pub(crate) is_safe: bool,
    /// Whether steps end at the first boundary, duals start anew, and every round solves for all cells.
    pub(crate) is_cautious: bool,
}

/// The windows of cells that are solved for anew where limits were lowered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowSettings {
    /// Segments on either side.
    pub(crate) around: usize,
    /// Distance on either side, at least, as a multiple of that on which the arm stops.
    pub(crate) stops: f64,
}

/// The values in use.
pub(crate) const SETTINGS: Settings = Settings {
    mesh: MeshSettings {
        switch: 0.3,
        fade: 0.5,
        blend: 0.035,
        blend_end: 0.003,
        blend_end_growth: 0.3,
        line: 0.25,
        turn: 0.15,
        turn_growth: 0.3,
        rest: 0.03,
        rest_growth: 0.25,
        rest_bend: 0.01,
        row_rad: 0.12,
        switch_jump: 0.25,
        most_nodes: 100_000,
    },
    interior_point: InteriorPointSettings {
        to_boundary: 0.98,
        largest_decrease: 0.8,
        least_share: 0.02,
        beyond: [5.0, 10.0],
        start_jerk: 1.0,
        start_growth: 0.3,
        cold: WarmStart { mu: 0.3, slack: 0.5, kept: 1.0 },
        centring: [(0.9, 0.05), (0.5, 0.15), (0.2, 0.4)],
        least_mu: 0.2,
        gap: 3e-5,
        first_gap: 1e-3,
        last_gap: 1e-6,
        residual: 1e-4,
        last_step: 0.4,
        closer: 0.5,
        steps: 150,
        patience: 60,
        stalled: (0.02, 25),
        kept_curvature: 0.02,
        sliver: 0.02,
        mid_jerk: 1.005,
    },
    refinement: RefinementSettings {
        tolerance: ByKind::from_array([1.0009, 1.0018, 1.018]),
        early: ByKind::from_array([1.0003, 1.0008, 1.01]),
        target: ByKind::from_array([0.9998, 1.0, 1.01]),
        rows: RowSettings { tolerance: 1.006, early: 1.003, target: 1.0 },
        close: WarmStart { mu: 1e-5, slack: 1e-3, kept: 10.0 },
        cautious: WarmStart { mu: 1e-3, slack: 1e-3, kept: 1.0 },
        far: WarmStart { mu: 1e-2, slack: 1e-2, kept: 1.0 },
        abrupt: 1.3,
        stretches: 4.0,
        doublings: 0.75,
        slow: 0.9,
        missed: 1e-3,
        rounds: 8,
        longer: [1.002, 1.25],
        attempts: [
            AttemptSettings { refinement: 1.0, is_safe: false, is_cautious: false },
            AttemptSettings { refinement: 1.0, is_safe: false, is_cautious: true },
            AttemptSettings { refinement: 1.0, is_safe: true, is_cautious: true },
            AttemptSettings { refinement: 1.7, is_safe: false, is_cautious: true },
            AttemptSettings { refinement: 2.5, is_safe: true, is_cautious: true },
        ],
        start: 0.7,
    },
    window: WindowSettings { around: 1, stops: 1.0 },
};
