//! Command line.

use std::fs;

use iiwa_program::Program;
use iiwasim_benches::Result;
use iiwasim_tests::families::Family;

/// Requested task.
#[derive(Debug)]
pub(crate) enum Task {
    /// Judges programs of a family, or of all.
    Run { family: Option<Family>, seed: u64, programs: u64 },
    /// Prints the plan of one program.
    Table(Program),
    /// Prints one program.
    Json(Program),
}

impl Task {
    pub(crate) fn read(words: &[&str]) -> Result<Self> {
        let mut words = words.iter().copied();
        let (mut family, mut number, mut file, mut as_json) = (None, None, None, false);
        let mut counts = Vec::new();
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
            match word {
                "--family" => {
                    let name = value()?;
                    let known = Family::ALL.map(Family::name).join(", ");
                    let named = Family::named(name);
                    family = Some(named.ok_or_else(|| format!("no family {name}; {known}"))?);
                }
                "--program" => number = Some(value()?.parse()?),
                "--file" => file = Some(value()?),
                "--json" => as_json = true,
                count => counts.push(count.parse().map_err(|_| format!("what is {count}?"))?),
            }
        }
        let mut counts = counts.into_iter();
        let one = |program| if as_json { Self::Json(program) } else { Self::Table(program) };
        Ok(match (file, number) {
            (Some(file), _) => one(Program::from_json(&fs::read_to_string(file)?)?),
            (None, Some(number)) => {
                let family: Family = family.ok_or("--program needs --family")?;
                one(family.program(counts.next().unwrap_or(1), number).program)
            }
            (None, None) => {
                let programs = counts.next().unwrap_or(100_000);
                Self::Run { family, seed: counts.next().unwrap_or(1), programs }
            }
        })
    }
}
