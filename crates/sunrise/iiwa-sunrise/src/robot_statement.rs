//! Statements of project files about the robot and its flange.

use std::fmt;

use iiwa_kin::Robot;

use crate::element::Element;

/// Length of a media flange "Touch", from the wrist to its face, in m.
pub const TOUCH_FLANGE_M: f64 = 0.152;

/// Length of all other flanges, in m. In twenty public projects whose taught frames determine the
/// length, the flanges with "Touch" in their names have the other length, and all others have this
/// one.
pub const OTHER_FLANGE_M: f64 = 0.126;

/// Place in a project that states which robot runs it, or which flange that robot has.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotStatement {
    /// Kind of the file.
    pub by: StatedBy,
    /// Path of the file, relative to the project folder.
    pub file: String,
    /// Line in the file, from 1.
    pub line: u32,
    /// Text of the statement, such as `LBR_iiwa_14_R820_1` or `Medien-Flansch Touch pneumatisch`.
    pub words: String,
    /// Meaning of the text.
    pub means: Stated,
}

/// Kinds of files that state the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum StatedBy {
    /// `StationSetup.cat`, the configuration of the station.
    Station,
    /// `RoboticsAPI.data.xml`: the robot with which frames were taught.
    DataFile,
    /// Java sources: a device that is looked up by its name, or a field that is named after the
    /// device.
    Java,
}

/// Meaning of a statement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Stated {
    /// Robot model.
    Model(StatedModel),
    /// Flange length in m, of a robot of this model.
    Flange(StatedModel, f64),
}

/// Robot model in a device name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatedModel {
    /// Built-in model with the same kinematics.
    pub built_in: &'static str,
    /// `true` for an LBR Med, which has the kinematics of the LBR iiwa; its limits are assumed to
    /// be the same.
    pub is_med: bool,
}

impl StatedModel {
    /// Finds the model in a device name such as `LBR_iiwa_14_R820_1`, `lBR_iiwa_7_R800` or
    /// `LBR_Med_7_R800_1`.
    ///
    /// ```
    /// use iiwa_sunrise::StatedModel;
    ///
    /// let model = StatedModel::in_name("KUKA_Sunrise_Cabinet_1/LBR_iiwa_14_R820_1");
    /// assert_eq!(model.map(|model| model.built_in), Some("lbr_iiwa_14_r820"));
    /// assert_eq!(StatedModel::in_name("lbr"), None);
    /// ```
    #[must_use]
    pub fn in_name(name: &str) -> Option<Self> {
        let letters: String = name
            .chars()
            .filter(char::is_ascii_alphanumeric)
            .collect::<String>()
            .to_ascii_lowercase();
        let models = [("7r800", Robot::BUILT_IN[0]), ("14r820", Robot::BUILT_IN[1])];
        models.into_iter().find_map(|(size, built_in)| {
            let names_series = |series: &str| letters.contains(&format!("{series}{size}"));
            let is_med = names_series("med");
            (is_med || names_series("iiwa")).then_some(Self { built_in, is_med })
        })
    }
}

impl fmt::Display for RobotStatement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{} says {}", self.file, self.line, self.words)
    }
}

/// Finds robots and flanges in a `StationSetup.cat`, the configuration of a station.
///
/// # Errors
///
/// Returns the message of the XML parser if the text is not XML.
pub(crate) fn in_station(file: &str, text: &str) -> Result<Vec<RobotStatement>, String> {
    let root = Element::read(text).map_err(|error| error.to_string())?;
    let mut statements = Vec::new();
    let mut open = vec![&root];
    while let Some(element) = open.pop() {
        open.extend(element.children.iter().rev().filter(|child| child.name == "TopologyItem"));
        let properties = || element.children.iter().filter(|child| child.name == "Property");
        let robot = properties().find_map(|property| {
            let value = property.child("Value")?;
            let words = value.words().trim();
            StatedModel::in_name(words).map(|model| (property, words, model))
        });
        let Some((property, words, model)) = robot else { continue };
        let mut state = |element: &Element<'_>, words: &str, means| {
            let line = u32::try_from(element.place().line).unwrap_or(u32::MAX);
            let (file, words) = (file.to_owned(), words.to_owned());
            statements.push(RobotStatement { by: StatedBy::Station, file, line, words, means });
        };
        state(property, words, Stated::Model(model));
        let flange = properties().find(|property| property.attribute("key") == Some("MAM"));
        if let Some((flange, name)) = flange.and_then(|model| Some((model, flange_name(model)?))) {
            let is_touch = name.to_lowercase().contains("touch");
            let length_m = if is_touch { TOUCH_FLANGE_M } else { OTHER_FLANGE_M };
            state(flange, name, Stated::Flange(model, length_m));
        }
    }
    Ok(statements)
}

