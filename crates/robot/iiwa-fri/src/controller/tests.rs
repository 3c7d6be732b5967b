//! Session rules: quality, state transitions, deadlines.

use SessionState::{CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait};

use super::*;

fn tick(controller: &mut Controller) -> Monitoring {
    let mut out = Vec::new();
    assert!(controller.tick(&Reading::default(), &mut out));
    Format::V1.decode_monitoring(&out).unwrap()
}

/// Answers with all joints at 0, the position of the robot. Returns true if the answer was
/// accepted.
fn answer(controller: &mut Controller, sequence: u32, reflected: u32) -> bool {
    give(controller, &Command { sequence, reflected, joints_rad: Some([0.0; 7]) })
}

fn give(controller: &mut Controller, command: &Command) -> bool {
    let mut bytes = Vec::new();
    Format::V1.encode_command(command, &mut bytes);
    let before = controller.counters().accepted;
    controller.receive(&bytes).unwrap();
    controller.counters().accepted > before
}

/// Runs the session for `n` cycles, answering the messages for which `answers` is true.
fn run(controller: &mut Controller, n: u32, answers: impl Fn(u32) -> bool) {
    for i in 0..n {
        let message = tick(controller);
        if answers(i) {
            let next = controller.accepted.map_or(0, |(sequence, _)| sequence.wrapping_add(1));
            assert!(answer(controller, next, message.sequence));
        }
    }
}

fn in_state(state: SessionState) -> Controller {
    let mut controller = Controller::default();
    if state.commands() {
        controller.request_commanding();
    }
    while controller.state() != state {
        run(&mut controller, 1, |_| true);
    }
    controller
}

#[test]
fn quality_is_the_share_of_answers() {
    for (missing, expected) in [
        (0, Quality::Excellent),
        (1, Quality::Excellent),
        (2, Quality::Good),
        (5, Quality::Good),
        (6, Quality::Fair),
        (20, Quality::Fair),
        (21, Quality::Poor),
        (100, Quality::Poor),
    ] {
        let mut controller = Controller::default();
        run(&mut controller, 102, |i| i >= missing);
        assert_eq!(controller.quality(), expected, "{missing} missing");
        assert_eq!(controller.counters().missed, u64::from(missing));
    }
}

#[test]
fn the_quality_is_poor_before_enough_answers_were_expected() {
    let mut controller = Controller::default();
    run(&mut controller, 51, |_| true);
    assert_eq!((controller.state(), controller.quality()), (MonitoringWait, Quality::Poor));
    run(&mut controller, 1, |_| true);
    assert_eq!((controller.state(), controller.quality()), (MonitoringReady, Quality::Excellent));
    // Three missing out of fifty are too many; a share that recovers within fewer than fifty
    // answers is not sufficient either.
    let mut controller = Controller::default();
    run(&mut controller, 52, |i| i >= 3);
    assert_eq!((controller.state(), controller.quality()), (MonitoringWait, Quality::Fair));
    run(&mut controller, 10, |_| true);
    assert_eq!((controller.state(), controller.quality()), (MonitoringReady, Quality::Good));
    run(&mut controller, 5, |_| false);
    assert_eq!(controller.state(), MonitoringWait);
    run(&mut controller, 46, |_| true);
    assert_eq!(controller.state(), MonitoringWait);
}

#[test]
fn an_answer_counts_until_the_tick_after_next() {
    let mut controller = Controller::default();
    for n in 0..=10 {
        tick(&mut controller);
        // Always answers the message before the last one.
        if n > 0 {
            assert!(answer(&mut controller, n, n - 1));
        }
    }
    assert_eq!(controller.missed(), 0);
    tick(&mut controller);
    tick(&mut controller);
    assert_eq!(controller.missed(), 1);
    assert!(!answer(&mut controller, 50, 10), "two periods old");
    assert!(answer(&mut controller, 50, 11));
    assert!(!answer(&mut controller, 51, 13), "not sent yet");
    assert!(!answer(&mut controller, 51, 11_u32.wrapping_sub(20)), "of no session");
    tick(&mut controller);
    assert_eq!(controller.missed(), 0);
}

#[test]
fn old_answers_are_ignored_and_restarted_clients_are_not() {
    let mut controller = Controller::default();
    assert_eq!(controller.answered(), None);
    run(&mut controller, 30, |_| true);
    tick(&mut controller);
    assert!(!answer(&mut controller, 29, 30), "repeated");
    assert_eq!(controller.answered(), Some(29));
    assert!(answer(&mut controller, 35, 30));
    assert_eq!(controller.answered(), Some(30));
    tick(&mut controller);
    assert!(!answer(&mut controller, 36, 29), "reflects an older message");
    assert!(!answer(&mut controller, 34, 30), "older by its own counter");
    assert!(answer(&mut controller, 0, 31), "a new client");
    assert!(!answer(&mut controller, 36, 30), "of the client before");
    tick(&mut controller);
    assert!(answer(&mut controller, 1, 32));
    assert_eq!(controller.counters().ignored, 4);
    assert!(controller.receive(b"garbage").is_err());
    assert_eq!(controller.counters().invalid, 1);
}

#[test]
fn counters_wrap_around() {
    let mut controller = Controller { sequence: u32::MAX - 20, ..Controller::default() };
    tick(&mut controller);
    assert!(answer(&mut controller, u32::MAX - 40, u32::MAX - 20));
    run(&mut controller, 100, |_| true);
    assert_eq!(controller.counters().accepted, 101);
    assert_eq!((controller.state(), controller.missed()), (MonitoringReady, 0));
    assert_eq!(controller.sequence, 80);
    assert_eq!(controller.accepted, Some((59, 79)));
}

