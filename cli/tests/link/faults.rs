//! Interrupts, and killed processes.

use std::{
    thread,
    time::{Duration, Instant},
};

use iiwasim_tests::realtime_guard::in_real_time;
use predicates::str::contains;

use crate::link::rig::{Process, Rig, wait_for};

/// Checks that the robot runs normally.
fn assert_works(rig: &Rig) {
    rig.wait_until_ready(&[]);
    let program = rig.slow_program();
    rig.iiwasim("run", &[program, "--move-to-start=100", "-o", "after.mcap", "--overwrite"])
        .success();
    assert!((rig.joint_1().to_degrees() - 60.0).abs() < 1e-3);
}

/// Checks that the file of an aborted run begins at the start and does not reach the end.
fn assert_cut(rig: &Rig, name: &str) {
    let recording = rig.recording(name);
    let [first, .., last] = recording.joint_states.as_slice() else { panic!("no states") };
    assert!(first.q[0].abs() < 0.05 && last.q[0] > 0.1 && last.q[0] < 1.0, "{first:?} {last:?}");
}

#[test]
fn an_interrupt_stops_the_robot_on_its_path() {
    in_real_time(|| {
        let rig = Rig::new();
        for options in [&[][..], &["--as-trajectory", "--move-to-start=100"]] {
            let running = rig.slow_program();
            let running =
                rig.begin("run", &[options, &[running, "-o", "cut.mcap", "--overwrite"]].concat());
            wait_for("a run", || running.stdout().contains("Cycle time"));
            // After the motion to the start, if any.
            wait_for("start", || rig.joint_1() < 0.1);
            wait_for("motion", || rig.joint_1() > 0.2);
            running.signal("INT");
            let ended = running.end().code(1);
            assert!(ended.stderr.contains("the robot is at rest"), "{}", ended.stderr);
            assert!(ended.stderr.contains("did not finish the program: stopped on request at"));
            assert!(ended.stdout.contains("\nEnded after "), "{}", ended.stdout);
            assert!(!ended.stdout.contains("Measured"), "{}", ended.stdout);
            assert_cut(&rig, "cut.mcap");
            let position = rig.joint_1();
            thread::sleep(Duration::from_millis(100));
            assert_eq!((rig.joint_1(), position < 1.0), (position, true));
            assert_eq!(rig.json("status", &[])["state"], "idle");
        }
        assert_works(&rig);
    });
}

#[test]
fn an_interrupt_stops_the_move_to_the_start() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        rig.start_cabinet(&["--start-deg", "90,0,0,0,0,0,0"]);
        rig.start_drive(&[]);
        rig.wait_until_ready(&[]);
        let running = rig.begin("run", &[rig.slow_program(), "--move-to-start"]);
        wait_for("motion", || rig.joint_1() < 1.5);
        running.signal("INT");
        let ended = running.end().code(1);
        assert!(ended.stderr.contains("did not move to the start: stopped"), "{}", ended.stderr);
        assert!(rig.joint_1() > 0.5);
        assert!(!rig.path("slow.measured.mcap").exists());
    });
}

#[test]
fn a_killed_recorder_leaves_a_file() {
    in_real_time(|| {
        let rig = Rig::new();
        let mut recorder = rig.begin("record", &["-o", "r.mcap"]);
        let last_s = || rig.recording_so_far("r.mcap").last().map(|sample| sample.t_s);
        wait_for("samples", || last_s().is_some());
        let (begin, from_s) = (Instant::now(), last_s().unwrap());
        thread::sleep(Duration::from_millis(2300));
        assert!(!recorder.has_ended());
        let recorded_s = begin.elapsed().as_secs_f64();
        recorder.signal("KILL");
        assert_eq!(recorder.end().status.code(), None);
        let kept_s = rig.recording("r.mcap").joint_states.last().unwrap().t_s - from_s;
        // A second, plus the delay of a busy machine.
        assert!(kept_s > recorded_s - 1.3, "{kept_s} s of {recorded_s} s");
    });
}

#[test]
fn a_killed_cabinet_ends_the_run() {
    in_real_time(|| {
        let mut rig = Rig::new();
        for options in [&[][..], &["--as-trajectory"]] {
            let running = rig.begin_run(&[&["-o", "cut.mcap", "--overwrite"], options].concat());
            let cabinet = rig.cabinet.take().unwrap();
            cabinet.signal("KILL");
            drop(cabinet);
            let ended = running.end().code(1);
            assert!(ended.stderr.contains("did not finish the program"), "{}", ended.stderr);
            assert_cut(&rig, "cut.mcap");
            // The data of the robot are outdated.
            rig.iiwasim("run", &[rig.slow_program()])
                .code(1)
                .stderr(contains("the drive receives nothing from the controller"));
            rig.start_cabinet(&[]);
            rig.wait_until_ready(&[]);
        }
        assert_works(&rig);
    });
}

#[test]
fn a_cabinet_that_is_started_again_at_once_ends_the_run() {
    in_real_time(|| {
        let mut rig = Rig::new();
        let running = rig.begin_run(&["-o", "cut.mcap"]);
        rig.cabinet = None;
        rig.start_cabinet(&[]);
        let ended = running.end().code(1);
        assert!(ended.stderr.contains("restarted during the run"), "{}", ended.stderr);
        // The new cabinet is at its start pose.
        let states = rig.recording("cut.mcap").joint_states;
        assert!(states.iter().any(|state| state.q[0] > 0.1));
        assert_works(&rig);
    });
}

fn kill_drive(rig: &mut Rig, running: Process) {
    let drive = rig.drive.take().unwrap();
    drive.signal("KILL");
    drop(drive);
    let ended = running.end().code(1);
    assert!(
        ended.stderr.contains("the robot may still be moving: the connection"),
        "{}",
        ended.stderr
    );
    assert!(ended.stdout.contains("samples recorded in"), "{}", ended.stdout);
    assert_cut(rig, "cut.mcap");
}

#[test]
fn a_killed_drive_ends_the_run() {
    in_real_time(|| {
        let mut rig = Rig::new();
        let running = rig.begin_run(&["-o", "cut.mcap"]);
        kill_drive(&mut rig, running);
        rig.start_drive(&[]);
        // The controller continues its motion.
        wait_for("the end", || (rig.joint_1().to_degrees() - 60.0).abs() < 1e-3);
        assert_works(&rig);
    });
}

#[test]
fn a_killed_drive_ends_the_trajectory() {
    in_real_time(|| {
        let mut rig = Rig::new();
        let running = rig.begin_run(&["-o", "cut.mcap", "--as-trajectory"]);
        kill_drive(&mut rig, running);
        rig.start_drive(&[]);
        rig.wait_until_ready(&[]);
        assert!(rig.joint_1() < 1.0);
        assert_works(&rig);
    });
}
