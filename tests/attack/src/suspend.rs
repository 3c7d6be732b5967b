//! Trajectories during which the drive, the cabinet or both are suspended and resumed: the
//! commanded motion keeps the acceleration limits.
//!
//! A suspended process leaves messages in its queue, and answers them together when it is resumed.
//! Measured by arrival times, the acceleration can have any value; the arm follows the controller's
//! clock, which is in each message.
//!
//! An answer that a loaded machine delays by more than a cycle makes the controller extrapolate and
//! then return, at several times the limits. So positions are compared only where all answers
//! arrived in time, or where a late answer is due to a suspension.

use std::{
    path::Path,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use fastrand::Rng;
use iiwa_kin::Robot;

use super::{
    output::print,
    process::Process,
    report::Row,
    request::PendingRequest,
    rig::{Fault, Parts, Rig},
    tasks::Task,
    witness::{Recording, Sample},
};

/// Number and time of the rounds.
pub(super) struct SuspendExtent {
    pub(super) rounds: usize,
    pub(super) time: Duration,
}

/// Largest acceleration relative to its limit: that of the drive's governor.
const BOUND: f64 = 1.3;

/// Number of messages whose positions a late answer affects: the extrapolated position, the return
/// from it, and the following velocity.
const AFFECTED: usize = 4;

/// Interval in which processes were suspended, by the kernel's real-time clock.
type Suspension = [Duration; 2];

/// Suspended processes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Victims {
    Drive,
    Cabinet,
    Both,
}

impl Victims {
    const ALL: [Self; 3] = [Self::Drive, Self::Cabinet, Self::Both];

