//! Saved positions: their file, their order, and programs created from them.

use std::{
    collections::HashSet,
    env, fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use iiwa_files::{Output, read_text};
use iiwa_json::{JsonPlace, problem};
use iiwa_kin::{Joints, Robot};
use iiwa_program::{
    Blend, CartesianMotion, Course, Frame, LimitKind, Motion, PathBlend, Program, Ptp, Sources,
    Start, Target, Workcell,
};
use serde::{Deserialize, Serialize};

use crate::TwinError;

/// Maximum number of saved positions.
const MAX_POSITIONS: usize = 1000;

/// Maximum length of a name, in characters.
const MAX_NAME: usize = 100;

/// Saved position of the arm.
#[derive(Clone, Serialize)]
pub(crate) struct SavedPosition {
    /// Unique id, unlike indices, which change while other pages show the list.
    id: u64,
    #[serde(flatten)]
    taught: Taught,
}

/// Position in file format.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Taught {
    name: String,
    joints_rad: Joints,
}

/// Content of the file of positions.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PositionsFile {
    version: u64,
    robot: String,
    positions: Vec<Taught>,
}

/// Positions in their order. A change is written to the file before it takes effect here, so it is
/// atomic.
pub(crate) struct PositionList {
    positions: Vec<SavedPosition>,
    /// Last assigned id.
    last_id: u64,
    robot: Robot,
    file: PathBuf,
    /// Formats errors of writing the file.
    words: fn(&TwinError) -> String,
}

