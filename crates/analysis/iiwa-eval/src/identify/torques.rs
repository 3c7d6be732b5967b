//! Payloads and friction from recorded torques.
//!
//! Torques are linear in the moments of the payload (mass, first and second moments) and in
//! friction:
//!
//! ```text
//! torque - torque of the empty arm = Y(q, q', q'') moments + viscous q' + Coulomb sign(q')
//! ```
//!
//! All unknowns are found at once by least squares, with one payload for all recordings whose
//! programs state the same one. Second moments have little effect on the motion of an arm: their
//! prior is 0 with the standard deviation of a compact body of some kg, so that the uncertainties
//! of mass and centre of mass include any such body. Each joint is weighted by the scatter of its
//! own torques, separately at rest and in motion, since a joint at rest may be held by friction.
//! Scatter that is correlated from window to window, such as errors of the model, counts as fewer
//! observations.

use iiwa_kin::{Dynamics, Joints, Load, RigidBody, Robot};
use iiwa_program::{Motion, Program};
use nalgebra::{DMatrix, DVector};

use crate::{
    estimate::{Estimate, NORMAL_95},
    exerted::exerted,
    identify::{
        recording::RecordedRun,
        torque_estimates::{LoadEstimate, TorqueEstimates},
        torque_windows::{JointDoes, TorqueWindow, WindowInstant, half_s, windows},
    },
};

/// Unknowns of a payload: mass, first moments, second moments (xx, yy, zz, xy, xz, yz).
const MOMENTS: usize = 10;
/// Unknowns of friction: viscous and Coulomb friction of each joint.
const FRICTION: usize = 14;

/// Prior standard deviations, in kg, kg m, kg m^2, and Nm or Nm s/rad: almost no prior knowledge,
/// except of second moments.
const MASS_KG: f64 = 100.0;
const FIRST_KG_M: f64 = 100.0;
const SECOND_KG_M2: f64 = 0.3;
const FRICTION_NM: f64 = 100.0;

/// Largest uncertainty of reported results: kg and share of the mass, mm, Nm or Nm s/rad.
const TOLD_MASS_KG: f64 = 0.5;
const TOLD_MASS_SHARE: f64 = 0.3;
const TOLD_CENTER_MM: f64 = 50.0;
const TOLD_FRICTION_NM: f64 = 0.5;

/// Lower bounds of the uncertainty of a payload, as a share of the mass and in mm: twice the error
/// of windows with samples every 5 ms without any noise.
const MIN_MASS_SHARE: f64 = 3e-4;
const MIN_CENTER_MM: f64 = 0.15;

/// Lower bound of the standard deviation of a torque, in Nm.
const MIN_NM: f64 = 2e-3;

/// Rounds of weighting by the scatter of the previous round.
const ROUNDS: usize = 4;

/// Minimum number of windows with torques.
const FEWEST: usize = 10;

/// Evaluates the recordings with torques, if any. Also returns the recordings whose torques were
/// not used, with the reason.
pub(super) fn find(
    recordings: &[RecordedRun<'_>],
    model: &Robot,
) -> (Option<TorqueEstimates>, Vec<(usize, &'static str)>) {
    let mut groups: Vec<(Option<Load>, Vec<usize>)> = Vec::new();
    let mut observed = Observations::default();
    let mut unused = Vec::new();
    for (recording, RecordedRun { program, log }) in recordings.iter().enumerate() {
        if log.torques_nm.iter().flatten().next().is_none() {
            continue;
        }
        let stated = match stated_load(program) {
            Ok(stated) => stated,
            Err(reason) => {
                unused.push((recording, reason));
                continue;
            }
        };
        let arm = model.dynamics().with_mount(&program.workcell.mount);
        let Some((torques, turned)) = exerted(log, &arm) else { continue };
        let windows = windows(log, &torques);
        if windows.len() < FEWEST {
            unused.push((recording, "too few samples with torques in a row: they were not used"));
            continue;
        }
        let group = groups.iter().position(|(load, _)| *load == stated);
        let group = group.unwrap_or_else(|| {
            groups.push((stated, Vec::new()));
            groups.len() - 1
        });
        groups[group].1.push(recording);
        observed.turned |= turned;
        observed.window_s = observed.window_s.max(2.0 * half_s(log));
        observed.add(group, &Regressor::new(&arm), &windows);
    }
    (observed.fit(groups), unused)
}

/// Returns the payload that a program states for all of its motions, if any; an error if it
/// changes, since the torques are then not used.
fn stated_load(program: &Program) -> Result<Option<Load>, &'static str> {
    let loads = program.loads();
    let of_motions = loads.iter().zip(&program.motions);
    let mut of_motions =
        of_motions.filter(|(_, motion)| !matches!(motion, Motion::Load(_))).map(|(load, _)| *load);
    let first = of_motions.next().flatten();
    if of_motions.all(|load| load == first) {
        return Ok(first);
    }
    Err("the load changes on the way: its torques were not used")
}

/// Regressor of the torques: their derivatives by the moments of a payload.
struct Regressor {
    arm: Dynamics,
    /// Dynamics with 1 kg at each of the points.
    points: [Dynamics; MOMENTS],
}

/// Distance of the points from the flange centre, in m: typical of payloads.
const POINT_M: f64 = 0.1;

impl Regressor {
    fn new(arm: &Dynamics) -> Self {
        const POINTS: [[f64; 3]; MOMENTS] = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ];
        let with =
            |point: [f64; 3]| arm.with_body(&RigidBody::point(1.0, point.map(|x| x * POINT_M)));
        Self { arm: *arm, points: POINTS.map(with) }
    }

    /// Returns the mean torques of the empty arm, and those of each moment.
    fn over(&self, window: &TorqueWindow) -> (Joints, [Joints; MOMENTS]) {
        let torques = |arm: &Dynamics| -> Joints {
            let mut mean = [0.0; 7];
            for WindowInstant { share, q_rad, velocity_rad_s, acceleration_rad_s2 } in
                &window.instants
            {
                let now = arm.torques(q_rad, velocity_rad_s, acceleration_rad_s2);
                mean.iter_mut().zip(now).for_each(|(mean, nm)| *mean += share * nm);
            }
            mean
        };
        let empty = torques(&self.arm);
        // The torque of a point mass is a quadratic function of its position.
        let p = self.points.each_ref().map(torques);
        let by = |f: &dyn Fn(usize) -> f64| -> Joints { std::array::from_fn(f) };
        let first = |k: usize| by(&|j| (p[k][j] - p[k + 1][j]) / (2.0 * POINT_M));
        let second =
            |k: usize| by(&|j| (p[k][j] + p[k + 1][j] - 2.0 * p[0][j]) / (2.0 * POINT_M.powi(2)));
        let mixed = |k: usize, a: usize, b: usize| {
            by(&|j| (p[k][j] - p[a][j] - p[b][j] + p[0][j]) / POINT_M.powi(2))
        };
        let moments = [
            by(&|j| p[0][j] - empty[j]),
            first(1),
            first(3),
            first(5),
            second(1),
            second(3),
            second(5),
            mixed(7, 1, 3),
            mixed(8, 1, 5),
            mixed(9, 3, 5),
        ];
        (empty, moments)
    }
}

