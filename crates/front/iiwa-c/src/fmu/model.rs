//! Behaviour of the FMU: it runs a program in simulation time.

use super::variables::Variable;
use crate::{planned::PlannedProgram, state::IiwasimState};

/// Invalid request of a simulation. The state is unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Misuse {
    /// A value is out of range; the caller can retry with another one.
    OutOfRange(String),
    /// The call is not allowed.
    Illegal(String),
}

/// Tolerance of accumulated simulation steps at the end of the program, in s.
const ROUNDING_S: f64 = 1e-9;

/// Variable state of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    /// Simulation time, in s.
    time_s: f64,
    /// Input `start`, and its value at the beginning of the last step.
    start: bool,
    was_start: bool,
    /// Input `override`.
    rate: f64,
    progress: ProgramProgress,
}

/// Progress of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ProgramProgress {
    /// The program has not begun.
    Waiting,
    /// The program was at `program_s` at the time `since_s`, and continues at a constant rate: its
    /// time is not accumulated step by step.
    Running { since_s: f64, program_s: f64, rate: f64 },
    /// The program has ended.
    Done,
}

impl ProgramProgress {
    /// Program time at a simulation time, while the program runs.
    fn program_s(self, time_s: f64) -> Option<f64> {
        match self {
            Self::Running { since_s, program_s, rate } => {
                Some(program_s + rate * (time_s - since_s))
            }
            Self::Waiting | Self::Done => None,
        }
    }
}

/// Program in a simulation.
#[derive(Debug)]
pub(super) struct FmuModel {
    planned: PlannedProgram,
    moment: Moment,
    /// State of the arm, with velocities in simulation time, and motion 0 while the program does
    /// not run.
    arm: IiwasimState,
}

const BEGINNING: Moment = Moment {
    time_s: 0.0,
    start: false,
    was_start: false,
    rate: 1.0,
    progress: ProgramProgress::Waiting,
};

impl FmuModel {
    pub(super) fn new(planned: PlannedProgram) -> Self {
        let arm = IiwasimState::of(&planned, &planned.trajectory().at(0.0));
        let mut model = Self { planned, moment: BEGINNING, arm };
        model.restore(BEGINNING);
        model
    }

    pub(super) fn moment(&self) -> Moment {
        self.moment
    }

    /// Restores an earlier moment.
    pub(super) fn restore(&mut self, moment: Moment) {
        self.moment = moment;
        let end_s = self.planned.trajectory().cycle_time_s();
        let (program_s, rate, runs) = match moment.progress {
            ProgramProgress::Waiting => (0.0, 0.0, false),
            ProgramProgress::Running { rate, .. } => {
                (moment.progress.program_s(moment.time_s).unwrap_or_default(), rate, true)
            }
            ProgramProgress::Done => (end_s, 0.0, false),
        };
        let arm = IiwasimState::of(&self.planned, &self.planned.trajectory().at(program_s));
        self.arm = IiwasimState {
            dq: arm.dq.map(|dq| rate * dq),
            motion: if runs { arm.motion } else { 0 },
            ..arm
        };
    }

    /// Resets to the initial state, with default inputs.
    pub(super) fn reset(&mut self) {
        self.restore(BEGINNING);
    }

    /// Sets the start time of the simulation.
    pub(super) fn begin(&mut self, time_s: f64) -> Result<(), Misuse> {
        if !time_s.is_finite() {
            return Err(Misuse::Illegal(format!("the simulation begins at {time_s} s")));
        }
        self.moment.time_s = time_s;
        Ok(())
    }

    /// Performs a step of the simulation, during which the inputs are constant.
    pub(super) fn step(&mut self, from_s: f64, step_s: f64) -> Result<(), Misuse> {
        let Moment { time_s: last_s, start, was_start, rate, progress } = self.moment;
        let now_s = from_s + step_s;
        if !(now_s.is_finite() && step_s > 0.0) {
            let message = format!("a step of {step_s} s from {from_s} s; it must be above 0");
            return Err(Misuse::Illegal(message));
        }
        if from_s < last_s - ROUNDING_S * last_s.abs().max(1.0) {
            let message =
                format!("a step from {from_s} s; the simulation is at {last_s} s already");
            return Err(Misuse::Illegal(message));
        }
        let from = |program_s| ProgramProgress::Running { since_s: from_s, program_s, rate };
        let progress = match (progress, progress.program_s(from_s)) {
            (ProgramProgress::Running { rate: current_rate, .. }, Some(program_s))
                if current_rate != rate =>
            {
                from(program_s)
            }
            (ProgramProgress::Waiting | ProgramProgress::Done, _) if start && !was_start => {
                from(0.0)
            }
            _ => progress,
        };
        let end_s = self.planned.trajectory().cycle_time_s() - ROUNDING_S;
        let is_over = progress.program_s(now_s).is_some_and(|program_s| program_s >= end_s);
        let progress = if is_over { ProgramProgress::Done } else { progress };
        self.restore(Moment { time_s: now_s, was_start: start, progress, ..self.moment });
        Ok(())
    }

