//! Tools and workpieces.

use std::rc::Rc;

use crate::{ImportedTool, ToolFrame, ToolTemplate};
use iiwa_java::{SourceLine, Unknown};
use iiwa_kin::Load;
use iiwa_program::{Frame, Tool};

use crate::application::{frame_value::then, spot::Spot};

/// Tool or workpiece that a program has created.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) is_workpiece: bool,
    /// Frames relative to the root, each after its parent.
    pub(crate) frames: Vec<BodyFrame>,
    /// Index of the default motion frame; `None` for the root.
    pub(crate) default: Option<usize>,
    pub(crate) load: Option<Load>,
    /// Frame that the body is attached to, with its pose in that frame.
    pub(crate) attached: Option<(Spot, Frame)>,
    /// Name in programs, if the body is an unmodified tool template.
    pub(crate) in_programs: Option<String>,
    /// Java class, if the data file states it.
    pub(crate) class: Option<String>,
    /// Place of injection, if neither the data file nor an answer describes the body.
    pub(crate) missing: Option<SourceLine>,
}

/// Frame of a tool or a workpiece.
#[derive(Clone, Debug)]
pub(crate) struct BodyFrame {
    /// Path as `/FRAME/FRAME`.
    pub(crate) path: String,
    /// Pose relative to the root.
    pub(crate) frame: Frame,
    /// Name in programs, `TOOL` or `TOOL/TIP`, if the tool is unmodified.
    pub(crate) in_programs: Option<String>,
    /// Unknown value on which the pose depends, if any.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

impl Body {
    /// Creates a body without frames and without a load.
    pub(crate) fn bare(name: &str, is_workpiece: bool) -> Self {
        Self {
            name: name.to_owned(),
            is_workpiece,
            frames: Vec::new(),
            default: None,
            load: None,
            attached: None,
            in_programs: None,
            class: None,
            missing: None,
        }
    }

    /// Creates a body from a template; a tool is `imported`.
    pub(crate) fn of_template(template: &ToolTemplate, imported: Option<&ImportedTool>) -> Self {
        let mut body = Self {
            load: template.load,
            class: template.class.clone(),
            ..Self::bare(&template.name, imported.is_none())
        };
        let root = (String::new(), Frame::default());
        let mut open: Vec<_> =
            template.frames.iter().rev().map(|frame| (frame, root.clone())).collect();
        while let Some((frame, (above, within))) = open.pop() {
            let frame: &ToolFrame = frame;
            let path = format!("{above}/{}", frame.name);
            let pose = if above.is_empty() { frame.frame } else { then(&within, &frame.frame) };
            open.extend(frame.children.iter().rev().map(|child| (child, (path.clone(), pose))));
            body.frames.push(BodyFrame { path, frame: pose, in_programs: None, unknown: None });
        }
        body.default = body
            .frames
            .iter()
            .position(|frame| Some(&frame.path) == template.default_frame.as_ref());
        if let Some(imported) = imported {
            body.name_as(imported);
        }
        body
    }

    /// Sets the names of the tool frames in programs.
    fn name_as(&mut self, imported: &ImportedTool) {
        self.in_programs = Some(imported.name.clone());
        let mut tips = imported.tips.iter();
        let mut has_tcp = false;
        for frame in &mut self.frames {
            let is_tcp = !has_tcp && Some(&frame.path) == imported.tcp.as_ref();
            has_tcp |= is_tcp;
            frame.in_programs = if is_tcp {
                Some(imported.name.clone())
            } else {
                tips.next().map(|tip| format!("{}/{tip}", imported.name))
            };
        }
    }

    /// Returns the index of a frame by its path, with or without the first `/`.
    pub(crate) fn frame(&self, path: &str) -> Option<usize> {
        let path = path.trim_start_matches('/');
        self.frames.iter().position(|frame| frame.path.trim_start_matches('/') == path)
    }

    /// Converts the body to a program tool with its root at `root` in the flange frame. The load is
    /// set by the program.
    pub(crate) fn as_tool(&self, root: &Frame) -> Tool {
        let frame_at =
            |index: usize| self.frames.get(index).map_or(*root, |frame| then(root, &frame.frame));
        let tips = self.frames.iter().enumerate();
        let tips =
            tips.filter(|(index, frame)| Some(*index) != self.default && frame.unknown.is_none());
        let tips = tips.map(|(index, frame)| (tip_name(&frame.path), frame_at(index)));
        Tool { tcp: self.default.map_or(*root, frame_at), tips: tips.collect(), load: None }
    }
}

/// Returns the name of a tip in programs, by its path.
pub(crate) fn tip_name(path: &str) -> String {
    path.trim_start_matches('/').to_owned()
}
