//! Joint positions: those that are read are in order and in reach, and come back from CSV.

#![no_main]

use iiwa_log::{JointLog, Loss};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(log) = JointLog::read(bytes) else { return };
    assert!(!log.t_s.is_empty() && log.t_s.len() == log.q_rad.len());
    assert!(log.t_s.is_sorted_by(|before, after| before < after));
    assert!(log.q_rad.iter().flatten().all(|q| q.abs() <= 3.2));
    for loss in &log.losses {
        assert!(!loss.to_string().is_empty());
    }

    let mut csv = Vec::new();
    log.write_csv(&mut csv).expect("memory takes everything");
    // A table is also held against the speed of a robot; a recording in MCAP is not.
    let Ok(again) = JointLog::read(&*csv) else { return };
    assert_eq!((&again.t_s, &again.q_rad), (&log.t_s, &log.q_rad));
    assert!(again.losses.iter().all(|loss| matches!(loss, Loss::Gap { .. })));
});
