//! Commands for the brokers that the bridge serves (feature `bridge`).

mod bridge;
#[cfg(feature = "opcua")]
mod bridge_opcua;
#[cfg(feature = "ros2")]
mod bridge_ros2;
mod history;
mod replay;

use crate::{args::Brokers, failure::Failure};

pub(crate) fn run(command: Brokers) -> Result<(), Failure> {
    match command {
        Brokers::Bridge(options) => bridge::run(&options),
        Brokers::Replay(options) => replay::run(&options),
        Brokers::History(options) => history::run(&options),
    }
}
