//! Entries that an application needs and that the data file lacks.

use std::fmt;

use crate::{DataFile, ProcessData, ToolFrame, ToolTemplate, WorldFrame};
use iiwa_program::Frame;

/// Entry that an application needs and that the project's data file lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Missing {
    /// Frame, by its path.
    Frame(String),
    /// Tool template, by its name.
    Template(String),
    /// Frame of a template.
    TemplateFrame {
        /// Name of the template.
        template: String,
        /// Path of the frame in the template.
        path: String,
    },
    /// Process data, by their id.
    ProcessData(String),
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(path) => write!(f, "the frame `{path}`"),
            Self::Template(name) => write!(f, "the template `{name}`"),
            Self::TemplateFrame { template, path } => {
                write!(f, "the frame `{path}` of the template `{template}`")
            }
            Self::ProcessData(id) => write!(f, "the process data `{id}`"),
        }
    }
}

impl Missing {
    /// Adds the entry to a data file, with zeros for its numbers.
    pub fn add_to(&self, file: &mut DataFile) {
        match self {
            Self::Frame(path) => add_frame(&mut file.frames, path),
            Self::Template(name) => {
                file.tools.push(ToolTemplate { name: name.clone(), ..ToolTemplate::default() });
            }
            Self::TemplateFrame { template, path } => {
                let known = file.tools.iter_mut().chain(&mut file.workpieces);
                for template_data in known.filter(|template_data| template_data.name == *template) {
                    add_tool_frame(&mut template_data.frames, path);
                }
            }
            Self::ProcessData(id) => {
                file.process_data.push(ProcessData { id: id.clone(), ..ProcessData::default() });
            }
        }
    }
}

/// Returns the first name of a path, and the rest.
fn first(path: &str) -> (&str, Option<&str>) {
    let path = path.trim_start_matches('/');
    match path.split_once('/') {
        Some((name, rest)) => (name, Some(rest)),
        None => (path, None),
    }
}

fn add_frame(frames: &mut Vec<WorldFrame>, path: &str) {
    let (name, rest) = first(path);
    let known = frames.iter().position(|frame| frame.name == name);
    let index = known.unwrap_or_else(|| {
        frames.push(WorldFrame {
            name: name.to_owned(),
            frame: Frame::default(),
            redundancy: None,
            teaching: None,
            children: Vec::new(),
        });
        frames.len() - 1
    });
    if let (Some(rest), Some(frame)) = (rest, frames.get_mut(index)) {
        add_frame(&mut frame.children, rest);
    }
}

fn add_tool_frame(frames: &mut Vec<ToolFrame>, path: &str) {
    let (name, rest) = first(path);
    let known = frames.iter().position(|frame| frame.name == name);
    let index = known.unwrap_or_else(|| {
        let (frame, children) = (Frame::default(), Vec::new());
        frames.push(ToolFrame { name: name.to_owned(), frame, children });
        frames.len() - 1
    });
    if let (Some(rest), Some(frame)) = (rest, frames.get_mut(index)) {
        add_tool_frame(&mut frame.children, rest);
    }
}
