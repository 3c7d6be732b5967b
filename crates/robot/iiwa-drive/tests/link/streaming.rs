//! Subscribers receive every message, and a subscriber that does not read does not affect the
//! others.
//!
//! The backlog of such a subscriber is bounded: by the buffer of its socket, here nearly zero, by
//! the system's buffers, and by the drive's limit of 2000 messages, about 1 MB. The drive drops
//! messages beyond that for this subscriber, and disconnects it after some seconds without
//! progress.

use std::time::{Duration, Instant};

use iiwa_link::{Published, Stream};
use iiwasim_tests::{
    realtime_guard::in_real_time,
    socket::{Socket, SocketType},
};
use serde::Deserialize;

use crate::link::rig::{LONG, Rig, wait_for};

/// Number of subscribers that read.
const LIVE: usize = 9;
const PERIOD_S: f64 = 0.001;
/// Pause of a subscriber, longer than its backlog (2 s).
const ASLEEP: Duration = Duration::from_secs(6);

/// A subscriber with a minimal buffer.
fn sleeper(rig: &Rig) -> Socket {
    let socket = Socket::connect(SocketType::Sub, &rig.drive_config.stream).unwrap();
    socket.subscribe(b"joints").unwrap();
    socket
}

/// Returns the stamp of the next message.
fn take(sleeper: &Socket) -> Option<f64> {
    #[derive(Deserialize)]
    struct Stamp {
        t_s: f64,
    }
    let frames = sleeper.receive(LONG)?;
    Some(serde_json::from_slice::<Stamp>(&frames[1]).unwrap().t_s)
}

/// Collects stamps until no message is available or `enough` returns true.
fn follow(
    stream: &mut Stream,
    stamps: &mut Vec<f64>,
    timeout: Duration,
    enough: impl Fn(f64) -> bool,
) {
    while let Some(published) = stream.next(timeout).unwrap() {
        if let Published::Joints { t_s, .. } = published {
            stamps.push(t_s);
            if enough(t_s) {
                return;
            }
        }
    }
}

/// Returns the number of messages between two stamps, both included.
fn count(first_s: f64, last_s: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands")]
    let periods = ((last_s - first_s) / PERIOD_S).round() as u64;
    periods + 1
}

/// Asserts that every message was answered, except messages lost in transit or while the machine
/// delayed even the controller. The controller is silent afterwards.
fn assert_answered(rig: &Rig) {
    rig.cabinet().silence(Duration::from_hours(1));
    let drive = rig.drive.as_ref().unwrap();
    wait_for("the last answer", || {
        let answer_latency = drive.answer_latency();
        answer_latency.answered == answer_latency.received
    });
    let (answer_latency, report) = (drive.answer_latency(), rig.cabinet().report());
    let (late, delayed) = (report.late.len(), report.delayed_cycles);
    let lost = rig.client().state().unwrap().fri.lost;
    println!("{answer_latency:?}; {late} late, {lost} lost, {delayed} delayed cycles");
    assert!(report.unanswered <= lost || delayed > 0, "{} unanswered", report.unanswered);
}

#[test]
fn a_subscriber_that_does_not_read_does_not_affect_others() {
    in_real_time(|| {
        let without = Rig::new(1);
        std::thread::sleep(Duration::from_secs(2));
        assert_answered(&without);
        drop(without);

        let rig = Rig::new(1);
        let asleep = sleeper(&rig);
        let mut live: Vec<(Stream, Vec<f64>)> =
            (0..LIVE).map(|_| (rig.stream(), Vec::new())).collect();
        for (stream, stamps) in &mut live {
            follow(stream, stamps, LONG, |_| true);
        }
        let first_s = take(&asleep).unwrap();
        let since = Instant::now();
        while since.elapsed() < ASLEEP {
            for (stream, stamps) in &mut live {
                follow(stream, stamps, Duration::ZERO, |_| false);
            }
            std::thread::sleep(Duration::from_millis(1));
        }

        // The subscriber receives the messages in the system's buffers, and then current ones.
        let awake_s = *live[0].1.last().unwrap();
        let mut stamps = vec![first_s];
        while *stamps.last().unwrap() < awake_s + 0.1 {
            stamps.push(take(&asleep).expect("the sleeper is published to again"));
        }
        assert!(stamps.is_sorted_by(|a, b| a < b));
        let missed = count(first_s, *stamps.last().unwrap()) - stamps.len() as u64;
        assert!(missed > 100, "it has missed {missed} only");

        // The others have received all messages of the drive, up to the last one.
        assert_answered(&rig);
        let status = rig.client().state().unwrap();
        let last_s = status.t_s.unwrap();
        for (stream, stamps) in &mut live {
            follow(stream, stamps, LONG, |t_s| t_s == last_s);
            assert!(stamps.is_sorted_by(|a, b| a < b));
            assert_eq!(*stamps.last().unwrap(), last_s);
            let missed = count(stamps[0], last_s) - stamps.len() as u64;
            assert!(missed <= status.fri.lost, "{missed} missed");
        }
        println!("{} messages each; the sleeper missed {missed}", live[0].1.len());
    });
}