    fn name(self) -> &'static str {
        match self {
            Self::Drive => "the drive",
            Self::Cabinet => "the cabinet",
            Self::Both => "drive and cabinet",
        }
    }

    fn signal(self, rig: &Rig, name: &str) {
        let send = |process: &Option<Process>| {
            if let Some(process) = process {
                process.signal(name);
            }
        };
        if self != Self::Cabinet {
            send(&rig.drive);
        }
        if self != Self::Drive {
            send(&rig.cabinet);
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct SuspendTally {
    rounds: usize,
    /// Number of rounds in which the run ended with an error.
    ended: usize,
    /// Largest acceleration of the drive's set-points relative to its limit, by the stamps of the
    /// answered messages.
    answers: f64,
    /// Largest acceleration of the controller's positions, by its stamps.
    by_stamps: f64,
    /// Largest acceleration of the controller's positions, by the arrival times.
    by_arrival: f64,
    /// Number of answers that were late without a suspension.
    late: usize,
    failed: usize,
}

/// Makes rounds, each kind in turn.
pub(super) fn run(binary: &Path, seed: u64, extent: &SuspendExtent) -> Result<Vec<Row>, Fault> {
    let mut random = Rng::with_seed(seed);
    let mut rig = Rig::start(binary, Parts::default())?;
    let limits = Robot::default().limits().acceleration_rad_s2;
    let mut tallies = [SuspendTally::default(); 3];
    let begin = Instant::now();
    for round in 0..extent.rounds {
        if begin.elapsed() > extent.time && round >= Victims::ALL.len() {
            break;
        }
        let kind = round % Victims::ALL.len();
        let victims = Victims::ALL[kind];
        let outcome = rig.await_idle().and_then(|()| suspend(&rig, &mut random, victims));
        let tally = &mut tallies[kind];
        tally.rounds += 1;
        match outcome {
            Ok((recording, suspensions, is_complete)) => {
                let max = |samples: &[Sample], time: fn(&Sample) -> Duration| {
                    let samples = samples.iter().map(|it| (time(it).as_secs_f64(), it.joints_rad));
                    strongest(&samples.collect::<Vec<_>>(), &limits)
                };
                let answers = max(&recording.answers, |it| it.stamp);
                let late = late_answers(&recording, &suspensions);
                let by_stamps = punctual_sections(&recording.commanded, &late)
                    .into_iter()
                    .map(|section| max(section, |it| it.stamp))
                    .fold(0.0, f64::max);
                tally.late += late.len();
                tally.ended += usize::from(!is_complete);
                tally.answers = tally.answers.max(answers);
                tally.by_stamps = tally.by_stamps.max(by_stamps);
                tally.by_arrival = tally.by_arrival.max(max(&recording.commanded, |it| it.arrival));
                if by_stamps > BOUND {
                    print(&format!(
                        "round {round}: {} suspended: {answers:.2}, {by_stamps:.2} of the limit",
                        victims.name()
                    ));
                }
            }
            Err(fault) => {
                tally.failed += 1;
                print(&format!(
                    "round {round}, {} suspended: not attempted: {fault}",
                    victims.name()
                ));
                rig.restart()?;
            }
        }
    }
    Ok(Victims::ALL.iter().zip(tallies).map(|(victims, tally)| tally.row(*victims)).collect())
}

/// Runs a trajectory, and suspends processes on the way. Returns the messages from the beginning to
/// standstill, the suspensions, and true if the run was completed.
fn suspend(
    rig: &Rig,
    random: &mut Rng,
    victims: Victims,
) -> Result<(Recording, Vec<Suspension>, bool), Fault> {
    let from = rig.witness.position().ok_or("the witness has not seen the arm")?;
    let duration_s = 0.8 + random.f64();
    let task = Task::trajectory(&from, duration_s);
    rig.witness.begin_recording();
    let since = Instant::now();
    let run = PendingRequest::send(rig.addresses.requests, &task.request())?;
    rig.witness.await_move(since, Duration::from_secs(5)).ok_or("no motion begins")?;
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let mut suspensions = Vec::new();
    for _ in 0..random.usize(1..4) {
        thread::sleep(Duration::from_secs_f64(0.3 * duration_s * random.f64()));
        let begin = now();
        victims.signal(rig, "STOP");
        // From a part of a cycle to more than the time-out of a controller.
        thread::sleep(Duration::from_secs_f64(0.002 * 200_f64.powf(random.f64())));
        victims.signal(rig, "CONT");
        suspensions.push([begin, now()]);
    }
    let reply = run.reply(Duration::from_secs(10))?;
    rig.witness.await_rest(Duration::from_secs(5)).ok_or("the arm does not come to rest")?;
    Ok((rig.witness.end_recording(), suspensions, reply["ok"].as_bool() == Some(true)))
}

/// Returns the indices of messages that the drive answered later than the next message was sent,
/// without a suspension in between. Messages before the first answer and after the last one await
/// none.
fn late_answers(recording: &Recording, suspensions: &[Suspension]) -> Vec<usize> {
    let Recording { commanded, answers } = recording;
    let (Some(first), Some(last)) = (answers.first(), answers.last()) else { return Vec::new() };
    let is_late = |message: &Sample, next: &Sample| {
        let is_punctual =
            answers.iter().any(|it| it.stamp == message.stamp && it.arrival <= next.arrival);
        let is_suspended = suspensions
            .iter()
            .any(|[begin, end]| *begin <= next.arrival && message.arrival <= *end);
        (first.stamp..=last.stamp).contains(&message.stamp) && !is_punctual && !is_suspended
    };
    let pairs = commanded.windows(2).enumerate();
    pairs.filter(|(_, pair)| is_late(&pair[0], &pair[1])).map(|(index, _)| index).collect()
}

/// Returns the sections of messages that no late answer affects.
fn punctual_sections<'a>(commanded: &'a [Sample], late: &[usize]) -> Vec<&'a [Sample]> {
    let mut sections = Vec::new();
    let mut begin = 0;
    for &index in late {
        // The answer is due for the next message, so this one is still unaffected.
        if begin <= index {
            sections.push(&commanded[begin..=index]);
        }
        begin = (index + 1 + AFFECTED).min(commanded.len());
    }
    sections.push(&commanded[begin..]);
    sections
}

/// Returns the largest acceleration between three messages relative to its limit.
fn strongest(samples: &[(f64, [f64; 7])], limits_rad_s2: &[f64; 7]) -> f64 {
    let mut strongest = 0.0_f64;
    for three in samples.windows(3) {
        let [(t_0, q_0), (t_1, q_1), (t_2, q_2)] = [three[0], three[1], three[2]];
        if !(t_0 < t_1 && t_1 < t_2) {
            continue;
        }
        for joint in 0..7 {
            let before = (q_1[joint] - q_0[joint]) / (t_1 - t_0);
            let after = (q_2[joint] - q_1[joint]) / (t_2 - t_1);
            let acceleration = 2.0 * (after - before) / (t_2 - t_0);
            strongest = strongest.max(acceleration.abs() / limits_rad_s2[joint]);
        }
    }
    strongest
}

