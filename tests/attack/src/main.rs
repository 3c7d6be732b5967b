//! Attacks the programs of the command line from outside: `attack BINARY [PART] [--long] [--keys]
//! [--shared] [--seed N]`. Parts are `stop`, `load`, `suspend`, `memory` and `all`; parts of `load`
//! are `pipelines`, `trickle`, `handshakes`, `subscribers` and `descriptors`.

use std::{path::PathBuf, process::ExitCode};

use iiwasim_attack::{Options, Part, Scenario, run};

fn main() -> ExitCode {
    match options() {
        Ok(options) => run(&options),
        Err(message) => {
            usage(&message);
            ExitCode::from(2)
        }
    }
}

#[expect(clippy::print_stderr, reason = "a program says how it is used")]
fn usage(message: &str) {
    eprintln!(
        "{message}\nusage: attack BINARY \
         [stop|load|suspend|memory|all|pipelines|trickle|handshakes|subscribers|descriptors] \
         [--long] [--keys] [--shared] [--seed N]"
    );
}

fn options() -> Result<Options, String> {
    let mut arguments = std::env::args().skip(1);
    let binary = arguments.next().ok_or("which program is to be attacked?")?;
    let mut options = Options {
        binary: PathBuf::from(binary),
        part: Part::All,
        long: false,
        keys: false,
        shared: false,
        seed: fastrand::u64(..1_000_000),
    };
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "stop" => options.part = Part::Stop,
            "load" => options.part = Part::Load,
            "suspend" => options.part = Part::Suspend,
            "memory" => options.part = Part::Memory,
            "all" => options.part = Part::All,
            "--long" => options.long = true,
            "--keys" => options.keys = true,
            "--shared" => options.shared = true,
            "--seed" => {
                let seed = arguments.next().and_then(|seed| seed.parse().ok());
                options.seed = seed.ok_or("--seed needs a number")?;
            }
            name => {
                let scenario = Scenario::named(name);
                let scenario = scenario.ok_or_else(|| format!("`{name}` is not known"))?;
                options.part = Part::Scenario(scenario);
            }
        }
    }
    Ok(options)
}
