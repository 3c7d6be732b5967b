//! All tuned numbers of the jerk-limited solver.
//!
//! They trade the solver's time against its distance from the optimum and from the limits. Each was
//! varied alone, by factors of 1.5 to 3 either way, over the reference programs of an independent
//! solver and some thousand random programs; the starts, the first gap and the steps beyond the
//! boundary were then varied together. The chosen value is where the duration had stopped to
//! fall (to within 1e-4) and the number of steps or cells had not yet begun to rise. None depends
//! on the robot: lengths are relative to segments, times relative to the time in which jerk builds
//! up acceleration.

use iiwa_program::ByKind;

/// Settings of the solver; [`SETTINGS`] has their values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolverSettings {
    pub(crate) mesh: MeshSettings,
    pub(crate) interior_point: InteriorPointSettings,
    pub(crate) refinement: RefinementSettings,
    pub(crate) window: WindowSettings,
}

/// Cell sizes, each relative to a length or a time of the segment. Smaller is finer; all are in (0,
/// 1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshSettings {
    /// Duration of a cell where the acceleration-limited stamps switch from one limit to another,
    /// as a share of the time in which jerk builds up acceleration there.
    pub(crate) switch: f64,
    /// Growth of that duration per time from the switch.
    pub(crate) fade: f64,
    /// Length of a cell in a blend, as a share of the blend.
    pub(crate) blend: f64,
    /// Length of a cell at the ends of a blend, as a share of the blend; also on the neighbouring
    /// line.
    pub(crate) blend_end: f64,
    /// Growth of that length per distance from the end.
    pub(crate) blend_end_growth: f64,
    /// Length of a cell on a line, as a share of the line.
    pub(crate) line: f64,
    /// Length of a cell in the middle of a blend that turns back, as a share of the distance over
    /// which it turns back.
    pub(crate) turn: f64,
    /// Growth of that length per distance from the middle.
    pub(crate) turn_growth: f64,
    /// Length of a cell that touches rest, as a share of the distance over which jerk builds up
    /// acceleration.
    pub(crate) rest: f64,
    /// Growth of that length per distance from rest.
    pub(crate) rest_growth: f64,
    /// Largest contribution of the curvature of the path to jerk in such a cell, as a share of the
    /// limit.
    pub(crate) rest_bend: f64,
    /// Length of a cell with further limits, in rad, because coefficients such as inertia and
    /// gravity change along it.
    pub(crate) row_rad: f64,
    /// Jump of d2s/dt2 that counts as a switch in a blend, as a share of its largest value there.
    pub(crate) switch_jump: f64,
    /// Maximum number of nodes of a segment; some tens are usual. A guard against invalid stamps.
    pub(crate) max_nodes: usize,
}

/// Settings of the primal-dual interior-point method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InteriorPointSettings {
    /// Fraction to the boundary: largest share of the distance to the boundary that a step may
    /// take, in (0, 1).
    pub(crate) to_boundary: f64,
    /// Largest relative decrease of x in a step, in (0, 1).
    pub(crate) largest_decrease: f64,
    /// Least share of a slack or a dual that remains after a step.
    pub(crate) min_share: f64,
    /// Step lengths of slacks with x, and of duals, as multiples of the common step to the
    /// boundary: each slack and dual stops at its own boundary.
    pub(crate) beyond: [f64; 2],
    /// Largest x to start from, as a multiple of the x that jerk allows at constant speed.
    pub(crate) start_jerk: f64,
    /// Growth of x next to such a place, as a share of that with constant jerk.
    pub(crate) start_growth: f64,
    /// Start without a nearby solution.
    pub(crate) cold: WarmStart,
    /// Centring: pairs of a step length and a share of the present gap. For steps of at least that
    /// length, mu aims at that share. Long steps are far from the boundary and may aim closer to
    /// it.
    pub(crate) centring: [(f64, f64); 3],
    /// Share of the final gap below which mu is not lowered.
    pub(crate) min_mu: f64,
    /// Duality gap, relative to the duration, at which the problem counts as solved.
    pub(crate) gap: f64,
    /// Duality gap at which limits are checked for the first time.
    pub(crate) first_gap: f64,
    /// Duality gap if x does not settle at `gap`, because a segment takes a smaller share of the
    /// time.
    pub(crate) last_gap: f64,
    /// Largest residual of a row, relative to its bound, at which the problem counts as solved.
    pub(crate) residual: f64,
    /// Least primal step length at which the problem counts as solved.
    pub(crate) last_step: f64,
    /// Share of gap and residual at which a problem with further limits counts as solved, for any
    /// last step.
    pub(crate) closer: f64,
    /// Maximum number of steps.
    pub(crate) steps: usize,
    /// Number of steps after which steps are halved: they may cycle where the Lagrangian's
    /// curvature is negative, because the model of a step contains its magnitude.
    pub(crate) patience: usize,
    /// Step length below which a step counts as stalled, and the maximum number of such steps in a
    /// row.
    pub(crate) stalled: (f64, usize),
    /// Least share of the curvature of the duration that is kept where the duals would cancel it.
    pub(crate) kept_curvature: f64,
    /// Lines between two blends that are shorter than this share of the cells on either side have
    /// no rows.
    pub(crate) sliver: f64,
    /// Bound of jerk in the middle of cells in curves, relative to the limit: jerk within its limit
    /// at both ends may overshoot a little in between.
    pub(crate) mid_jerk: f64,
}

