//! Client against controller, in memory.

use std::time::Duration;

use SessionState::{CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait};
use iiwa_fri::{
    Controller, ControllerConfig, Format, FriClient, Quality, Reading, Received, SessionState,
};
use iiwa_kin::Joints;

use crate::network::Network;

const HOME: Joints = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7];

/// Both sides, the network between them, and a robot that follows its set-points exactly.
struct Cell {
    controller: Controller,
    client: FriClient,
    down: Network,
    up: Network,
    robot: Joints,
    /// `true` if the client answers, and its set-point.
    answers: bool,
    setpoint: Option<Joints>,
    cycle: u64,
    states: Vec<SessionState>,
    events: Vec<Received>,
}

impl Cell {
    fn new(receive_multiplier: u32, seed: u64) -> Self {
        let config = ControllerConfig { receive_multiplier, ..ControllerConfig::default() };
        Self {
            controller: Controller::new(config),
            client: FriClient::new(Format::V1),
            down: Network::new(seed),
            up: Network::new(seed ^ 0xffff),
            robot: HOME,
            answers: true,
            setpoint: None,
            cycle: 0,
            states: Vec::new(),
            events: Vec::new(),
        }
    }

    fn cycle(&mut self) {
        let reading = Reading {
            measured_rad: self.robot,
            commanded_rad: self.robot,
            ipo_rad: self.controller.state().commands().then_some(HOME),
            time: Duration::from_millis(5 * self.cycle),
            ..Reading::default()
        };
        let mut bytes = Vec::new();
        if self.controller.tick(&reading, &mut bytes) {
            self.down.send(&bytes);
        }
        if let Some(setpoint) = self.controller.setpoint() {
            self.robot = *setpoint;
        }
        if self.states.last() != Some(&self.controller.state()) {
            self.states.push(self.controller.state());
        }
        for datagram in self.down.receive() {
            self.events.push(self.client.receive(&datagram).unwrap());
            let active = self.client.latest().unwrap().session == CommandingActive;
            let setpoint = self.setpoint.filter(|_| active);
            if self.answers && self.client.answer(setpoint.as_ref(), &mut bytes) {
                self.up.send(&bytes);
            }
        }
        for datagram in self.up.receive() {
            self.controller.receive(&datagram).unwrap();
        }
        self.down.next_cycle();
        self.up.next_cycle();
        self.cycle += 1;
    }

    fn cycles(&mut self, n: u32) {
        for _ in 0..n {
            self.cycle();
        }
    }

    /// Runs until the session is in `state`.
    fn until(&mut self, state: SessionState) -> u32 {
        for n in 0..10_000 {
            if self.controller.state() == state {
                return n;
            }
            self.cycle();
        }
        panic!("no {} in 10000 cycles, but {:?}", state.name(), self.states);
    }
}

#[test]
fn goes_through_all_states() {
    let mut cell = Cell::new(1, 0);
    assert_eq!(cell.controller.state(), Idle);
    // The 50th expected answer, to message 49, is evaluated at tick 51, the 52nd.
    assert_eq!(cell.until(MonitoringReady), 52);
    assert_eq!(cell.controller.quality(), Quality::Excellent);
    cell.cycles(10);
    assert_eq!(cell.controller.state(), MonitoringReady);
    assert_eq!(cell.controller.setpoint(), None);

    cell.controller.request_commanding();
    cell.until(CommandingWait);
    assert_eq!(cell.controller.setpoint(), None);
    assert_eq!(cell.until(CommandingActive), 5);
    assert_eq!(cell.controller.setpoint(), Some(&HOME));

    let moved = HOME.map(|q| q + 0.01);
    cell.setpoint = Some(moved);
    cell.cycles(3);
    assert_eq!(cell.controller.setpoint(), Some(&moved));
    assert_eq!(cell.robot, moved);
    assert_eq!(cell.client.latest().unwrap().measured_rad, Some(moved));
    assert_eq!(cell.client.latest().unwrap().ipo_rad, Some(HOME));

    cell.controller.release();
    assert_eq!((cell.controller.state(), cell.controller.setpoint()), (MonitoringReady, None));
    cell.cycles(100);
    assert!(!cell.controller.lost_commanding());
    cell.controller.drop_session(20);
    cell.cycles(20);
    assert_eq!(cell.controller.state(), Idle);
    assert_eq!(cell.client.latest().unwrap().session, Idle);
    cell.until(MonitoringReady);
    assert_eq!(
        cell.states,
        [
            MonitoringWait,
            MonitoringReady,
            CommandingWait,
            CommandingActive,
            MonitoringReady,
            Idle,
            MonitoringWait,
            MonitoringReady
        ]
    );
    let counters = cell.client.counters();
    // One message reports the idle session and is not answered; the next 19 cycles send nothing.
    assert_eq!((counters.received, counters.answered), (cell.cycle - 19, cell.cycle - 20));
    assert_eq!((counters.lost, counters.late, counters.repeated, counters.invalid), (0, 0, 0, 0));
    assert_eq!(cell.controller.counters().accepted, counters.answered);
}

#[test]
fn answers_every_so_many_messages() {
    for multiplier in [2, 5, 20] {
        let mut cell = Cell::new(multiplier, 0);
        cell.controller.request_commanding();
        cell.until(CommandingActive);
        cell.setpoint = Some(HOME.map(|q| q + 0.01));
        for _ in 0..20 * multiplier {
            cell.cycle();
            assert!(cell.controller.setpoint().is_some());
        }
        assert_eq!(cell.client.counters().answered, cell.cycle.div_ceil(multiplier.into()));
        assert_eq!(cell.controller.quality(), Quality::Excellent);
        assert_eq!(cell.controller.counters().ignored, 0);
    }
}

