//! Programs with the results of an independent solver, in `fixtures/reference/programs.json`.

#![expect(clippy::panic, reason = "a test fails by it")]

use iiwa_program::Program;
use serde::Deserialize;

/// Program with its reference results.
#[derive(Debug)]
pub struct Case {
    /// Number of the program.
    pub id: usize,
    /// The program.
    pub program: Program,
    /// Reference results.
    pub answers: Answers,
}

/// Results of the independent solver.
#[derive(Debug, Deserialize)]
pub struct Answers {
    /// Time in motion, without settle time.
    pub motion_s: MotionTime,
    /// Settle time, in s.
    pub settle_s: f64,
    /// Blends, in order.
    pub blends: Vec<BlendAnswer>,
}

/// Time in motion, in s.
#[derive(Debug, Deserialize)]
pub struct MotionTime {
    /// Time with velocity and acceleration limits; accurate to 0.02 %.
    pub acceleration: f64,
    /// Time with jerk limits too; accurate to 0.1 %, from below.
    pub jerk: f64,
}

/// Reference results for a blend.
#[derive(Debug, Deserialize)]
pub struct BlendAnswer {
    /// Angle of the corner, in degrees.
    pub gamma_deg: f64,
    /// Start of the blend, in rad.
    pub start_rad: [f64; 7],
    /// End of the blend, in rad.
    pub end_rad: [f64; 7],
    /// Position at s = 1/2, in rad.
    pub mid_rad: [f64; 7],
    /// TCP position at s = 1/2, in m.
    pub mid_tcp_m: [f64; 3],
}

#[derive(Deserialize)]
struct File {
    cases: Vec<RawCase>,
}

#[derive(Deserialize)]
struct RawCase {
    id: usize,
    program: serde_json::Value,
    #[serde(flatten)]
    answers: Answers,
}

/// Returns all reference programs.
///
/// # Panics
///
/// Panics if the file is missing or not as expected.
#[must_use]
pub fn cases() -> Vec<Case> {
    let text = std::fs::read_to_string(crate::fixture("reference/programs.json"))
        .unwrap_or_else(|error| panic!("the reference programs: {error}"));
    let file: File = serde_json::from_str(&text)
        .unwrap_or_else(|error| panic!("the reference programs: {error}"));
    file.cases
        .into_iter()
        .map(|case| Case {
            id: case.id,
            program: Program::from_json(&case.program.to_string())
                .unwrap_or_else(|error| panic!("reference program {}: {error}", case.id)),
            answers: case.answers,
        })
        .collect()
}
