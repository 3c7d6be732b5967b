//! Trajectories during which the drive, the cabinet or both are suspended and resumed: the
//! commanded motion keeps the acceleration limits.
//!
//! A suspended process leaves messages in its queue, and answers them together when it is resumed.
//! Measured by arrival times, the acceleration can have any value; the arm follows the controller's
//! clock, which is in each message.

use std::{
    path::Path,
    thread,
    time::{Duration, Instant},
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
            Ok((recording, is_complete)) => {
                let max = |samples: &[Sample], time: fn(&Sample) -> Duration| {
                    let samples = samples.iter().map(|it| (time(it).as_secs_f64(), it.joints_rad));
                    strongest(&samples.collect::<Vec<_>>(), &limits)
                };
                let answers = max(&recording.answers, |it| it.stamp);
                let by_stamps = max(&recording.commanded, |it| it.stamp);
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
/// standstill, and true if the run was completed.
fn suspend(rig: &Rig, random: &mut Rng, victims: Victims) -> Result<(Recording, bool), Fault> {
    let from = rig.witness.position().ok_or("the witness has not seen the arm")?;
    let duration_s = 0.8 + random.f64();
    let task = Task::trajectory(&from, duration_s);
    rig.witness.begin_recording();
    let since = Instant::now();
    let run = PendingRequest::send(rig.addresses.requests, &task.request())?;
    rig.witness.await_move(since, Duration::from_secs(5)).ok_or("no motion begins")?;
    for _ in 0..random.usize(1..4) {
        thread::sleep(Duration::from_secs_f64(0.3 * duration_s * random.f64()));
        victims.signal(rig, "STOP");
        // From a part of a cycle to more than the time-out of a controller.
        thread::sleep(Duration::from_secs_f64(0.002 * 200_f64.powf(random.f64())));
        victims.signal(rig, "CONT");
    }
    let reply = run.reply(Duration::from_secs(10))?;
    rig.witness.await_rest(Duration::from_secs(5)).ok_or("the arm does not come to rest")?;
    Ok((rig.witness.end_recording(), reply["ok"].as_bool() == Some(true)))
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
        let Self { rounds, ended, answers, by_stamps, by_arrival, failed } = self;
        let failures =
            if *failed > 0 { format!(", {failed} could not be attempted") } else { String::new() };
        let measured = format!(
            "{rounds} rounds: set-points {answers:.2}, positions {by_stamps:.2} (by times of \
             arrival {by_arrival:.1}), {ended} runs ended early{failures}"
        );
        Row {
            quantity: format!("trajectory, {} suspended and resumed", victims.name()),
            required: format!(
                "at most {BOUND} of the limits of acceleration, by the controller's stamps"
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