impl SuspendTally {
    fn row(&self, victims: Victims) -> Row {
        let Self { rounds, ended, answers, by_stamps, by_arrival, late, failed } = self;
        let failures =
            if *failed > 0 { format!(", {failed} could not be attempted") } else { String::new() };
        let measured = format!(
            "{rounds} rounds: set-points {answers:.2}, positions {by_stamps:.2} (by times of \
             arrival {by_arrival:.1}), {ended} runs ended early, {late} answers delayed by the \
             machine{failures}"
        );
        Row {
            quantity: format!("trajectory, {} suspended and resumed", victims.name()),
            required: format!(
                "at most {BOUND} of the acceleration limits, by the controller's stamps, where the \
                 machine delays no answer"
            ),
            measured,
            met: *by_stamps <= BOUND && *failed == 0 && *rounds > 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_acceleration_of_a_parabola_is_found_at_uneven_times() {
        let limits = [2.0; 7];
        let sample = |t: f64| (t, [0.0, -1.5 * t * t, 0.0, 0.0, 0.0, 0.0, 4.0 * t]);
        let samples: Vec<_> = [0.0, 0.004, 0.012, 0.013, 0.02].map(sample).to_vec();
        assert!((strongest(&samples, &limits) - 1.5).abs() < 1e-9);
    }

    /// Messages every 5 ms with a jump after the seventh, and punctual answers.
    fn recording_with_a_jump() -> Recording {
        let sample = |index: u64, delay_ms| {
            let stamp = Duration::from_millis(5 * index);
            let joints_rad = if index < 7 { [0.0; 7] } else { [0.01; 7] };
            Sample { arrival: stamp + Duration::from_millis(delay_ms), stamp, joints_rad }
        };
        Recording {
            commanded: (0..30).map(|index| sample(index, 0)).collect(),
            answers: (2..28).map(|index| sample(index, 1)).collect(),
        }
    }

    fn strongest_section(recording: &Recording, late: &[usize]) -> f64 {
        let sections = punctual_sections(&recording.commanded, late);
        let points = |section: &[Sample]| {
            section.iter().map(|it| (it.stamp.as_secs_f64(), it.joints_rad)).collect::<Vec<_>>()
        };
        sections.into_iter().map(|it| strongest(&points(it), &[10.0; 7])).fold(0.0, f64::max)
    }

    #[test]
    fn a_jump_counts_unless_the_machine_delayed_an_answer() {
        let mut recording = recording_with_a_jump();
        let late = late_answers(&recording, &[]);
        assert_eq!(late, [0_usize; 0]);
        assert!(strongest_section(&recording, &late) > 30.0);

        // The answer to the message before the jump arrives 1 ms after the next message.
        recording.answers[4].arrival += Duration::from_millis(5);
        let late = late_answers(&recording, &[]);
        assert_eq!(late, [6]);
        assert!(strongest_section(&recording, &late) < 1e-9);

        // By a suspension, it counts.
        let suspension = [Duration::from_millis(31), Duration::from_millis(34)];
        assert_eq!(late_answers(&recording, &[suspension]), [0_usize; 0]);
        // A suspension before it is no reason.
        let before = [Duration::from_millis(11), Duration::from_millis(14)];
        assert_eq!(late_answers(&recording, &[before]), [6]);
    }

    #[test]
    fn late_answers_in_succession_leave_the_sections_between_them() {
        let recording = recording_with_a_jump();
        let lengths = |late: &[usize]| -> Vec<usize> {
            punctual_sections(&recording.commanded, late).iter().map(|it| it.len()).collect()
        };
        assert_eq!(lengths(&[]), [30]);
        assert_eq!(lengths(&[6]), [7, 19]);
        assert_eq!(lengths(&[6, 8, 20]), [7, 8, 5]);
        assert_eq!(lengths(&[28]), [29, 0]);
    }

    #[test]
    fn a_jump_is_far_above_the_limits_and_equal_times_are_left_out() {
        let samples: [_; 10] = std::array::from_fn(|i| {
            let mut q = [0.0; 7];
            q[3] = if i < 5 { 0.0 } else { 0.01 };
            (0.004 * i as f64, q)
        });
        assert!(strongest(&samples, &[10.0; 7]) > 50.0);
        let at_once = samples.map(|(_, q)| (1.0, q));
        assert!(strongest(&at_once, &[10.0; 7]) == 0.0);
    }
}
