//! Reader of the links and joints of a URDF.

use std::collections::HashSet;

use iiwa_json::JsonPlace;
use quick_xml::{Reader, events::Event};

use super::{
    UrdfError,
    joint::{Draft, UrdfJoint},
    tag::{Tag, TextSpan},
};

/// Links and joints of a URDF.
pub(super) struct Description<'t> {
    /// Place of the root element.
    pub(super) span: TextSpan<'t>,
    pub(super) links: Vec<String>,
    pub(super) joints: Vec<UrdfJoint<'t>>,
    /// The first element of xacro, with its name: a file that is not expanded.
    pub(super) xacro: Option<(TextSpan<'t>, String)>,
}

impl<'t> Description<'t> {
    /// Reads the links and joints, and skips everything else.
    ///
    /// Makes one pass over the text without recursion, regardless of the nesting depth.
    pub(super) fn read(text: &'t str) -> Result<Self, UrdfError> {
        let mut reader = Reader::from_str(text);
        let mut depth = 0_usize;
        let mut description: Option<Self> = None;
        let mut quaternions = false;
        let mut draft: Option<Draft<'t>> = None;
        let mut names = HashSet::new();
        loop {
            let start = offset(reader.buffer_position());
            let event = reader.read_event();
            let (element, is_open) = match event {
                Err(error) => {
                    let byte = offset(reader.error_position());
                    return Err(UrdfError::Xml {
                        place: JsonPlace::of_span(text, byte..byte + 1),
                        problem: error.to_string(),
                    });
                }
                Ok(Event::Start(element)) => (element, true),
                Ok(Event::Empty(element)) => (element, false),
                Ok(Event::End(_)) => {
                    depth = depth.saturating_sub(1);
                    if depth == 1
                        && let (Some(joint), Some(description)) = (draft.take(), &mut description)
                    {
                        description.joints.push(joint.finish()?);
                    }
                    continue;
                }
                Ok(Event::Eof) => {
                    let problem = match description {
                        _ if depth > 0 => format!("it ends inside {depth} open elements"),
                        None => "it has no element".to_owned(),
                        Some(description) => return Ok(description),
                    };
                    let place = JsonPlace::of_span(text, text.len()..text.len());
                    return Err(UrdfError::Xml { place, problem });
                }
                Ok(event) => {
                    if depth == 0 && is_text(&event) {
                        let rest = text.get(start..).map(str::trim_start);
                        let start = rest.map_or(start, |rest| text.len() - rest.len());
                        let span = TextSpan { text, start, end: offset(reader.buffer_position()) };
                        let side = if description.is_some() { "after" } else { "before" };
                        let problem = format!("it has text {side} the outermost element");
                        return Err(UrdfError::Xml { place: span.place(), problem });
                    }
                    continue;
                }
            };
            let span = TextSpan { text, start, end: offset(reader.buffer_position()) };
            let tag = Tag { element: &element, span };
            if let Some(description) = &mut description
                && description.xacro.is_none()
                && element.name().as_ref().starts_with(b"xacro:")
            {
                let name = String::from_utf8_lossy(element.name().as_ref()).into_owned();
                description.xacro = Some((span, name));
            }
            match (depth, element.name().as_ref(), &mut description, &mut draft) {
                (0, _, Some(_), _) => {
                    let problem = "it has a second outermost element".to_owned();
                    return Err(UrdfError::Xml { place: span.place(), problem });
                }
                (0, b"robot", None, _) => {
                    quaternions = tag.attribute("version")?.is_some_and(|v| v.trim() != "1.0");
                    description =
                        Some(Self { span, links: Vec::new(), joints: Vec::new(), xacro: None });
                }
                (0, name, None, _) => {
                    let found = String::from_utf8_lossy(name).into_owned();
                    return Err(UrdfError::NotUrdf { place: span.place(), found });
                }
                (1, b"link", Some(description), _) => {
                    let name = tag.required("name", "a link")?;
                    unique(&mut names, format!("link {name:?}"), span)?;
                    description.links.push(name);
                }
                (1, b"joint", Some(description), _) => {
                    let new = Draft::new(&tag)?;
                    unique(&mut names, format!("joint {:?}", new.joint.name), span)?;
                    if is_open {
                        draft = Some(new);
                    } else {
                        description.joints.push(new.finish()?);
                    }
                }
                (2, name, _, Some(draft)) => draft.part(name, &tag, quaternions)?,
                _ => {}
            }
            depth += usize::from(is_open);
        }
    }
}

/// Returns true for text other than white space.
fn is_text(event: &Event<'_>) -> bool {
    match event {
        Event::Text(text) => !text.trim_ascii().is_empty(),
        Event::CData(_) | Event::GeneralRef(_) => true,
        _ => false,
    }
}

/// Adds `name` to `names`; an error if `names` already contains it.
fn unique(names: &mut HashSet<String>, name: String, span: TextSpan<'_>) -> Result<(), UrdfError> {
    match names.replace(name) {
        None => Ok(()),
        Some(owner) => Err(UrdfError::Duplicate { place: span.place(), owner }),
    }
}

pub(super) fn offset(byte: u64) -> usize {
    usize::try_from(byte).unwrap_or(usize::MAX)
}
