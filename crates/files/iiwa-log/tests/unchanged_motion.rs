//! Motion data in the files of programs without a load are unchanged since files contain torques.

// The last bits of sines and cosines depend on the C library.
#![cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, io::Cursor, path::Path};

use iiwa_log::{PlanConfig, Recording, write_plan};
use iiwa_plan::{PlanOptions, PlanRequest, ProgramSource};
use iiwa_traj::{SweepOptions, Timing};
use mcap::MessageStream;

/// FNV-1a hash.
#[derive(Debug, PartialEq, Eq)]
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Hashes of the messages on `/joint_trajectory` with their stamps, and of stamps, positions and
/// velocities on `/joint_states`.
fn hashes(name: &str, timing: Timing) -> [u64; 2] {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures");
    let text = fs::read_to_string(fixtures.join(name).with_extension("json")).unwrap();
    let options = PlanOptions::with_timing(timing);
    let request = PlanRequest { options, ..PlanRequest::default() };
    let plan = request.plan(&ProgramSource::from_json(&text).unwrap()).unwrap();
    let stream = Cursor::new(Vec::new());
    let file = write_plan(stream, &plan, PlanConfig::default(), &text).unwrap();
    let file = file.into_inner();

    let mut trajectory = Hash::new();
    for message in MessageStream::new(&file).unwrap().map(Result::unwrap) {
        if message.channel.topic == "/joint_trajectory" {
            trajectory.add(&message.log_time.to_le_bytes());
            trajectory.add(&message.data);
        }
    }
    let mut states = Hash::new();
    for sample in Recording::from_bytes(&file).unwrap().joint_states {
        for value in [sample.t_s].iter().chain(&sample.q).chain(&sample.dq.unwrap()) {
            states.add(&value.to_le_bytes());
        }
    }
    [trajectory.0, states.0]
}

/// Hashes with jerk limits, and without. The latter are those of e4417f5, the last version whose
/// files had no torques. The former were renewed when the settings of the solver changed, by which
/// durations differ by up to 1e-5 of them, and when it summed in another order, which changes last
/// digits.
const BEFORE: [(&str, [u64; 2], [u64; 2]); 4] = [
    (
        "appendix-b",
        [0x73e0_a418_9c33_4e5b, 0x2986_9c81_d674_3237],
        [0x39ca_0519_519e_dfcb, 0x6a81_62db_79fe_b97d],
    ),
    (
        "pick-and-place",
        [0x126c_70f9_e273_3e44, 0xceb4_a77b_7664_f75a],
        [0xe931_dfac_8517_977a, 0xce43_83bf_c2b6_8bb3],
    ),
    (
        "ten-motions",
        [0x68cf_6ab2_7518_38df, 0xa5f5_710f_7a96_fd4f],
        [0x9306_f243_10fe_2150, 0x8a1e_2f96_bb40_8f05],
    ),
    (
        "waits-and-stops",
        [0xab27_57c3_9278_c7e3, 0x0f07_5ea8_fe79_12fc],
        [0x04c4_cfb2_9424_8f68, 0x1f7c_bdde_6469_a019],
    ),
];

#[test]
fn motions_without_a_load_are_written_as_before() {
    // Processors with this instruction round a product and a sum once, those before 2013 twice.
    let rounds_once = is_x86_feature_detected!("fma") && is_x86_feature_detected!("avx2");
    let actual = BEFORE.map(|(name, jerk, _)| {
        let jerk = if rounds_once { hashes(name, Timing::jerk_limited()) } else { jerk };
        (name, jerk, hashes(name, Timing::Acceleration(SweepOptions::default())))
    });
    assert!(actual == BEFORE, "{actual:#018x?}");
}
