//! Restarts of drive and robot program in any order. The test counts the remaining threads and open
//! files, so it is a separate process with a single test. The program is the Java one if the
//! environment names it.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a failed test panics")]

use std::{
    cell::RefCell,
    fs,
    net::TcpListener,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use iiwa_cabinet::{Cabinet, CabinetConfig};
use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{Client, Remote, Server, message::Presence};
use iiwasim_tests::{
    ports::free_address,
    program_process::{ProgramPorts, ProgramProcess, jar},
    realtime_guard::in_real_time,
};

/// Time-out until both sides are connected again.
const WITHIN: Duration = Duration::from_secs(3);

/// Time-out until threads and files of ended components are gone.
const VANISH: Duration = Duration::from_secs(10);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Drive,
    Program,
    Both,
}

/// A restart: the component, and the order of stopping and starting.
#[derive(Clone, Copy, Debug)]
struct Restart {
    which: Which,
    stops_drive_first: bool,
    starts_drive_first: bool,
}

/// Returns a hundred restarts, in a reproducible order.
fn hundred() -> Vec<Restart> {
    let mut random = fastrand::Rng::with_seed(20_190_607);
    let kinds = [(Which::Drive, 40), (Which::Program, 30), (Which::Both, 30)];
    let mut all: Vec<Which> =
        kinds.iter().flat_map(|&(which, count)| std::iter::repeat_n(which, count)).collect();
    random.shuffle(&mut all);
    let mut order = |which| Restart {
        which,
        stops_drive_first: random.bool(),
        starts_drive_first: random.bool(),
    };
    all.into_iter().map(&mut order).collect()
}

/// The robot program, simulated or in Java.
enum Program {
    Simulated { _cabinet: Box<Cabinet> },
    Java(ProgramProcess),
}

/// A drive and a robot program, each of which is restarted.
struct Pair {
    jar: Option<PathBuf>,
    drive_config: DriveConfig,
    cabinet_config: CabinetConfig,
    /// The simulated cabinet behind the program in Java.
    behind: Option<Cabinet>,
    drive: Option<Drive>,
    program: Option<Program>,
}

fn free_tcp() -> String {
    format!("tcp://{}", free_address())
}

impl Pair {
    fn start(jar: Option<&Path>) -> Self {
        let mut drive_config = DriveConfig::default();
        drive_config.instructions = free_tcp();
        drive_config.stream = free_tcp();
        drive_config.fri = free_address();
        drive_config.cabinet_instructions = free_tcp();
        drive_config.cabinet_state = free_tcp();
        let mut cabinet_config = CabinetConfig::default();
        cabinet_config.fri_client = drive_config.fri;
        cabinet_config.instructions.clone_from(&drive_config.cabinet_instructions);
        cabinet_config.state.clone_from(&drive_config.cabinet_state);
        let behind = jar.map(|_| {
            let mut config = cabinet_config.clone();
            config.instructions = free_tcp();
            config.state = free_tcp();
            Cabinet::start(config, &Server::open()).unwrap()
        });
        let jar = jar.map(Path::to_owned);
        let (drive, program) = (None, None);
        let mut pair = Self { jar, drive_config, cabinet_config, behind, drive, program };
        pair.start_drive();
        pair.start_program();
        pair.wait_until_connected(Duration::from_secs(30));
        pair
    }

    fn start_drive(&mut self) {
        let drive = Drive::start(self.drive_config.clone(), &Server::open(), &Remote::open());
        self.drive = Some(drive.unwrap());
    }

    fn start_program(&mut self) {
        let program = if let (Some(jar), Some(behind)) = (&self.jar, &self.behind) {
            let ports = ProgramPorts {
                instructions: self.cabinet_config.instructions.clone(),
                state: self.cabinet_config.state.clone(),
                cabinet_instructions: behind.instructions().to_owned(),
                cabinet_state: behind.state().to_owned(),
            };
            Program::Java(ProgramProcess::start(jar, &ports, &[]))
        } else {
            let cabinet = Cabinet::start(self.cabinet_config.clone(), &Server::open());
            Program::Simulated { _cabinet: Box::new(cabinet.unwrap()) }
        };
        self.program = Some(program);
    }

