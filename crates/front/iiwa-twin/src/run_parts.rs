//! Runs of programs with inputs and outputs. A request to a drive contains motions only: the parts
//! between inputs and outputs run one after the other, and signals are set and read while the robot
//! is at rest between them.

use std::{mem, thread, time::Instant};

use iiwa_kin::Joints;
use iiwa_link::{
    ClientError, Published, Torques,
    message::{
        Direction, MAX_SAMPLES, MeasuredPositions, Refusal, Request, Run as Measured, RunLabel,
        Signal,
    },
};
use iiwa_program::{
    FlangeLoad, IoEntry, IoKind, IoValue, Motion, MotionIndex, MotionList, Program, Sources,
    with_motions,
};

use crate::runs::{DriveConnection, ExecutedRun, POLL, RunUpdate, execute};

/// Part of a program.
#[derive(Clone, Debug, PartialEq)]
pub enum RunPart {
    /// Motions, waits and payload changes.
    Motions {
        /// First entry of the part in the program.
        first: MotionIndex,
        /// `true` if the list begins with the payload of earlier parts.
        carries_load: bool,
        /// Entries, after the payload of earlier parts.
        list: Box<MotionList>,
    },
    /// An output to set, or an input to wait for.
    Io(MotionIndex, IoEntry),
}

/// Divides a program at its inputs and outputs.
///
/// # Errors
///
/// The first entry that overlaps motions: a signal cannot be set or read during a run.
pub fn parts(program: &Program) -> Result<Vec<RunPart>, (MotionIndex, IoEntry)> {
    let mut parts = Vec::new();
    let mut part = PartDraft::default();
    // Payload that a change has set.
    let mut load: Option<FlangeLoad> = None;
    for (motion, entry) in program.entries() {
        match entry {
            Motion::Io(io) if io.overlap > 0 => return Err((motion, io.clone())),
            Motion::Io(io) => {
                parts.extend(mem::take(&mut part).finish(program));
                parts.push(RunPart::Io(motion, io.clone()));
            }
            _ => {
                part.push(program, motion, entry, load.as_ref());
                if let Motion::Load(changed) = entry {
                    load.clone_from(changed);
                }
            }
        }
    }
    parts.extend(part.finish(program));
    Ok(parts)
}

/// Part under construction.
#[derive(Default)]
struct PartDraft {
    first: Option<MotionIndex>,
    carries_load: bool,
    motions: Vec<Motion>,
    sources: Sources,
}

impl PartDraft {
    fn push(
        &mut self,
        program: &Program,
        motion: MotionIndex,
        entry: &Motion,
        load: Option<&FlangeLoad>,
    ) {
        if self.first.is_none() {
            self.first = Some(motion);
            self.carries_load = load.is_some();
            self.motions.extend(load.map(|load| Motion::Load(Some(load.clone()))));
        }
        let index = MotionIndex::new(self.motions.len());
        if let Some(source) = program.sources.of(motion) {
            self.sources.insert(index, source.clone());
        }
        if let Some(label) = program.sources.label(motion) {
            self.sources.insert_label(index, label.clone());
        }
        self.motions.push(entry.clone());
    }

    /// Returns the part; `None` without motions and waits.
    fn finish(self, program: &Program) -> Option<RunPart> {
        let Self { first, carries_load, motions, sources } = self;
        let acts = |entry: &Motion| !matches!(entry, Motion::Load(_));
        let first = first.filter(|_| motions.iter().any(acts))?;
        let workcell = program.workcell.clone();
        let list = Box::new(MotionList { motions, workcell, sources });
        Some(RunPart::Motions { first, carries_load, list })
    }
}

/// Checks that the robot has all signals of a program, that the program sets outputs only, and that
/// the signals can have the values of the program.
///
/// # Errors
///
/// The first signal for which this is not true, with its motion.
pub fn check_signals(
    drive: &mut DriveConnection,
    parts: &[RunPart],
    sources: &Sources,
) -> Result<(), ClientError> {
    if !parts.iter().any(|part| matches!(part, RunPart::Io(..))) {
        return Ok(());
    }
    let listed = match drive.client().list_io() {
        Ok(listed) => listed,
        // The robot cannot read one of its signals, which the program may not use.
        Err(ClientError::Refused { .. }) => Vec::new(),
        Err(error) => return Err(error),
    };
    for part in parts {
        let RunPart::Io(motion, entry) = part else { continue };
        let result = match listed.iter().find(|signal| signal.name == entry.io) {
            Some(Signal { direction, value, .. }) => check_entry(entry, Some(*direction), *value),
            None => {
                drive.client().get_io(&entry.io).and_then(|found| check_entry(entry, None, found))
            }
        };
        result.map_err(|error| at(*motion, error, sources))?;
    }
    Ok(())
}

