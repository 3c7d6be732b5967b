//! Cabinet process.

use std::{thread, time::Duration};

use iiwa_cabinet::{Cabinet, CabinetConfig, LateAnswer};
use iiwa_link::Server;
use iiwasim_benches::Result;
use serde::{Deserialize, Serialize};

use super::{clock::SystemClock, part::serve, sockets::Sockets};

/// Measurements of the controller.
#[derive(Deserialize, Serialize)]
pub(crate) struct CabinetSide {
    pub(crate) period_ms: u32,
    pub(crate) cycles: u64,
    pub(crate) answered: u64,
    pub(crate) late_us: Vec<Answer>,
    pub(crate) held_up: u64,
    pub(crate) real_time: bool,
    /// Median, 99.9 % quantile and maximum.
    pub(crate) latency_us: [f64; 3],
}

/// Late answer, in us of the system clock.
#[derive(Deserialize, Serialize)]
pub(crate) struct Answer {
    pub(crate) sent: i64,
    pub(crate) answered: i64,
}

/// Runs a cabinet until the input ends.
pub(crate) fn be_cabinet(period_ms: u32, sockets: &Sockets) -> Result<()> {
    let mut config = CabinetConfig::default();
    config.period_ms = period_ms;
    config.fri_client = sockets.fri;
    config.instructions.clone_from(&sockets.cabinet_instructions);
    config.state.clone_from(&sockets.cabinet_state);
    let cabinet = Cabinet::start(config, &Server::open())?;
    serve(|| {
        let mut report = cabinet.report();
        // One answer may be in transit.
        for _ in 0..10 {
            if report.cycles == report.latency.count() as u64 {
                break;
            }
            thread::sleep(Duration::from_micros(300));
            report = cabinet.report();
        }
        let latency_us = [0.5, 0.999, 1.0].map(|share| {
            report.latency.quantile(share).map_or(f64::NAN, |time| 1e6 * time.as_secs_f64())
        });
        let clock = SystemClock::new();
        let late = report.late.iter();
        let late_us = late.map(|LateAnswer { sent, answered, .. }| Answer {
            sent: clock.us(*sent),
            answered: clock.us(*answered),
        });
        let late_us = late_us.collect();
        CabinetSide {
            period_ms,
            cycles: report.cycles,
            answered: report.latency.count() as u64,
            late_us,
            held_up: report.delayed_cycles,
            real_time: report.real_time,
            latency_us,
        }
    })
}