/// Torque of a joint in a window.
struct TorqueRow {
    joint: usize,
    does: JointDoes,
    load: usize,
    by_moments: [f64; MOMENTS],
    velocity_rad_s: f64,
    value_nm: f64,
}

impl TorqueRow {
    fn sort(&self) -> usize {
        2 * self.joint + usize::from(self.does == JointDoes::Moves)
    }

    /// Returns the unknowns of the row with their factors.
    fn factors(&self) -> impl Iterator<Item = (usize, f64)> {
        let first = FRICTION + MOMENTS * self.load;
        let moments = self.by_moments.iter().enumerate().map(move |(k, by)| (first + k, *by));
        let v = if self.does == JointDoes::Moves { self.velocity_rad_s } else { 0.0 };
        let friction = [(self.joint, v), (7 + self.joint, if v == 0.0 { 0.0 } else { v.signum() })];
        friction.into_iter().chain(moments)
    }
}

#[derive(Default)]
struct Observations {
    rows: Vec<TorqueRow>,
    window_s: f64,
    turned: bool,
}

impl Observations {
    fn add(&mut self, load: usize, regressor: &Regressor, windows: &[TorqueWindow]) {
        for window in windows {
            let (empty, moments) = regressor.over(window);
            for joint in 0..7 {
                let Some(does) = window.does[joint] else { continue };
                self.rows.push(TorqueRow {
                    joint,
                    does,
                    load,
                    by_moments: moments.map(|torques| torques[joint]),
                    velocity_rad_s: window.mean_velocity_rad_s(joint),
                    value_nm: window.torque_nm[joint] - empty[joint],
                });
            }
        }
    }

    fn fit(&self, groups: Vec<(Option<Load>, Vec<usize>)>) -> Option<TorqueEstimates> {
        if groups.is_empty() {
            return None;
        }
        let mut variances = [1.0; 14];
        let mut best = None;
        for _ in 0..ROUNDS {
            let (unknowns, covariance) = self.solve(groups.len(), &variances)?;
            variances = self.scatter(&unknowns);
            best = Some((unknowns, covariance));
        }
        let (unknowns, covariance) = best?;
        let count = |sort: usize| self.rows.iter().filter(|row| row.sort() == sort).count();
        let friction = |first: usize| {
            std::array::from_fn(|j| {
                let variance: f64 = covariance[(first + j, first + j)];
                let uncertainty = NORMAL_95 * variance.sqrt();
                let (value, count) = (unknowns[first + j], count(2 * j + 1));
                let estimate = Estimate { value, uncertainty, count };
                (count > 0 && uncertainty <= TOLD_FRICTION_NM).then_some(estimate)
            })
        };
        let loads = groups.into_iter().enumerate();
        let loads = loads.map(|(load, (stated, recordings))| {
            let windows = self.rows.iter().filter(|row| row.load == load).count();
            load_estimate(stated, recordings, load, windows, &unknowns, &covariance)
        });
        Some(TorqueEstimates {
            loads: loads.collect(),
            viscous_nm_s_rad: friction(0),
            coulomb_nm: friction(7),
            residual_nm: self.residuals(&unknowns),
            window_s: self.window_s,
            turned: self.turned,
        })
    }