#[test]
fn commanding_takes_joints() {
    let header = |controller: &mut Controller| {
        let n = tick(controller).sequence;
        give(controller, &Command { sequence: n, reflected: n, joints_rad: None });
    };
    let mut controller = Controller::default();
    for _ in 0..110 {
        header(&mut controller);
    }
    assert_eq!((controller.state(), controller.missed()), (MonitoringReady, 0));
    controller.request_commanding();
    for _ in 0..7 {
        header(&mut controller);
    }
    assert_eq!((controller.state(), controller.missed()), (CommandingWait, 5));
    header(&mut controller);
    assert!(controller.lost_commanding());
    assert_eq!((controller.state(), controller.missed()), (MonitoringWait, 6));
}

#[test]
fn a_missing_setpoint_begins_the_row_anew() {
    let mut controller = in_state(CommandingWait);
    run(&mut controller, 30, |i| i != 2 && i != 5);
    assert_eq!(controller.state(), CommandingActive);
    let mut controller = in_state(CommandingWait);
    run(&mut controller, 8, |i| i != 2);
    assert_eq!(controller.state(), CommandingWait);
}

#[test]
fn a_setpoint_lasts_as_long_as_the_next_one_takes() {
    for multiplier in [1, 4] {
        let mut controller = Controller::new(ControllerConfig {
            receive_multiplier: multiplier,
            ..ControllerConfig::default()
        });
        controller.request_commanding();
        while controller.state() != CommandingActive {
            run(&mut controller, multiplier, |i| i == 0);
        }
        run(&mut controller, 1, |_| true);
        for _ in 0..multiplier {
            tick(&mut controller);
            assert!(controller.setpoint().is_some());
        }
        tick(&mut controller);
        assert!(controller.setpoint().is_none());
    }
}

#[test]
fn an_idle_session_is_reported_once() {
    let mut controller = in_state(CommandingActive);
    run(&mut controller, 5, |_| true);
    let sequence = controller.sequence;
    controller.drop_session(3);
    assert_eq!((controller.state(), controller.quality()), (Idle, Quality::Poor));
    assert!(!answer(&mut controller, sequence, sequence - 1));
    let message = tick(&mut controller);
    assert_eq!((message.sequence, message.session), (sequence, Idle));
    let mut out = vec![1];
    for _ in 0..2 {
        assert!(!controller.tick(&Reading::default(), &mut out));
        assert!(out.is_empty());
    }
    let message = tick(&mut controller);
    assert_eq!((message.sequence, message.session), (sequence + 1, MonitoringWait));
    assert!(!answer(&mut controller, sequence, sequence), "to the idle message");
    assert!(answer(&mut controller, sequence, sequence + 1));
    assert_eq!(message.quality, Quality::Poor);
}

#[test]
fn a_configuration_is_clamped_to_its_bounds() {
    for (period_ms, expected) in [(0, 1), (1, 1), (100, 100), (101, 100)] {
        let config =
            ControllerConfig { period_ms, receive_multiplier: 0, ..ControllerConfig::default() };
        let message = tick(&mut Controller::new(config));
        assert_eq!((message.send_period_ms, message.receive_multiplier), (expected, 1));
    }
}

#[test]
fn messages_report_the_state_of_the_robot() {
    let mut controller = in_state(MonitoringReady);
    assert_eq!(tick(&mut controller).ipo_rad, None);
    let mut controller = in_state(CommandingWait);
    let reading = Reading {
        measured_rad: [1.0; 7],
        commanded_rad: [2.0; 7],
        measured_torque_nm: [3.0; 7],
        external_torque_nm: [4.0; 7],
        time: Duration::from_secs(5),
        safety: Safety::Stop1,
        ipo_rad: None,
    };
    let mut out = Vec::new();
    assert!(controller.tick(&reading, &mut out));
    let message = Format::V1.decode_monitoring(&out).unwrap();
    assert_eq!(message.measured_rad, Some([1.0; 7]));
    assert_eq!((message.commanded_rad, message.ipo_rad), (Some([2.0; 7]), Some([2.0; 7])));
    assert_eq!(message.measured_torque_nm, Some([3.0; 7]));
    assert_eq!(message.external_torque_nm, Some([4.0; 7]));
    assert_eq!(message.time, Some(Duration::from_secs(5)));
    assert_eq!((message.safety, message.drive), (Some(Safety::Stop1), Some(Drive::Off)));
    assert_eq!(message.command_mode, Some(CommandMode::Position));
}

#[test]
fn setpoints_are_in_place_within_the_tolerance_either_way() {
    for (off_rad, is_in_place) in
        [(0.9e-3, true), (-0.9e-3, true), (1.1e-3, false), (-1.1e-3, false), (-1.0, false)]
    {
        for joint in [0, 6] {
            let mut controller = in_state(CommandingWait);
            let mut joints = [0.0; 7];
            joints[joint] = off_rad;
            for _ in 0..10 {
                let reflected = tick(&mut controller).sequence;
                let sequence =
                    controller.accepted.map_or(0, |(sequence, _)| sequence.wrapping_add(1));
                let joints_rad = Some(joints);
                assert!(give(&mut controller, &Command { sequence, reflected, joints_rad }));
            }
            let expected = if is_in_place { CommandingActive } else { CommandingWait };
            assert_eq!(controller.state(), expected, "joint {joint}, {off_rad} rad");
        }
    }
}
