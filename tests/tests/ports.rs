//! Ports are assigned once across processes.

use std::{
    collections::HashSet,
    env,
    io::{self, BufRead, BufReader, Read},
    process::{Child, Command, Stdio},
};

use iiwasim_tests::ports::free_port;

/// Variable that turns the process into one that reserves ports.
const TAKES: &str = "IIWASIM_TEST_TAKES_PORTS";

const EACH: usize = 2000;

/// Prints its reserved ports, and holds them until its standard input closes.
#[test]
#[ignore = "the process that another test starts"]
fn taker() {
    if env::var_os(TAKES).is_none() {
        return;
    }
    for _ in 0..EACH {
        println!("\nport: {}", free_port());
    }
    io::stdin().read_to_end(&mut Vec::new()).unwrap();
}

fn start_taker() -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["tests::ports::taker", "--exact", "--ignored", "--nocapture"])
        .env(TAKES, "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

#[test]
fn two_processes_take_no_port_twice() {
    let mut takers = [(); 2].map(|()| start_taker());
    let mut taken: Vec<u16> = Vec::new();
    for taker in &mut takers {
        let lines = BufReader::new(taker.stdout.as_mut().unwrap()).lines();
        let ports =
            lines.filter_map(|line| line.unwrap().strip_prefix("port: ")?.parse::<u16>().ok());
        taken.extend(ports.take(EACH));
    }
    // While both still hold theirs.
    taken.extend((0..EACH).map(|_| free_port()));
    for mut taker in takers {
        drop(taker.stdin.take());
        // Further output must be read.
        io::copy(&mut taker.stdout.take().unwrap(), &mut io::sink()).unwrap();
        assert!(taker.wait().unwrap().success());
    }
    assert_eq!(taken.len(), 3 * EACH);
    assert_eq!(taken.iter().collect::<HashSet<_>>().len(), 3 * EACH);
}