    pub(super) fn float64(&self, variable: Variable) -> Option<f64> {
        match variable {
            Variable::Time => Some(self.moment.time_s),
            Variable::Override => Some(self.moment.rate),
            Variable::Q(j) => Some(self.arm.q[j]),
            Variable::Dq(j) => Some(self.arm.dq[j]),
            Variable::Tcp(i) => Some(self.arm.tcp_m[i]),
            Variable::Orientation(i) => Some(self.arm.tcp_xyzw[i]),
            Variable::Start | Variable::Motion | Variable::Done => None,
        }
    }

    pub(super) fn int32(&self, variable: Variable) -> Option<i32> {
        (variable == Variable::Motion).then(|| i32::try_from(self.arm.motion).unwrap_or(i32::MAX))
    }

    pub(super) fn boolean(&self, variable: Variable) -> Option<bool> {
        match variable {
            Variable::Start => Some(self.moment.start),
            Variable::Done => Some(self.moment.progress == ProgramProgress::Done),
            _ => None,
        }
    }

    /// Sets `override`.
    pub(super) fn set_float64(&mut self, variable: Variable, value: f64) -> Result<(), Misuse> {
        match variable {
            Variable::Override if (0.0..=1.0).contains(&value) => {
                self.moment.rate = value;
                Ok(())
            }
            Variable::Override => {
                Err(Misuse::OutOfRange(format!("override is {value}; it must be from 0 to 1")))
            }
            other => Err(not_an_input(other, "Float64")),
        }
    }

    /// Sets `start`.
    pub(super) fn set_boolean(&mut self, variable: Variable, value: bool) -> Result<(), Misuse> {
        match variable {
            Variable::Start => {
                self.moment.start = value;
                Ok(())
            }
            other => Err(not_an_input(other, "Boolean")),
        }
    }
}

fn not_an_input(variable: Variable, kind: &str) -> Misuse {
    Misuse::Illegal(format!("{} is not an input of type {kind}", variable.declaration().name))
}

#[cfg(test)]
mod tests {
    use iiwa_plan::ProgramSource;

    use super::{FmuModel, Misuse};
    use crate::{
        fmu::variables::Variable,
        planned::{Choices, PlannedProgram},
    };

    /// Returns a model, and the same plan.
    fn model() -> (FmuModel, PlannedProgram) {
        let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
            "motions": [{ "type": "ptp", "joints_deg": [60, 0, 0, -30, 0, 0, 0] }] }"#;
        let source = ProgramSource::from_json(text).unwrap();
        let plan = || PlannedProgram::new(&source, None, Choices::default()).unwrap();
        (FmuModel::new(plan()), plan())
    }

    #[test]
    fn many_short_steps_add_up_to_no_error() {
        let (mut model, plan) = model();
        model.begin(1e3).unwrap();
        model.set_boolean(Variable::Start, true).unwrap();
        let mut time_s = 1e3;
        while time_s < 1e3 + plan.trajectory().cycle_time_s() {
            model.step(time_s, 1e-4).unwrap();
            time_s += 1e-4;
            let expected = plan.trajectory().at(time_s - 1e3);
            assert_eq!(model.float64(Variable::Q(3)), Some(expected.q[3]));
        }
        assert_eq!(model.boolean(Variable::Done), Some(true));
        assert_eq!(model.int32(Variable::Motion), Some(0));
    }

    #[test]
    fn an_override_slows_time_down() {
        let (mut model, plan) = model();
        model.set_boolean(Variable::Start, true).unwrap();
        model.set_float64(Variable::Override, 0.25).unwrap();
        model.step(0.0, 1.0).unwrap();
        let expected = plan.trajectory().at(0.25);
        assert_eq!(model.float64(Variable::Q(0)), Some(expected.q[0]));
        assert_eq!(model.float64(Variable::Dq(0)), Some(0.25 * expected.dq[0]));
        model.set_float64(Variable::Override, 0.0).unwrap();
        model.step(1.0, 1.0).unwrap();
        assert_eq!(model.float64(Variable::Q(0)), Some(expected.q[0]));
        assert_eq!(model.float64(Variable::Dq(0)), Some(0.0));
        assert_eq!(model.int32(Variable::Motion), Some(1));
    }

    #[test]
    fn rejected_calls_change_nothing() {
        let (mut model, _) = model();
        model.step(0.0, 0.5).unwrap();
        let before = model.moment();
        for value in [-0.1, 1.1, f64::NAN] {
            let refused = model.set_float64(Variable::Override, value);
            assert!(matches!(refused, Err(Misuse::OutOfRange(_))));
        }
        for (from_s, step_s) in
            [(0.5, 0.0), (0.5, -1.0), (0.5, f64::NAN), (0.4, 0.1), (f64::MAX, f64::MAX)]
        {
            assert!(matches!(model.step(from_s, step_s), Err(Misuse::Illegal(_))));
        }
        assert_eq!(
            model.set_boolean(Variable::Done, true),
            Err(Misuse::Illegal("done is not an input of type Boolean".to_owned()))
        );
        assert_eq!(model.moment(), before);
    }
}
