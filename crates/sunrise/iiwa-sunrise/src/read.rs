//! Reads a data file from XML.

use std::collections::BTreeMap;

use iiwa_kin::{Status, Turn};
use iiwa_program::{Frame, Load};

use crate::{
    data_file::{
        DataFile, NotTaken, ProcessData, TaughtRedundancy, Teaching, ToolFrame, ToolTemplate,
        WorldFrame,
    },
    element::Element,
    error::DataFileError,
};

/// Version of data files that this reader knows.
const VERSION: &str = "3";

impl DataFile {
    /// Reads a data file. Content other than frames, tools and process data is counted in
    /// [`not_taken`](Self::not_taken).
    ///
    /// # Errors
    ///
    /// If the text is not a data file, or if a frame or a tool lacks a number; the error reports
    /// the place in the text.
    pub fn from_xml(text: &str) -> Result<Self, DataFileError> {
        let root = Element::read(text)?;
        if root.name != "RoboticsAPIData" {
            return Err(DataFileError::NotDataFile { place: root.place(), root: root.name });
        }
        let mut file = Self::default();
        let mut rest = SkippedEntries::default();
        if let Some(version) = root.attribute("version").filter(|version| *version != VERSION) {
            let why = format!("its entries may differ in meaning from those of version {VERSION}");
            rest.add(&format!("version {version}"), &why);
        }
        for part in &root.children {
            match part.name.as_str() {
                "world" => {
                    for element in &part.children {
                        match element.name.as_str() {
                            "frame" => file.frames.push(world_frame(element, &mut rest)?),
                            "gravitation" => gravitation(element, &mut rest)?,
                            other => rest.unknown(other),
                        }
                    }
                }
                "objectTemplates" => {
                    for element in &part.children {
                        match element.name.as_str() {
                            "toolTemplate" => file.tools.push(tool(element, &mut rest)?),
                            "workpieceTemplate" => {
                                rest.add(
                                    "workpieceTemplate",
                                    "where a workpiece is attached, and when, is up to the program",
                                );
                                // Cells do not use workpieces: an unreadable one matters only to an
                                // application that asks for it.
                                let workpiece = tool(element, &mut SkippedEntries::default());
                                file.workpieces.extend(workpiece.ok());
                            }
                            other => rest.unknown(other),
                        }
                    }
                }
                "processDataContainer" => {
                    for element in &part.children {
                        match element.name.as_str() {
                            "processData" => {
                                rest.add("processData", "a value that the application asks for");
                                file.process_data.extend(process_data(element));
                            }
                            other => rest.unknown(other),
                        }
                    }
                }
                other => rest.unknown(other),
            }
        }
        file.not_taken = rest.kinds();
        Ok(file)
    }
}

/// Reads process data; `None` if it has no id by which an application could ask for it.
fn process_data(element: &Element<'_>) -> Option<ProcessData> {
    let text = |key| element.attribute(key).map(str::to_owned);
    Some(ProcessData {
        id: text("id")?,
        data_type: text("dataType").unwrap_or_default(),
        default_value: text("defaultValue"),
        value: text("value"),
        min: text("min"),
        max: text("max"),
    })
}

/// Skipped entries, with the reasons and their counts.
#[derive(Default)]
struct SkippedEntries(BTreeMap<(String, String), usize>);

impl SkippedEntries {
    fn add(&mut self, kind: &str, why: &str) {
        *self.0.entry((kind.to_owned(), why.to_owned())).or_default() += 1;
    }

    fn unknown(&mut self, element: &str) {
        self.add(&format!("<{element}>"), "an unknown element");
    }

    fn kinds(self) -> Vec<NotTaken> {
        self.0
            .into_iter()
            .map(|((kind, why), count)| NotTaken { kind, count, reason: why })
            .collect()
    }
}

fn gravitation(element: &Element<'_>, rest: &mut SkippedEntries) -> Result<(), DataFileError> {
    let [x, y, z] = ["x", "y", "z"].map(|key| element.number(key));
    let why = match [x?, y?, z?] {
        [0.0, 0.0, z] if z > 0.0 => "the robot is mounted upright, as programs assume".to_owned(),
        [x, y, z] => format!("the robot is not mounted upright: gravity is {x} {y} {z}"),
    };
    rest.add("gravitation", &why);
    Ok(())
}