/// Returns the name of the selected flange: the display name of the value, or of the equal value
/// among the possible ones.
fn flange_name<'e>(property: &'e Element<'_>) -> Option<&'e str> {
    let chosen = property.child("Value")?;
    let named =
        |element: &'e Element<'_>| element.attribute("displayName").filter(|name| !name.is_empty());
    let same = |element: &&Element<'_>| {
        element.name == "PossibleValue" && element.words() == chosen.words()
    };
    named(chosen).or_else(|| named(property.children.iter().find(same)?))
}

/// Finds robots in the text of a Java file: in strings and identifiers, not in comments. Each model
/// is reported at its first occurrence.
pub(crate) fn in_java(file: &str, text: &str) -> Vec<RobotStatement> {
    let mut statements: Vec<RobotStatement> = Vec::new();
    for (line, words) in Words::new(text) {
        let Some(model) = StatedModel::in_name(words) else { continue };
        let means = Stated::Model(model);
        if !statements.iter().any(|known| known.means == means) {
            let (file, words) = (file.to_owned(), words.to_owned());
            statements.push(RobotStatement { by: StatedBy::Java, file, line, words, means });
        }
    }
    statements
}

/// Iterator over the identifiers and strings of a Java text with their lines; comments are skipped.
struct Words<'t> {
    rest: &'t str,
    line: u32,
}

impl<'t> Words<'t> {
    fn new(rest: &'t str) -> Self {
        Self { rest, line: 1 }
    }

    /// Takes a number of bytes from the text, and counts their lines.
    fn take(&mut self, bytes: usize) -> &'t str {
        let (taken, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        let lines = taken.bytes().filter(|byte| *byte == b'\n').count();
        self.line += u32::try_from(lines).unwrap_or(0);
        taken
    }

    /// Returns the number of bytes up to and including `end`, or to the end of the text.
    fn up_to(&self, from: usize, end: &str) -> usize {
        self.rest[from..].find(end).map_or(self.rest.len(), |offset| from + offset + end.len())
    }

    /// Returns the number of bytes of a string or character literal with its quotes; an
    /// unterminated literal ends with its line.
    fn quoted(&self, quote: char) -> usize {
        let mut is_escaped = false;
        for (offset, letter) in self.rest.char_indices().skip(1) {
            match letter {
                '\n' => return offset,
                _ if is_escaped => is_escaped = false,
                '\\' => is_escaped = true,
                _ if letter == quote => return offset + letter.len_utf8(),
                _ => {}
            }
        }
        self.rest.len()
    }
}