    fn stop_program(&mut self) {
        if let Some(Program::Java(process)) = self.program.take() {
            assert!(process.end(), "the program did not end by itself");
        }
    }

    fn restart(&mut self, restart: Restart) {
        let of_drive = restart.which != Which::Program;
        let of_program = restart.which != Which::Drive;
        if of_drive && restart.stops_drive_first {
            self.drive = None;
        }
        if of_program {
            self.stop_program();
        }
        if of_drive {
            self.drive = None;
        }
        if of_drive && restart.starts_drive_first {
            self.start_drive();
        }
        if of_program {
            self.start_program();
        }
        if of_drive && !restart.starts_drive_first {
            self.start_drive();
        }
    }

    /// Waits until a new instruction is answered and states arrive.
    fn wait_until_connected(&self, within: Duration) -> Duration {
        let since = Instant::now();
        let mut client = Client::new(&Remote::open(), &self.drive_config.instructions).unwrap();
        while client.state().unwrap().robot_program != Presence::Connected
            || client.read_sensors().is_err()
        {
            assert!(since.elapsed() < within, "not connected within {within:?}");
            thread::sleep(Duration::from_millis(5));
        }
        since.elapsed()
    }

    /// Ends both; all ports are free afterwards.
    fn end(mut self) {
        self.stop_program();
        let ports = [
            self.drive_config.instructions.clone(),
            self.drive_config.stream.clone(),
            self.drive_config.cabinet_instructions.clone(),
            self.drive_config.cabinet_state.clone(),
        ];
        drop(self);
        for port in ports {
            let port = port.trim_start_matches("tcp://");
            drop(TcpListener::bind(port).unwrap_or_else(|error| panic!("{port}: {error}")));
        }
    }
}

/// Restarts the components; returns the times until both were connected.
fn come_and_go(jar: Option<&Path>, restarts: &[Restart]) -> Vec<Duration> {
    let pair = RefCell::new(Pair::start(jar));
    let took = RefCell::new(Vec::new());
    for restart in restarts {
        in_real_time(|| {
            let mut pair = pair.borrow_mut();
            pair.restart(*restart);
            let waited = pair.wait_until_connected(WITHIN);
            took.borrow_mut().push(waited);
        });
    }
    pair.into_inner().end();
    let mut took = took.into_inner();
    took.sort();
    took
}

/// Returns the threads and open files of this process; zero where the system does not report them.
fn threads_and_files() -> [usize; 2] {
    ["/proc/self/task", "/proc/self/fd"]
        .map(|folder| fs::read_dir(folder).map_or(0, Iterator::count))
}

#[test]
fn drive_and_program_come_and_go_in_any_order() {
    let (jar, all) = (jar(), hundred());
    // A restart takes a quarter of a second.
    let is_long = std::env::var_os("IIWASIM_LONG").is_some();
    let restarts = if is_long { &all[..] } else { &all[..25] };
    // Resources that are created once and kept exist after these restarts.
    come_and_go(jar.as_deref(), &restarts[..2]);
    let before = threads_and_files();
    let took = come_and_go(jar.as_deref(), restarts);
    let program = if jar.is_some() { "the program in Java" } else { "the simulated program" };
    let (count, median, worst) = (took.len(), took[took.len() / 2], took[took.len() - 1]);
    println!("{program}: {count} restarts, connected after {median:.2?} (median), {worst:.2?}");
    let since = Instant::now();
    let is_left = |after: [usize; 2]| after[0] > before[0] || after[1] > before[1];
    while is_left(threads_and_files()) && since.elapsed() < VANISH {
        thread::sleep(Duration::from_millis(50));
    }
    let after = threads_and_files();
    println!("threads, open files: {before:?} before, {after:?} after");
    assert!(!is_left(after), "threads, open files: {before:?} before, {after:?} after");
}