/// Checks an entry whose signal has the value `found`, and a direction, if known.
fn check_entry(
    entry: &IoEntry,
    direction: Option<Direction>,
    found: IoValue,
) -> Result<(), ClientError> {
    if entry.kind == IoKind::Set && direction == Some(Direction::Input) {
        let message = format!("`{}` is an input, which cannot be set; use `wait_for`", entry.io);
        return Err(refused(Refusal::bad(message)));
    }
    check_value(&entry.io, found, entry.value)
}

/// Checks that a signal with the value `found` can have the value `wanted`.
fn check_value(io: &str, found: IoValue, wanted: IoValue) -> Result<(), ClientError> {
    let is_possible = match (found, wanted) {
        // Values of a digital signal are whole numbers.
        (IoValue::Digital(_), IoValue::Analog(wanted)) => wanted.fract() == 0.0,
        _ => wanted.is_comparable(found),
    };
    if is_possible {
        return Ok(());
    }
    let message = format!("`{io}` is {found}, and can never be {wanted}");
    Err(refused(Refusal::bad(message)))
}

/// Executes the parts of a program in order, and stops once `to_stop` returns true. The result has
/// the samples of all parts, and of the waits for inputs between them.
pub fn execute_parts(
    drive: &mut DriveConnection,
    parts: &[RunPart],
    sources: &Sources,
    label: &RunLabel,
    to_stop: impl Fn() -> bool,
    mut on_event: impl FnMut(RunUpdate<'_>),
) -> ExecutedRun {
    let mut whole = WholeRun::default();
    let is_run = |part: &&RunPart| matches!(part, RunPart::Motions { .. });
    let count = parts.iter().filter(is_run).count();
    let mut number = 0;
    for part in parts {
        if to_stop() {
            let refusal = Refusal::robot("interrupted between two motions");
            return whole.ended(Err(refused(refusal)));
        }
        let result = match part {
            RunPart::Motions { first, carries_load, list } => {
                number += 1;
                let label = part_label(label, number, count);
                let request = Request::motions((**list).clone()).labelled(label);
                let before_s = whole.duration_s();
                let run = execute(drive, &request, &to_stop, |event| match event {
                    RunUpdate::Progress(t_s) => on_event(RunUpdate::Progress(before_s + t_s)),
                    event => on_event(event),
                });
                whole.add(run, |message| {
                    sources.in_message(&renumbered(message, *first, *carries_load))
                })
            }
            RunPart::Io(motion, entry) => {
                let result = match entry.kind {
                    IoKind::Set => drive.client().set_io(&entry.io, entry.value).map(drop),
                    IoKind::WaitFor { .. } => {
                        on_event(RunUpdate::Waiting(entry));
                        whole.wait_for(drive, entry, &to_stop)
                    }
                };
                result.map_err(|error| at(*motion, error, sources))
            }
        };
        if let Err(error) = result {
            return whole.ended(Err(error));
        }
    }
    whole.ended(Ok(()))
}

fn refused(refusal: Refusal) -> ClientError {
    ClientError::Refused { refusal, run: None }
}

/// Returns the label of a part, without the plan of the whole program. The history of runs compares
/// equal parts only, by their names.
fn part_label(whole: &RunLabel, number: usize, count: usize) -> RunLabel {
    let program = whole.program.as_ref().map(|name| format!("{name} (part {number} of {count})"));
    RunLabel { program, plan: None, planned_for: whole.planned_for.clone() }
}

/// Replaces the motion numbers of a part in a message by those of the program.
fn renumbered(message: &str, first: MotionIndex, carries_load: bool) -> String {
    with_motions(message, |motion| {
        // A load change with the current payload may precede the motions of the part.
        let offset = motion.index().saturating_sub(usize::from(carries_load));
        MotionIndex::new(first.index() + offset).to_string()
    })
}

/// Adds the motion of the program to a refusal.
fn at(motion: MotionIndex, error: ClientError, sources: &Sources) -> ClientError {
    match error {
        ClientError::Refused { mut refusal, run } => {
            let message = format!("motion {motion}: {}", refusal.message);
            refusal.message = sources.in_message(&message);
            ClientError::Refused { refusal, run }
        }
        error => error,
    }
}

/// Measurements of the parts so far.
#[derive(Default)]
struct WholeRun {
    run: Measured,
    /// End of the last part, in s, if known.
    end_s: Option<f64>,
    /// `true` if a part has run.
    has_run: bool,
    torques: Torques,
}

impl WholeRun {
    /// Time from the first to the last sample, in s.
    fn duration_s(&self) -> f64 {
        let t_s = &self.run.samples.t_s;
        t_s.first().zip(t_s.last()).map_or(0.0, |(first, last)| last - first)
    }

    /// Adds the run of a part; `in_program` converts messages about the part.
    fn add(
        &mut self,
        executed: ExecutedRun,
        in_program: impl Fn(&str) -> String,
    ) -> Result<(), ClientError> {
        let ExecutedRun { result, streamed, torques } = executed;
        self.torques.extend(torques);
        match result {
            Ok(run) => {
                self.add_measured(run);
                Ok(())
            }
            Err(ClientError::Refused { mut refusal, run }) => {
                self.add_measured(run.map(|run| *run).unwrap_or_default());
                refusal.message = in_program(&refusal.message);
                Err(ClientError::Refused { refusal, run: None })
            }
            Err(error) => {
                // The samples of the stream are the only ones of this part.
                append(&mut self.run.samples, streamed);
                Err(error)
            }
        }
    }

    fn add_measured(&mut self, part: Measured) {
        let Self { run, .. } = self;
        if !self.has_run {
            run.start_s = part.start_s;
        }
        self.has_run = true;
        self.end_s = part.start_s.zip(part.cycle_time_s).map(|(start_s, time_s)| start_s + time_s);
        run.timed_by = part.timed_by.or(run.timed_by);
        run.untimed_because = part.untimed_because.or(run.untimed_because.take());
        run.samples_left_out += part.samples_left_out;
        append(&mut run.samples, part.samples);
    }

    /// Waits for an input while the robot is at rest, and keeps the samples of the stream.
    fn wait_for(
        &mut self,
        drive: &mut DriveConnection,
        entry: &IoEntry,
        to_stop: impl Fn() -> bool,
    ) -> Result<(), ClientError> {
        let IoEntry { io, value: wanted, .. } = entry;
        loop {
            let found = drive.client().get_io(io)?;
            check_value(io, found, *wanted)?;
            if wanted.is_same(found) {
                return Ok(());
            }
            if to_stop() {
                let message = format!("interrupted while `{io}` is {found}, not {wanted}");
                return Err(refused(Refusal::robot(message)));
            }
            self.keep_stream(drive);
        }
    }

    /// Keeps the samples that arrive within a short time.
    fn keep_stream(&mut self, drive: &mut DriveConnection) {
        let since = Instant::now();
        while since.elapsed() < POLL {
            match drive.stream().next(POLL) {
                Ok(Some(Published::Joints { t_s, joints_rad })) => self.keep(t_s, joints_rad),
                Ok(Some(Published::Torques { t_s, measured_nm, .. })) if self.has_room() => {
                    self.torques.keep(t_s, measured_nm);
                }
                Ok(_) => {}
                Err(_) => thread::sleep(POLL),
            }
        }
    }

    /// Returns true if samples of a wait are kept. A wait has no time limit.
    fn has_room(&self) -> bool {
        self.has_run && self.run.samples.t_s.len() < MAX_SAMPLES
    }

    /// Keeps a sample of a wait.
    fn keep(&mut self, t_s: f64, joints_rad: Joints) {
        if self.has_room() {
            append(&mut self.run.samples, MeasuredPositions::new(vec![t_s], vec![joints_rad]));
        } else if self.has_run {
            self.run.samples_left_out += 1;
        }
    }

    fn ended(mut self, result: Result<(), ClientError>) -> ExecutedRun {
        self.run.cycle_time_s =
            self.run.start_s.zip(self.end_s).map(|(start_s, end_s)| end_s - start_s);
        let Self { run, torques, .. } = self;
        let (result, streamed) = match result {
            Ok(()) => (Ok(run), MeasuredPositions::default()),
            Err(ClientError::Refused { refusal, .. }) => {
                let failed = ClientError::Refused { refusal, run: Some(Box::new(run)) };
                (Err(failed), MeasuredPositions::default())
            }
            Err(error) => (Err(error), run.samples),
        };
        ExecutedRun { result, streamed, torques }
    }
}

/// Appends the samples that are later than all samples so far.
fn append(all: &mut MeasuredPositions, more: MeasuredPositions) {
    let last_s = all.t_s.last().copied().unwrap_or(f64::NEG_INFINITY);
    for (t_s, joints_rad) in more.t_s.into_iter().zip(more.joints_rad) {
        if t_s > last_s {
            all.t_s.push(t_s);
            all.joints_rad.push(joints_rad);
        }
    }
}

#[cfg(test)]
mod tests {
    use iiwa_program::{Load, Ptp};

    use super::*;

    fn ptp(q: f64) -> Motion {
        Motion::Ptp(Ptp::to([q; 7]))
    }

    fn set() -> IoEntry {
        IoEntry::set("A.B", IoValue::Boolean(true))
    }

    fn program(motions: Vec<Motion>) -> Program {
        Program { motions, ..Program::from_deg([0.0; 7]).build() }
    }

    #[test]
    fn a_program_is_divided_at_its_signals() {
        let load = Load { mass_kg: 2.0, ..Load::default() };
        let heavy = Motion::Load(Some(load.into()));
        let program = program(vec![
            Motion::Io(set()),
            ptp(0.1),
            heavy.clone(),
            Motion::Io(set()),
            Motion::Io(set()),
            ptp(0.2),
            Motion::Load(None),
            Motion::Io(set()),
            Motion::Load(Some(load.into())),
        ]);
        let parts = parts(&program).unwrap_or_default();
        let index = MotionIndex::new;
        let io = |place| RunPart::Io(index(place), set());
        let run = |first, carries_load, motions: Vec<Motion>| RunPart::Motions {
            first: index(first),
            carries_load,
            list: Box::new(MotionList::from(motions)),
        };
        assert_eq!(
            parts,
            [
                io(0),
                run(1, false, vec![ptp(0.1), heavy.clone()]),
                io(3),
                io(4),
                run(5, true, vec![heavy, ptp(0.2), Motion::Load(None)]),
                io(7),
            ]
        );
    }

    #[test]
    fn a_signal_during_a_motion_is_refused() {
        let overlapping = IoEntry { overlap: 1, ..set() };
        let program = program(vec![ptp(0.1), Motion::Io(overlapping.clone())]);
        assert_eq!(parts(&program), Err((MotionIndex::new(1), overlapping)));
    }

    #[test]
    fn samples_are_appended_once() {
        let samples = |t_s: &[f64]| MeasuredPositions::new(t_s.to_vec(), vec![[0.0; 7]; t_s.len()]);
        let mut all = samples(&[1.0, 2.0]);
        append(&mut all, samples(&[1.5, 2.0, 2.5]));
        assert_eq!(all, samples(&[1.0, 2.0, 2.5]));
    }

    #[test]
    fn values_and_directions_of_signals_are_checked() {
        use IoValue::{Analog, Boolean, Digital};
        let reason = |entry: &IoEntry, direction, found| {
            check_entry(entry, direction, found).err().map(|error| error.to_string())
        };
        for (found, wanted, is_possible) in [
            (Boolean(false), Boolean(true), true),
            (Boolean(false), Digital(1), false),
            (Digital(0), Analog(2.5), false),
            (Digital(0), Analog(-3.0), true),
            (Analog(0.0), Digital(2), true),
        ] {
            let wait = IoEntry::wait_for("A.B", wanted, 0.0);
            assert_eq!(reason(&wait, None, found).is_none(), is_possible, "{found} {wanted}");
            let set = IoEntry::set("A.B", wanted);
            let on_input = reason(&set, Some(Direction::Input), found).unwrap_or_default();
            assert!(on_input.contains("`A.B` is an input, which cannot be set"), "{on_input}");
        }
        assert_eq!(reason(&set(), Some(Direction::Output), Boolean(false)), None);
    }

    #[test]
    fn messages_have_the_motion_numbers_of_the_program() {
        let first = MotionIndex::new(4);
        let message = "motion 2: `motion 1` is unknown; see motion 3";
        let expected = "motion 6: `motion 1` is unknown; see motion 7";
        assert_eq!(renumbered(message, first, false), expected);
        let expected = "motion 5: `motion 1` is unknown; see motion 6";
        assert_eq!(renumbered(message, first, true), expected);
        assert_eq!(renumbered("motion 1: too heavy", first, true), "motion 5: too heavy");
    }

    #[test]
    fn the_label_of_a_part_is_not_that_of_the_program() {
        let plan = iiwa_link::message::RunPlan { cycle_time_s: 9.0, limited_by: Vec::new() };
        let program = Some("pick".to_owned());
        let label = part_label(&RunLabel { program, plan: Some(plan), planned_for: None }, 2, 3);
        assert_eq!(label.program.as_deref(), Some("pick (part 2 of 3)"));
        assert_eq!(label.plan, None);
    }

    #[test]
    fn a_wait_keeps_a_bounded_number_of_samples() {
        let mut whole = WholeRun::default();
        whole.keep(0.0, [0.0; 7]);
        assert!(whole.run.samples.t_s.is_empty());
        let t_s: Vec<f64> = (0..MAX_SAMPLES - 1).map(|i| i as f64).collect();
        let q = vec![[0.0; 7]; t_s.len()];
        whole.add_measured(Measured::new(MeasuredPositions::new(t_s, q)));
        for t_s in [1e6, 2e6, 3e6] {
            whole.keep(t_s, [0.0; 7]);
        }
        assert_eq!(whole.run.samples.t_s.len(), MAX_SAMPLES);
        assert_eq!(whole.run.samples_left_out, 2);
    }
}