impl PositionList {
    /// Reads the positions of a robot; an empty list if the file does not exist.
    pub(crate) fn read(
        file: &Path,
        robot: &Robot,
        words: fn(&TwinError) -> String,
    ) -> Result<Self, TwinError> {
        let mut list = Self {
            positions: Vec::new(),
            last_id: 0,
            robot: robot.clone(),
            file: file.to_owned(),
            words,
        };
        let text = match read_text(file) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(list),
            Err(error) => return Err(TwinError::file(format!("read {}", file.display()), error)),
        };
        let read: PositionsFile = serde_json::from_str(&text).map_err(|error| {
            let place = JsonPlace::of_error(&text, &text, &error);
            let (file, problem_text) = (file.to_owned(), problem(&error));
            TwinError::PositionsText { file, text: text.clone(), place, message: problem_text }
        })?;
        let to_error = |message: String| TwinError::Positions { file: file.to_owned(), message };
        if read.version != 1 {
            return Err(to_error(format!("version {}; version 1 is understood", read.version)));
        }
        if read.robot != robot.name() {
            return Err(TwinError::PositionsOfAnother {
                file: file.to_owned(),
                robot: read.robot,
                twin_robot: robot.name().to_owned(),
            });
        }
        for taught in read.positions {
            let Taught { name, joints_rad } = taught;
            robot
                .limits()
                .check(&joints_rad)
                .map_err(|outside| to_error(format!("position `{name}`: {outside}")))?;
            let name = list.free_name(&name, None).map_err(&to_error)?;
            list.push(Taught { name, joints_rad }).map_err(&to_error)?;
        }
        Ok(list)
    }

    pub(crate) fn all(&self) -> &[SavedPosition] {
        &self.positions
    }

    pub(crate) fn save(&mut self, name: &str, joints_rad: Joints) -> Result<(), String> {
        let name = match name.trim() {
            "" => self.next_name(),
            name => self.free_name(name, None)?,
        };
        self.change(|list| list.push(Taught { name, joints_rad }))
    }

    pub(crate) fn rename(&mut self, id: u64, name: &str) -> Result<(), String> {
        let index = self.place(id)?;
        let name = self.free_name(name, Some(id))?;
        self.change(|list| {
            list.positions[index].taught.name = name;
            Ok(())
        })
    }

    pub(crate) fn remove(&mut self, id: u64) -> Result<(), String> {
        self.change(|list| {
            list.positions.retain(|kept| kept.id != id);
            Ok(())
        })
    }

    /// Moves a position by a number of places, down if positive, and at most to the end.
    pub(crate) fn shift(&mut self, id: u64, by: i64) -> Result<(), String> {
        let from = self.place(id)?;
        let last = self.positions.len() - 1;
        let steps = usize::try_from(by.unsigned_abs()).unwrap_or(last);
        let to =
            if by < 0 { from.saturating_sub(steps) } else { (from + steps.min(last)).min(last) };
        self.change(|list| {
            let position = list.positions.remove(from);
            list.positions.insert(to, position);
            Ok(())
        })
    }

    /// Creates a program from the first position to the last. Targets are frames with the names of
    /// the positions; where a frame does not lead back to the taught joint positions, for example
    /// at a singularity with the arm outstretched, the target is the joint positions.
    pub(crate) fn program(&self, velocity_percent: f64, blend_mm: f64) -> Result<Program, String> {
        let velocity_rel = velocity_percent / 100.0;
        if !(velocity_rel > 0.0 && velocity_rel <= 1.0) {
            return Err(format!(
                "the velocity is {velocity_percent} %; it has to be above 0 and at most 100 %"
            ));
        }
        if !(0.0..=1e4).contains(&blend_mm) {
            return Err(format!("the blend radius is {blend_mm} mm; it has to be 0 to 10000 mm"));
        }
        let [start, targets @ ..] = self.positions.as_slice() else { return Err(TOO_FEW.into()) };
        if targets.is_empty() {
            return Err(TOO_FEW.into());
        }
        let mut workcell = Workcell::default();
        let mut motions = Vec::with_capacity(targets.len());
        for (index, SavedPosition { taught, .. }) in targets.iter().enumerate() {
            let cart_mm = (blend_mm > 0.0 && index + 1 < targets.len()).then_some(blend_mm);
            motions.push(if let Some(target) = self.target(&taught.joints_rad) {
                workcell.frames.insert(taught.name.clone(), target);
                let mut ptp = CartesianMotion::new(Course::Ptp { to: taught.name.as_str().into() });
                ptp.shares[LimitKind::Velocity] = [velocity_rel; 7];
                ptp.blend = cart_mm.map(|_| PathBlend { cart_mm, ..PathBlend::default() });
                Motion::Cartesian(Box::new(ptp))
            } else {
                let ptp = Ptp::to(taught.joints_rad).velocity(velocity_rel);
                Motion::Ptp(match cart_mm {
                    Some(cart_mm) => ptp.blend(Blend::CartMm(cart_mm)),
                    None => ptp,
                })
            });
        }
        let robot = Some(self.robot.name().to_owned());
        let start = Start::Joints(start.taught.joints_rad);
        Ok(Program { robot, start, motions, workcell, sources: Sources::default() })
    }

    /// Returns the flange frame at these joint positions, if the inverse kinematics leads back to
    /// them.
    fn target(&self, joints_rad: &Joints) -> Option<Target> {
        /// Tolerance of a joint position, in rad: not visible.
        const SAME_RAD: f64 = 1e-6;
        let pose = self.robot.flange_pose(joints_rad);
        let kept = self.robot.redundancy(joints_rad);
        let back = self.robot.inverse(&pose, kept.e1_rad, kept.status).ok()?;
        let is_same = std::iter::zip(joints_rad, back).all(|(a, b)| (a - b).abs() < SAME_RAD);
        let frame = Frame { xyz_mm: pose.position_m.map(|m| 1e3 * m), abc_rad: pose.abc_rad() };
        is_same.then(|| Target {
            e1_rad: Some(kept.e1_rad),
            status: Some(kept.status),
            turn: Some(kept.turn.bits()),
            ..Target::at(frame)
        })
    }

    fn place(&self, id: u64) -> Result<usize, String> {
        let place = self.positions.iter().position(|kept| kept.id == id);
        place.ok_or_else(|| "this position has been removed".to_owned())
    }

    /// Checks that a name is unique; the position `renamed_id` may keep its name.
    fn free_name(&self, name: &str, renamed_id: Option<u64>) -> Result<String, String> {
        let name = name.trim();
        let length = name.chars().count();
        if !(1..=MAX_NAME).contains(&length) || name.contains(char::is_control) {
            return Err(format!(
                "a position has a name of 1 to {MAX_NAME} characters, none of them a control \
                 character"
            ));
        }
        let is_other =
            |kept: &&SavedPosition| Some(kept.id) != renamed_id && kept.taught.name == name;
        match self.positions.iter().find(is_other) {
            Some(_) => Err(format!("there is a position `{name}` already; choose another name")),
            None => Ok(name.to_owned()),
        }
    }

    fn next_name(&self) -> String {
        let names: HashSet<&str> =
            self.positions.iter().map(|kept| kept.taught.name.as_str()).collect();
        let numbered = (self.positions.len() + 1..).map(|number| format!("P{number}"));
        numbered.filter(|name| !names.contains(name.as_str())).take(1).collect()
    }

    fn push(&mut self, taught: Taught) -> Result<(), String> {
        if self.positions.len() >= MAX_POSITIONS {
            return Err(format!(
                "there are {MAX_POSITIONS} positions already, which is the most; remove some first"
            ));
        }
        self.last_id += 1;
        self.positions.push(SavedPosition { id: self.last_id, taught });
        Ok(())
    }

    fn change(&mut self, edit: impl FnOnce(&mut Self) -> Result<(), String>) -> Result<(), String> {
        let before = self.positions.clone();
        let changed = edit(self).and_then(|()| self.store().map_err(|error| (self.words)(&error)));
        changed.inspect_err(|_| self.positions = before)
    }

    fn store(&self) -> Result<(), TwinError> {
        let to_error =
            |error: io::Error| TwinError::file(format!("write {}", self.file.display()), error);
        if let Some(folder) = self.file.parent() {
            fs::create_dir_all(folder).map_err(to_error)?;
        }
        let content = PositionsFile {
            version: 1,
            robot: self.robot.name().to_owned(),
            positions: self.positions.iter().map(|kept| kept.taught.clone()).collect(),
        };
        let text =
            serde_json::to_string_pretty(&content).map_err(|error| to_error(error.into()))?;
        let file = Output::new(&self.file)?;
        file.write(text.as_bytes())?;
        Ok(file.complete_always()?)
    }
}

const TOO_FEW: &str = "a program needs at least two positions: the start and a target";

/// Returns the default file for the positions of a robot, in the user's data folder.
pub(crate) fn default_file(robot: &Robot) -> Option<PathBuf> {
    let folder = |name: &str| env::var_os(name).filter(|it| !it.is_empty()).map(PathBuf::from);
    let data = if cfg!(windows) {
        folder("APPDATA")
    } else if cfg!(target_os = "macos") {
        folder("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        folder("XDG_DATA_HOME").or_else(|| folder("HOME").map(|home| home.join(".local/share")))
    };
    let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let robot: String = robot.name().chars().map(plain).collect();
    data.map(|data| data.join("iiwasim").join(format!("positions-{robot}.json")))
}