impl<'t> Iterator for Words<'t> {
    type Item = (u32, &'t str);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let first = self.rest.chars().next()?;
            let line = self.line;
            if self.rest.starts_with("//") {
                self.take(self.up_to(2, "\n"));
            } else if self.rest.starts_with("/*") {
                self.take(self.up_to(2, "*/"));
            } else if matches!(first, '"' | '\'') {
                return Some((line, self.take(self.quoted(first)).trim_matches(first)));
            } else if first.is_alphanumeric() || first == '_' {
                let is_part =
                    |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '$');
                let end = self.rest.find(|letter| !is_part(letter)).unwrap_or(self.rest.len());
                return Some((line, self.take(end)));
            } else {
                self.take(first.len_utf8());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(flange: &str) -> String {
        format!(
            r#"<?xml version="1.0"?>
<ConfigurationProject>
  <TopologyItem name="Project"><TopologyItem name="Robot">
    <Property displayName="Name" key="Name"><Value>LBR_iiwa_14_R820_1</Value></Property>
    <Property displayName="Flange" key="MAM">{flange}
      <PossibleValue displayName="Media flange electrical">MADA=MF</PossibleValue>
      <PossibleValue displayName="Media flange Touch pneumatic">MADA=MFTP</PossibleValue>
    </Property>
  </TopologyItem></TopologyItem>
</ConfigurationProject>"#
        )
    }

    fn flange_m(value: &str) -> Option<f64> {
        let statements = in_station("StationSetup.cat", &station(value)).unwrap();
        statements.into_iter().find_map(|statement| match statement.means {
            Stated::Flange(_, length_m) => Some(length_m),
            Stated::Model(_) => None,
        })
    }

    #[test]
    fn a_station_states_robot_and_flange() {
        let text = station(r#"<Value displayName="Media flange electrical">MADA=MF</Value>"#);
        let statements = in_station("StationSetup.cat", &text).unwrap();
        let [robot, flange] = statements.as_slice() else { panic!("{statements:?}") };
        assert_eq!(robot.to_string(), "StationSetup.cat:4 says LBR_iiwa_14_R820_1");
        let model = StatedModel { built_in: "lbr_iiwa_14_r820", is_med: false };
        assert_eq!(robot.means, Stated::Model(model));
        assert_eq!(flange.to_string(), "StationSetup.cat:5 says Media flange electrical");
        assert_eq!(flange.means, Stated::Flange(model, OTHER_FLANGE_M));
    }

    #[test]
    fn a_flange_touch_is_longer() {
        let value = r#"<Value displayName="Medien-Flansch TOUCH">MADA=MFT</Value>"#;
        assert_eq!(flange_m(value), Some(TOUCH_FLANGE_M));
        // The name is among the possible values.
        assert_eq!(flange_m("<Value>MADA=MFTP</Value>"), Some(TOUCH_FLANGE_M));
        assert_eq!(flange_m("<Value>MADA=MF</Value>"), Some(OTHER_FLANGE_M));
        assert_eq!(flange_m("<Value>MADA=NEW</Value>"), None);
        assert_eq!(flange_m(""), None);
    }

    #[test]
    fn a_station_that_is_no_xml_is_an_error() {
        assert!(in_station("StationSetup.cat", "<ConfigurationProject>").is_err());
    }

    #[test]
    fn names_of_devices_have_the_model_in_them() {
        for (name, built_in) in [
            ("LBR_iiwa_7_R800_1", Some("lbr_iiwa_7_r800")),
            ("lBR_iiwa_14_R820_1", Some("lbr_iiwa_14_r820")),
            ("LBR iiwa 7 R800", Some("lbr_iiwa_7_r800")),
            ("LBR_Med_14_R820", Some("lbr_iiwa_14_r820")),
            ("lbr_iiwa", None),
            ("KR_6_R900", None),
        ] {
            assert_eq!(StatedModel::in_name(name).map(|model| model.built_in), built_in, "{name}");
        }
        assert!(StatedModel::in_name("LBR_Med_7_R800").unwrap().is_med);
    }

    #[test]
    fn java_names_robots_in_strings_and_identifiers() {
        let text = r#"// LBR_iiwa_7_R800_1
/* "LBR_iiwa_7_R800_1"
   and more */ class A {
    String path = "a \" quote // LBR"; char c = '"';
    LBR arm = getDevice(controller, "LBR_iiwa_14_R820_1"); // LBR_iiwa_7_R800_1
    @Inject LBR lBR_iiwa_14_R820_1;
}"#;
        let statements = in_java("src/A.java", text);
        let said: Vec<_> = statements.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["src/A.java:5 says LBR_iiwa_14_R820_1"]);
    }

    #[test]
    fn java_without_an_end_is_read_to_its_end() {
        for text in
            ["/* LBR_iiwa_7_R800", "\"LBR_iiwa_7_R800", "// LBR_iiwa_7_R800", "'", "\"\\", "ä\"ö"]
        {
            let statements = in_java("A.java", text);
            assert_eq!(
                statements.len(),
                usize::from(text.starts_with('"') && text.len() > 2),
                "{text}"
            );
        }
    }
}