/// Initial values of slacks and duals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WarmStart {
    /// Products of slacks and duals, as a share of the value that balances with the duration.
    pub(crate) mu: f64,
    /// Least slack, as a share of the bound.
    pub(crate) slack: f64,
    /// Factor by which a dual may differ from mu over its slack, at least 1: duals near a solution
    /// are worth keeping.
    pub(crate) kept: f64,
}

/// Refinement of a solution between the places of its rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefinementSettings {
    /// Largest shares of the limits in a result.
    pub(crate) tolerance: ByKind<f64>,
    /// Shares above which the limits of a cell are tightened at the first check. They are below the
    /// tolerance, because a cell near to it then may exceed it in the end.
    pub(crate) early: ByKind<f64>,
    /// Target shares of a cell that exceeds the tolerance.
    pub(crate) target: ByKind<f64>,
    /// Tolerance, early share and target of further limits.
    pub(crate) rows: RowSettings,
    /// Start after limits were tightened by little.
    pub(crate) close: WarmStart,
    /// Start after limits were tightened by little, in a cautious attempt: duals are reset.
    pub(crate) cautious: WarmStart,
    /// Start after limits were tightened by more than `abrupt`.
    pub(crate) far: WarmStart,
    /// Ratio to a limit above which the `far` start is used.
    pub(crate) abrupt: f64,
    /// Maximum number of stretches of a cell that are checked separately.
    pub(crate) stretches: f64,
    /// Ratios of x at both ends of a cell above each of which the check divides the cell into one
    /// more stretch: powers of `2^(4/3)`.
    pub(crate) ratios: [f64; 3],
    /// Duration above which a cell is slow and is checked more finely, relative to the time in
    /// which jerk builds up acceleration.
    pub(crate) slow: f64,
    /// Largest error of the check between samples on a curve, as a share of a limit; above it,
    /// cells are checked more finely.
    pub(crate) missed: f64,
    /// Maximum number of rounds in which limits are tightened.
    pub(crate) rounds: usize,
    /// Durations over that of the optimum, bounded by the duality gap: up to the first an attempt
    /// is good enough, up to the second it is accepted if no other is better.
    pub(crate) longer: [f64; 2],
    /// Attempts, run in order until one is good enough.
    pub(crate) attempts: [AttemptSettings; 5],
    /// Share of the acceleration-limited x from which an attempt starts that is not `is_safe`.
    pub(crate) start: f64,
}

/// Shares of further limits: the largest in a result, the threshold of early tightening, and the
/// target of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSettings {
    pub(crate) tolerance: f64,
    pub(crate) early: f64,
    pub(crate) target: f64,
}

/// Settings of one attempt to solve the problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AttemptSettings {
    /// Refinement of the mesh.
    pub(crate) refinement: f64,
    /// `true` to start where all limits are satisfied, which is far from the optimum if one spot
    /// needs to be slow.
    pub(crate) is_safe: bool,
    /// `true` if the first boundary ends a step, duals are reset, and each round solves all cells.
    pub(crate) is_cautious: bool,
}

/// Windows of cells that are solved again after limits were tightened.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowSettings {
    /// Number of segments on either side.
    pub(crate) around: usize,
    /// Least distance on either side, as a multiple of the stopping distance.
    pub(crate) stops: f64,
}

/// The values in use.
pub(crate) const SETTINGS: SolverSettings = SolverSettings {
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
        max_nodes: 100_000,
    },
    interior_point: InteriorPointSettings {
        to_boundary: 0.98,
        largest_decrease: 0.8,
        min_share: 0.02,
        beyond: [8.0, 10.0],
        start_jerk: 1.0,
        start_growth: 0.3,
        cold: WarmStart { mu: 1.0, slack: 0.5, kept: 1.0 },
        centring: [(0.9, 0.05), (0.5, 0.15), (0.2, 0.4)],
        min_mu: 0.2,
        gap: 3e-5,
        first_gap: 3e-4,
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
        close: WarmStart { mu: 1e-5, slack: 3e-4, kept: 10.0 },
        cautious: WarmStart { mu: 1e-3, slack: 1e-3, kept: 1.0 },
        far: WarmStart { mu: 1e-2, slack: 1e-2, kept: 1.0 },
        abrupt: 1.3,
        stretches: 4.0,
        ratios: [2.519_842_1, 6.349_604_2, 16.0],
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
        start: 0.85,
    },
    window: WindowSettings { around: 1, stops: 1.0 },
};