#[test]
fn a_little_loss_and_delay_does_not_end_commanding() {
    for seed in 0..20 {
        let mut cell = Cell::new(1, seed);
        for network in [&mut cell.down, &mut cell.up] {
            network.loss = 0.002;
            network.doubled = 0.05;
            network.delayed = (0.02, 1);
        }
        cell.controller.request_commanding();
        cell.until(CommandingActive);
        let mut count = 0;
        for n in 0..2000 {
            cell.setpoint = Some(HOME.map(|q| q + 1e-5 * f64::from(n)));
            cell.cycle();
            assert!(cell.controller.quality() >= Quality::Good, "seed {seed}, cycle {n}");
            count += u32::from(cell.controller.setpoint().is_none());
        }
        assert_eq!(cell.controller.state(), CommandingActive);
        assert!((10..200).contains(&count), "{count}");
        let counters = cell.client.counters();
        assert!(counters.lost > 0 && counters.repeated + counters.late > 50, "{counters:?}");
        assert!(!cell.events.contains(&Received::Restarted));
    }
}

/// For any network faults, state transitions follow the table, and the session recovers with the
/// network.
#[test]
fn survives_bad_networks() {
    for seed in 0..50 {
        let mut cell = Cell::new(1 + u32::try_from(seed % 3).unwrap(), seed);
        for network in [&mut cell.down, &mut cell.up] {
            network.loss = 0.01 * (seed % 30) as f64;
            network.doubled = 0.1;
            network.delayed = (0.3, 15);
        }
        for _ in 0..2000 {
            cell.controller.request_commanding();
            cell.cycle();
        }
        for pair in cell.states.windows(2) {
            let allowed: &[SessionState] = match pair[0] {
                MonitoringWait => &[MonitoringReady],
                MonitoringReady => &[MonitoringWait, CommandingWait],
                CommandingWait => &[MonitoringWait, CommandingActive],
                Idle | CommandingActive => &[MonitoringWait],
            };
            assert!(allowed.contains(&pair[1]), "{pair:?}");
        }
        assert!(!cell.events.contains(&Received::Restarted));
        for network in [&mut cell.down, &mut cell.up] {
            (network.loss, network.doubled, network.delayed) = (0.0, 0.0, (0.0, 1));
        }
        cell.controller.request_commanding();
        cell.until(CommandingActive);
        cell.cycles(300);
        assert_eq!(cell.controller.quality(), Quality::Excellent);
        assert_eq!(cell.controller.missed(), 0);
    }
}

#[test]
fn silence_ends_commanding() {
    let mut cell = Cell::new(1, 0);
    cell.controller.request_commanding();
    cell.until(CommandingActive);
    cell.cycles(100);
    cell.answers = false;
    cell.cycle();
    // The last answer arrived before this tick; without another one, the set-point expires in the
    // next cycle.
    assert!(cell.controller.setpoint().is_some());
    cell.cycle();
    assert!(cell.controller.setpoint().is_none());
    assert_eq!(cell.controller.missed(), 0);
    let mut cycles = 2;
    while !cell.controller.lost_commanding() {
        assert_eq!(cell.controller.state(), CommandingActive);
        cell.cycle();
        cycles += 1;
    }
    // Six answers, each missing when the tick after next begins.
    assert_eq!((cycles, cell.controller.missed()), (8, 6));
    assert_eq!(cell.controller.state(), MonitoringWait);
    assert_eq!(cell.controller.quality(), Quality::Fair);
    cell.cycles(15);
    assert!(!cell.controller.lost_commanding());
    assert_eq!(cell.controller.quality(), Quality::Poor);
    cell.answers = true;
    cell.until(MonitoringReady);
    cell.cycles(50);
    assert_eq!(cell.controller.state(), MonitoringReady, "the request was forgotten");
}

#[test]
fn setpoints_have_to_agree_with_the_interpolation() {
    let mut cell = Cell::new(1, 0);
    cell.controller.request_commanding();
    cell.until(CommandingWait);
    let far = HOME.map(|q| q + 2e-3);
    // The cell's client sends set-points only while they are in force, unlike this one.
    let mut bytes = Vec::new();
    for _ in 0..50 {
        cell.answers = false;
        cell.cycle();
        assert!(cell.client.answer(Some(&far), &mut bytes));
        cell.controller.receive(&bytes).unwrap();
        assert_eq!((cell.controller.state(), cell.controller.setpoint()), (CommandingWait, None));
    }
    for _ in 0..5 {
        assert_eq!(cell.controller.state(), CommandingWait);
        cell.cycle();
        let near = HOME.map(|q| q + 0.9e-3);
        assert!(cell.client.answer(Some(&near), &mut bytes));
        cell.controller.receive(&bytes).unwrap();
    }
    cell.cycle();
    assert_eq!(cell.controller.state(), CommandingActive);
}

#[test]
fn either_side_may_start_again() {
    let mut cell = Cell::new(1, 0);
    cell.cycles(500);
    cell.client = FriClient::default();
    cell.cycles(200);
    assert_eq!(cell.controller.quality(), Quality::Excellent);
    assert_eq!(cell.controller.counters().ignored, 0);
    assert_eq!(cell.client.counters().lost, 0);

    cell.events.clear();
    cell.controller = Controller::default();
    cell.until(MonitoringReady);
    assert_eq!(cell.events[0], Received::Restarted);
    assert!(cell.events[1..].iter().all(|&event| event == Received::New));
    assert_eq!(cell.client.counters().lost, 0);
}
