//! Tools and workpieces.

use std::rc::Rc;

use crate::{ImportedTool, ToolFrame, ToolTemplate};
use iiwa_java::{Place, Unknown};
use iiwa_kin::Load;
use iiwa_program::{Frame, Tool};

use crate::application::{frame_value::then, spot::Spot};

/// A tool or a workpiece that a program has made.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) is_workpiece: bool,
    /// Its frames in its root, each behind the one that it is given in.
    pub(crate) frames: Vec<BodyFrame>,
    /// The frame that moves unless another is named; the root if absent.
    pub(crate) default: Option<usize>,
    pub(crate) load: Option<Load>,
    /// Where it is attached, and how it lies there.
    pub(crate) attached: Option<(Spot, Frame)>,
    /// Its name in programs, if it is a template of a tool that is used as it is.
    pub(crate) in_programs: Option<String>,
    /// Its class in Java, if the data file states it.
    pub(crate) class: Option<String>,
    /// The place at which it is injected, if neither the data file nor an answer describes it.
    pub(crate) missing: Option<Place>,
}

/// A frame of a tool or a workpiece.
#[derive(Clone, Debug)]
pub(crate) struct BodyFrame {
    /// As `/FRAME/FRAME`.
    pub(crate) path: String,
    /// Where it is in the root.
    pub(crate) frame: Frame,
    /// Its name in programs, `TOOL` or `TOOL/TIP`, if the tool is used as it is.
    pub(crate) in_programs: Option<String>,
    /// The value on which its place depends, if that is not known.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

impl Body {
    /// One without frames that weighs nothing.
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

    /// One from a template; a tool is `imported`.
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
            let own = if above.is_empty() { frame.frame } else { then(&within, &frame.frame) };
            open.extend(frame.children.iter().rev().map(|child| (child, (path.clone(), own))));
            body.frames.push(BodyFrame { path, frame: own, in_programs: None, unknown: None });
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

    /// Gives the frames of a tool their names in programs.
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

    /// A frame by its path, with or without the first `/`.
    pub(crate) fn frame(&self, path: &str) -> Option<usize> {
        let path = path.trim_start_matches('/');
        self.frames.iter().position(|frame| frame.path.trim_start_matches('/') == path)
    }

    /// As a tool of programs, where its root is at `root` in the flange's frame. What it weighs is up to the program.
    pub(crate) fn as_tool(&self, root: &Frame) -> Tool {
        let at =
            |index: usize| self.frames.get(index).map_or(*root, |frame| then(root, &frame.frame));
        let tips = self.frames.iter().enumerate();
        let tips =
            tips.filter(|(index, own)| Some(*index) != self.default && own.unknown.is_none());
        let tips = tips.map(|(index, frame)| (tip_name(&frame.path), at(index)));
        Tool { tcp: self.default.map_or(*root, at), tips: tips.collect(), load: None }
    }
}

/// The name of a tip in programs, by its path.
pub(crate) fn tip_name(path: &str) -> String {
    path.trim_start_matches('/').to_owned()
}
