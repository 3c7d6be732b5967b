//! Requests to a drive, in JSON, and the check of the trajectories in them.

#![no_main]

use iiwa_kin::Robot;
use iiwa_link::message::Request;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (_, request) = Request::from_json(bytes);
    let request = match request {
        Ok(request) => request,
        Err(refusal) => {
            // For people, who read it on one line.
            assert!((1..=600).contains(&refusal.message.len()), "{}", refusal.message);
            assert!(!refusal.message.contains(char::is_control), "{:?}", refusal.message);
            return;
        }
    };
    let (_, again) = Request::from_json(request.to_json().as_bytes());
    assert_eq!(again.as_ref(), Ok(&request));
    if let Request::RunTrajectory { trajectory, .. } = &request {
        let start = trajectory.joints_rad.first().copied().unwrap_or_default();
        let checked = trajectory.check(Robot::default().limits(), &start);
        let end_s = trajectory.duration_s();
        for t_s in [-1.0, 0.0, end_s / 3.0, end_s, end_s + 1.0] {
            let q = trajectory.at(t_s);
            assert!(checked.is_err() || q.iter().all(|q| q.abs() < 10.0), "{q:?} at {t_s} s");
        }
    }
});
