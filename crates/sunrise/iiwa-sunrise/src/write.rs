//! Writes a data file as XML.

use std::fmt::Write as _;

use iiwa_program::{Frame, Load};
use quick_xml::escape::escape;

use crate::data_file::{
    DataFile, ProcessData, TaughtRedundancy, Teaching, ToolFrame, ToolTemplate, WorldFrame,
};

impl DataFile {
    /// Returns the file as XML, which [`from_xml`](Self::from_xml) reads back bit for bit. Gravity
    /// is set for a robot that is mounted upright; content other than frames, tools and process
    /// data is not kept. Names must not contain control characters, which XML cannot represent.
    ///
    /// ```
    /// use iiwa_sunrise::DataFile;
    ///
    /// let file = DataFile::from_xml(r#"<RoboticsAPIData version="3"><world><frame name="A">
    ///     <transformation x="0.1" y="2" z="3" a="0" b="0" c="3.141592653589793"/>
    /// </frame></world></RoboticsAPIData>"#)?;
    /// assert_eq!(DataFile::from_xml(&file.to_xml())?.frames, file.frames);
    /// # Ok::<(), iiwa_sunrise::DataFileError>(())
    /// ```
    #[must_use]
    pub fn to_xml(&self) -> String {
        let mut xml = XmlText::default();
        xml.open("RoboticsAPIData", &[("version", "3".to_owned())]);
        xml.open("world", &[]);
        xml.empty("gravitation", &numbers(["x", "y", "z"], [0.0, 0.0, 9.81]));
        self.frames.iter().for_each(|frame| xml.world_frame(frame));
        xml.close("world");
        if !self.tools.is_empty() {
            xml.open("objectTemplates", &[]);
            self.tools.iter().for_each(|tool| xml.tool(tool));
            xml.close("objectTemplates");
        }
        if !self.process_data.is_empty() {
            xml.open("processDataContainer", &[]);
            self.process_data.iter().for_each(|data| xml.process_data(data));
            xml.close("processDataContainer");
        }
        xml.close("RoboticsAPIData");
        xml.text
    }
}

type XmlAttribute = (&'static str, String);

fn numbers<const N: usize>(keys: [&'static str; N], values: [f64; N]) -> Vec<XmlAttribute> {
    let written = values.map(|value| format!("{value:?}"));
    keys.into_iter().zip(written).collect()
}

/// XML text under construction.
struct XmlText {
    text: String,
    depth: usize,
}

impl Default for XmlText {
    fn default() -> Self {
        Self {
            text: "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n".to_owned(),
            depth: 0,
        }
    }
}

impl XmlText {
    fn tag(&mut self, name: &str, attributes: &[XmlAttribute], end: &str) {
        let indent = 2 * self.depth;
        let _ = write!(self.text, "{:indent$}<{name}", "");
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"{}\"", escape(value.as_str()));
        }
        self.text.push_str(end);
        self.text.push('\n');
    }

    fn open(&mut self, name: &str, attributes: &[XmlAttribute]) {
        self.tag(name, attributes, ">");
        self.depth += 1;
    }

    fn empty(&mut self, name: &str, attributes: &[XmlAttribute]) {
        self.tag(name, attributes, "/>");
    }

    fn process_data(&mut self, data: &ProcessData) {
        let ProcessData { id, data_type, default_value, value, min, max } = data;
        let given = [("defaultValue", default_value), ("value", value), ("min", min), ("max", max)];
        let given = given.into_iter().filter_map(|(key, value)| Some((key, value.clone()?)));
        let attributes = [("id", id.clone()), ("dataType", data_type.clone())];
        self.empty("processData", &attributes.into_iter().chain(given).collect::<Vec<_>>());
    }

    fn close(&mut self, name: &str) {
        self.depth -= 1;
        let indent = 2 * self.depth;
        let _ = writeln!(self.text, "{:indent$}</{name}>", "");
    }

    fn placed(&mut self, name: &str, frame: &Frame) {
        let mut attributes = numbers(["a", "b", "c"], frame.abc_rad);
        attributes.extend(numbers(["x", "y", "z"], frame.xyz_mm));
        self.empty(name, &attributes);
    }

    fn world_frame(&mut self, frame: &WorldFrame) {
        self.open("frame", &[("name", frame.name.clone())]);
        self.placed("transformation", &frame.frame);
        if let Some(teaching) = &frame.teaching {
            self.teaching(teaching);
        }
        if let Some(redundancy) = &frame.redundancy {
            self.redundancy(redundancy);
        }
        frame.children.iter().for_each(|child| self.world_frame(child));
        self.close("frame");
    }

    fn teaching(&mut self, Teaching { device, tcp_name, tcp }: &Teaching) {
        self.open("additionalInformation", &[]);
        self.open(
            "info",
            &[
                ("device", device.clone()),
                ("tcpName", tcp_name.clone()),
                ("type", "com.kuka.roboticsAPI.geometricModel.TeachInformation".to_owned()),
            ],
        );
        self.placed("tcpTransformation", tcp);
        self.close("info");
        self.close("additionalInformation");
    }

    fn redundancy(&mut self, redundancy: &TaughtRedundancy) {
        const PACKAGE: &str = "com.kuka.roboticsAPI.deviceModel";
        // Default name of a station in Sunrise.
        const STATION: &str = "KUKA_Sunrise_Cabinet_1";
        let parameters = [
            (
                "StatusTurnRedundancy$StatusParameter",
                redundancy.status.map(|status| status.to_string()),
            ),
            ("StatusTurnRedundancy$TurnParameter", redundancy.turn.map(|turn| turn.to_string())),
            ("LBRE1Redundancy$E1Parameter", redundancy.e1_rad.map(|e1_rad| format!("{e1_rad:?}"))),
        ];
        self.open("redundancyData", &[]);
        self.open(
            "redundancy",
            &[
                ("transformationProviderName", format!("{STATION}/{}", redundancy.device)),
                ("type", format!("{PACKAGE}.LBRE1Redundancy")),
            ],
        );
        for (kind, value) in parameters {
            if let Some(value) = value {
                self.empty("info", &[("type", format!("{PACKAGE}.{kind}")), ("value", value)]);
            }
        }
        self.close("redundancy");
        self.close("redundancyData");
    }

    fn tool(&mut self, tool: &ToolTemplate) {
        let default = tool.default_frame.clone().map(|frame| ("defaultMotionFrameRef", frame));
        let name = [("name", tool.name.clone())];
        self.open("toolTemplate", &name.into_iter().chain(default).collect::<Vec<_>>());
        self.tool_frames(&tool.frames);
        if let Some(load) = &tool.load {
            self.load(load);
        }
        self.close("toolTemplate");
    }

    fn tool_frames(&mut self, frames: &[ToolFrame]) {
        if frames.is_empty() {
            return;
        }
        self.open("frames", &[]);
        for frame in frames {
            self.open("frame", &[("name", frame.name.clone())]);
            self.placed("transformation", &frame.frame);
            self.tool_frames(&frame.children);
            self.close("frame");
        }
        self.close("frames");
    }

    fn load(&mut self, load: &Load) {
        let mut attributes = numbers(["mass"], [load.mass_kg]);
        attributes.extend(numbers(["cogX", "cogY", "cogZ"], load.center_mm));
        attributes.extend(numbers(["cogA", "cogB", "cogC"], load.abc_rad));
        attributes.extend(numbers(["inertiaX", "inertiaY", "inertiaZ"], load.inertia_kg_m2));
        self.empty("loadData", &attributes);
    }
}