fn world_frame(
    element: &Element<'_>,
    rest: &mut SkippedEntries,
) -> Result<WorldFrame, DataFileError> {
    let mut frame = WorldFrame {
        name: element.required("name")?.to_owned(),
        frame: placed(element, "transformation")?,
        redundancy: None,
        teaching: None,
        children: Vec::new(),
    };
    let mut redundancies = Vec::new();
    for part in &element.children {
        match part.name.as_str() {
            "transformation" => {}
            "frame" => frame.children.push(world_frame(part, rest)?),
            "additionalInformation" => {
                for info in &part.children {
                    if info.attribute("type").is_some_and(|kind| names(kind, "TeachInformation")) {
                        frame.teaching = Some(teaching(info)?);
                    } else {
                        additional(info, rest);
                    }
                }
            }
            "redundancyData" => {
                for entry in &part.children {
                    let kind = entry.attribute("type").unwrap_or_default();
                    if entry.name == "redundancy" && names(kind, "LBRE1Redundancy") {
                        redundancies.push(redundancy(entry, rest)?);
                    } else if entry.name == "redundancy" {
                        let message = format!("redundancy {}", last_part(kind));
                        rest.add(&message, "another rule than that of E1, status and turn");
                    } else {
                        rest.unknown(&entry.name);
                    }
                }
            }
            "measurementTranslation" | "measurementRotation" => measurement(rest),
            other => rest.unknown(other),
        }
    }
    // Several robots may have been taught at one frame.
    let taught = |entry: &TaughtRedundancy| {
        frame.teaching.as_ref().is_some_and(|teaching| teaching.device == entry.device)
    };
    if !redundancies.is_empty() {
        let chosen = redundancies.iter().position(taught).unwrap_or(0);
        frame.redundancy = Some(redundancies.swap_remove(chosen));
    }
    for _ in redundancies {
        rest.add("redundancy of another robot", "a frame has one");
    }
    Ok(frame)
}

/// Returns true if the last part of the class name is `name`, in any package.
fn names(class: &str, name: &str) -> bool {
    last_part(class) == name
}

fn last_part(class: &str) -> &str {
    class.rsplit(['.', '$']).next().unwrap_or(class)
}

fn measurement(rest: &mut SkippedEntries) {
    rest.add("measurement", "how a frame was measured");
}

/// Counts additional information about a frame or a tool.
fn additional(info: &Element<'_>, rest: &mut SkippedEntries) {
    let kind = info.attribute("key").or_else(|| info.attribute("type").map(last_part));
    match kind {
        Some("MeasurementInformation") => measurement(rest),
        Some(kind) if info.name == "info" => {
            rest.add(&format!("info {kind}"), "nothing that moves the arm");
        }
        _ => rest.unknown(&info.name),
    }
}

/// Reads the pose in a child element, in mm and rad.
fn placed(owner: &Element<'_>, child: &'static str) -> Result<Frame, DataFileError> {
    let element = owner.child(child).ok_or_else(|| owner.missing(child))?;
    let [x, y, z] = ["x", "y", "z"].map(|key| element.number(key));
    let [a, b, c] = ["a", "b", "c"].map(|key| element.number(key));
    Ok(Frame { xyz_mm: [x?, y?, z?], abc_rad: [a?, b?, c?] })
}

fn teaching(info: &Element<'_>) -> Result<Teaching, DataFileError> {
    let text = |key| info.attribute(key).unwrap_or_default().to_owned();
    Ok(Teaching {
        device: text("device"),
        tcp_name: text("tcpName"),
        tcp: placed(info, "tcpTransformation")?,
    })
}