    /// Returns the unknowns and their covariance.
    fn solve(&self, loads: usize, variances: &[f64; 14]) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let count = FRICTION + MOMENTS * loads;
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let mut right = DVector::<f64>::zeros(count);
        for i in 0..count {
            let before = match i.checked_sub(FRICTION).map(|i| i % MOMENTS) {
                None => FRICTION_NM,
                Some(0) => MASS_KG,
                Some(1..=3) => FIRST_KG_M,
                Some(_) => SECOND_KG_M2,
            };
            normal[(i, i)] = before.powi(-2);
        }
        for row in &self.rows {
            let weight = variances[row.sort()].recip();
            let factors: Vec<_> = row.factors().collect();
            for (i, by) in &factors {
                right[*i] += weight * by * row.value_nm;
                for (k, other) in &factors {
                    normal[(*i, *k)] += weight * by * other;
                }
            }
        }
        // Scaled, since the unknowns differ by orders of magnitude.
        let scale = normal.diagonal().map(|d| d.sqrt().recip());
        let scaled = DMatrix::from_fn(count, count, |i, k| normal[(i, k)] * scale[i] * scale[k]);
        let inverse = scaled.cholesky()?.inverse();
        let covariance =
            DMatrix::from_fn(count, count, |i, k| inverse[(i, k)] * scale[i] * scale[k]);
        Some((&covariance * right, covariance))
    }

    fn row_residuals<'a>(
        &'a self,
        unknowns: &'a DVector<f64>,
    ) -> impl Iterator<Item = (&'a TorqueRow, f64)> {
        self.rows.iter().map(|row| {
            let expected: f64 = row.factors().map(|(i, by)| by * unknowns[i]).sum();
            (row, row.value_nm - expected)
        })
    }

    fn residuals(&self, unknowns: &DVector<f64>) -> Joints {
        let mut sums = [(0.0, 0.0); 7];
        for (row, residual) in self.row_residuals(unknowns) {
            let (squares, count) = &mut sums[row.joint];
            *squares += residual * residual;
            *count += 1.0;
        }
        sums.map(|(squares, count): (f64, f64)| (squares / count.max(1.0)).sqrt())
    }

    /// Returns the variances of torques by joint and activity, larger where residuals are
    /// correlated from one window to the next, as in a first-order autoregression.
    fn scatter(&self, unknowns: &DVector<f64>) -> [f64; 14] {
        let mut sums = [(0.0, 0.0, 0.0, 0.0_f64); 14];
        for (row, residual) in self.row_residuals(unknowns) {
            let (squares, products, before, count) = &mut sums[row.sort()];
            *squares += residual * residual;
            *products += residual * *before;
            *before = residual;
            *count += 1.0;
        }
        sums.map(|(squares, products, _, count)| {
            let count = count.max(1.0);
            let variance = (squares / count).max(MIN_NM.powi(2));
            let correlation: f64 = products / f64::max(squares, f64::MIN_POSITIVE);
            // White noise shows this correlation by chance.
            if correlation < 2.0 / count.sqrt() {
                return variance;
            }
            let correlation = correlation.min((1.0 - 2.0 / count).max(0.0));
            variance * (1.0 + correlation) / (1.0 - correlation)
        })
    }
}

fn load_estimate(
    stated: Option<Load>,
    recordings: Vec<usize>,
    load: usize,
    count: usize,
    unknowns: &DVector<f64>,
    covariance: &DMatrix<f64>,
) -> LoadEstimate {
    let offset = FRICTION + MOMENTS * load;
    let mass = unknowns[offset];
    let mass_kg = Estimate {
        value: mass,
        uncertainty: (NORMAL_95 * covariance[(offset, offset)].sqrt()).hypot(MIN_MASS_SHARE * mass),
        count,
    };
    let is_known = mass_kg.uncertainty <= TOLD_MASS_KG.max(TOLD_MASS_SHARE * mass);
    let center_mm = std::array::from_fn(|axis| {
        let first = offset + 1 + axis;
        let center_m = unknowns[first] / mass;
        // The centre of mass is the first moment over the mass.
        let variance = covariance[(first, first)] - 2.0 * center_m * covariance[(first, offset)]
            + center_m.powi(2) * covariance[(offset, offset)];
        let uncertainty =
            (1e3 * NORMAL_95 * variance.max(0.0).sqrt() / mass.abs()).hypot(MIN_CENTER_MM);
        let is_center_known =
            is_known && !mass_kg.holds(0.0) && mass > 0.0 && uncertainty <= TOLD_CENTER_MM;
        is_center_known.then_some(Estimate { value: 1e3 * center_m, uncertainty, count })
    });
    LoadEstimate { recordings, stated, mass_kg: is_known.then_some(mass_kg), center_mm }
}
