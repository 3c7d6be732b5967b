//! Arbitrary messages.

use std::time::Duration;

use iiwa_fri::{
    Command, CommandMode, ControlMode, Drive, Monitoring, OperationMode, Overlay, Quality, Safety,
    SessionState,
};
use iiwa_kin::Joints;
use proptest::{array::uniform7, option, prelude::*, sample::select};

fn joints() -> impl Strategy<Value = Joints> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![uniform7(-3.0..3.0_f64), uniform7(POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO)]
}

fn counter() -> impl Strategy<Value = u32> {
    prop_oneof![0..1000_u32, any::<u32>(), Just(u32::MAX)]
}

fn session() -> impl Strategy<Value = SessionState> {
    use SessionState::{CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait};
    select(vec![Idle, MonitoringWait, MonitoringReady, CommandingWait, CommandingActive])
}

fn quality() -> impl Strategy<Value = Quality> {
    select(vec![Quality::Poor, Quality::Fair, Quality::Good, Quality::Excellent])
}

fn safety() -> impl Strategy<Value = Safety> {
    select(vec![Safety::Normal, Safety::Stop0, Safety::Stop1, Safety::Stop2])
}

fn operation_mode() -> impl Strategy<Value = OperationMode> {
    select(vec![OperationMode::T1, OperationMode::T2, OperationMode::Automatic])
}

fn drive() -> impl Strategy<Value = Drive> {
    select(vec![Drive::Off, Drive::Transitioning, Drive::Active])
}

fn control_mode() -> impl Strategy<Value = ControlMode> {
    use ControlMode::{CartesianImpedance, JointImpedance, None, Position};
    select(vec![Position, CartesianImpedance, JointImpedance, None])
}

fn command_mode() -> impl Strategy<Value = CommandMode> {
    use CommandMode::{None, Position, Torque, Wrench};
    select(vec![None, Position, Wrench, Torque])
}

fn overlay() -> impl Strategy<Value = Overlay> {
    select(vec![Overlay::None, Overlay::Joint, Overlay::Cartesian])
}

fn time() -> impl Strategy<Value = Duration> {
    (any::<u32>(), 0..1_000_000_000_u32).prop_map(|(s, ns)| Duration::new(s.into(), ns))
}

prop_compose! {
    /// Generates any monitoring message.
    pub(crate) fn any_monitoring()(
        (sequence, reflected) in (counter(), counter()),
        (session, quality) in (session(), quality()),
        (send_period_ms, receive_multiplier) in
            (0..=100_u32, prop_oneof![1..=20_u32, 1..=u32::MAX]),
        (safety, operation_mode) in (option::of(safety()), option::of(operation_mode())),
        (drive, control_mode) in (option::of(drive()), option::of(control_mode())),
        (measured_rad, measured_torque_nm) in (option::of(joints()), option::of(joints())),
        (commanded_rad, commanded_torque_nm) in (option::of(joints()), option::of(joints())),
        (external_torque_nm, ipo_rad) in (option::of(joints()), option::of(joints())),
        (command_mode, overlay) in (option::of(command_mode()), option::of(overlay())),
        (tracking_performance, time) in (option::of(0.0..=1.0_f64), option::of(time())),
    ) -> Monitoring {
        Monitoring {
            sequence, reflected, session, quality, send_period_ms, receive_multiplier, safety,
            operation_mode, drive, control_mode, measured_rad, measured_torque_nm, commanded_rad,
            commanded_torque_nm, external_torque_nm, ipo_rad, command_mode, overlay,
            tracking_performance, time,
        }
    }
}

prop_compose! {
    /// Generates any command message.
    pub(crate) fn any_command()(
        sequence in counter(), reflected in counter(), joints_rad in option::of(joints()),
    ) -> Command {
        Command { sequence, reflected, joints_rad }
    }
}