fn redundancy(
    entry: &Element<'_>,
    rest: &mut SkippedEntries,
) -> Result<TaughtRedundancy, DataFileError> {
    let provider = entry.attribute("transformationProviderName").unwrap_or_default();
    let device = provider.rsplit('/').next().unwrap_or_default().to_owned();
    let mut redundancy = TaughtRedundancy { device, e1_rad: None, status: None, turn: None };
    for info in &entry.children {
        let bits = || info.attribute("value").and_then(|value| value.trim().parse().ok());
        let kind = last_part(info.attribute("type").unwrap_or_default());
        let is_read = match kind {
            "E1Parameter" => {
                redundancy.e1_rad = Some(info.number("value")?);
                true
            }
            "StatusParameter" => {
                redundancy.status = bits().and_then(Status::new);
                redundancy.status.is_some()
            }
            "TurnParameter" => {
                redundancy.turn = bits().and_then(Turn::new);
                redundancy.turn.is_some()
            }
            _ => {
                rest.unknown(&info.name);
                true
            }
        };
        if !is_read {
            let value = info.attribute("value").unwrap_or_default();
            rest.add(&format!("{kind} {value}"), "status is from 0 to 7, turn from 0 to 127");
        }
    }
    Ok(redundancy)
}

fn tool(element: &Element<'_>, rest: &mut SkippedEntries) -> Result<ToolTemplate, DataFileError> {
    let mut tool = ToolTemplate {
        name: element.required("name")?.to_owned(),
        class: element.attribute("class").map(str::to_owned),
        default_frame: element.attribute("defaultMotionFrameRef").map(str::to_owned),
        frames: Vec::new(),
        load: None,
    };
    for part in &element.children {
        match part.name.as_str() {
            "frames" => tool.frames.append(&mut tool_frames(part, rest)?),
            "loadData" => tool.load = load(part, &tool.name, rest)?,
            "additionalInformation" => part.children.iter().for_each(|info| additional(info, rest)),
            other => rest.unknown(other),
        }
    }
    Ok(tool)
}

/// Reads the frames in an element `frames`.
fn tool_frames(
    list: &Element<'_>,
    rest: &mut SkippedEntries,
) -> Result<Vec<ToolFrame>, DataFileError> {
    let mut frames = Vec::new();
    for element in &list.children {
        if element.name != "frame" {
            rest.unknown(&element.name);
            continue;
        }
        let mut frame = ToolFrame {
            name: element.required("name")?.to_owned(),
            frame: placed(element, "transformation")?,
            children: Vec::new(),
        };
        for part in &element.children {
            match part.name.as_str() {
                "transformation" => {}
                "frames" => frame.children.append(&mut tool_frames(part, rest)?),
                "additionalInformation" => {
                    part.children.iter().for_each(|info| additional(info, rest));
                }
                "measurementTranslation" | "measurementRotation" => measurement(rest),
                other => rest.unknown(other),
            }
        }
        frames.push(frame);
    }
    Ok(frames)
}

/// Reads the load of a tool; `None` if the load was never determined.
fn load(
    element: &Element<'_>,
    tool: &str,
    rest: &mut SkippedEntries,
) -> Result<Option<Load>, DataFileError> {
    let mass_kg = element.number("mass")?;
    if mass_kg <= 0.0 {
        let subject = format!("loadData of {tool}");
        rest.add(&subject, &format!("its mass is {mass_kg} kg: it was not determined"));
        return Ok(None);
    }
    let or_zero = |key| match element.attribute(key) {
        Some(_) => element.number(key),
        None => Ok(0.0),
    };
    let three = |keys: [&'static str; 3]| {
        let [x, y, z] = keys.map(or_zero);
        Ok::<_, DataFileError>([x?, y?, z?])
    };
    let load = Load {
        mass_kg,
        center_mm: three(["cogX", "cogY", "cogZ"])?,
        inertia_kg_m2: three(["inertiaX", "inertiaY", "inertiaZ"])?,
        abc_rad: three(["cogA", "cogB", "cogC"])?,
    };
    // A program with this load would be refused.
    if let Err(error) = load.check() {
        rest.add(&format!("loadData of {tool}"), &error.to_string());
        return Ok(None);
    }
    Ok(Some(load))
}
