//! Elements of a Collada document: references, numbers, places of faults.

use std::{
    borrow::Cow,
    collections::{HashMap, HashSet, hash_map::Entry},
};

use iiwa_json::excerpt;
use roxmltree::{Document, Node, NodeId};

/// Element, or another node of the XML tree.
pub(super) type XmlElement<'a> = Node<'a, 'a>;

/// Error of reading a Collada file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
#[non_exhaustive]
pub struct ColladaError {
    /// Line of the file, from 1.
    pub line: u32,
    /// Column in this line, from 1.
    pub column: u32,
    /// Fault, or content that cannot be applied.
    pub message: String,
}

/// Creates an error at the start of an element.
pub(super) fn fault(element: XmlElement<'_>, message: impl Into<String>) -> ColladaError {
    let place = element.document().text_pos_at(element.range().start);
    ColladaError { line: place.row, column: place.col, message: message.into() }
}

/// Collada document with an index of its elements.
pub(super) struct ColladaDocument<'a> {
    root: XmlElement<'a>,
    /// Elements with an `id`, by tag name and `id`; `None` for an ambiguous `id`. Names of
    /// different kinds do not conflict: some programs write a node and its geometry with one `id`.
    by_id: HashMap<(&'a str, &'a str), Option<NodeId>>,
    /// Length unit of the document, in m.
    pub(super) unit_m: f64,
    /// Elements within a part of the document that has another unit.
    other_unit: HashSet<NodeId>,
}

impl<'a> ColladaDocument<'a> {
    pub(super) fn new(xml: &'a Document<'a>) -> Result<Self, ColladaError> {
        let root = xml.root_element();
        let tag = root.tag_name().name();
        if tag != "COLLADA" {
            let message = format!("the outermost element is <{}>, not <COLLADA>", excerpt(tag));
            return Err(fault(root, message));
        }
        let mut by_id = HashMap::new();
        for element in root.descendants().filter(XmlElement::is_element) {
            let Some(id) = element.attribute("id") else { continue };
            match by_id.entry((element.tag_name().name(), id)) {
                Entry::Vacant(free) => drop(free.insert(Some(element.id()))),
                Entry::Occupied(mut taken) => drop(taken.insert(None)),
            }
        }
        let unit_m = stated_unit(root)?.unwrap_or(1.0);
        let other_unit = other_unit(root, unit_m)?;
        Ok(Self { root, by_id, unit_m, other_unit })
    }

    /// Returns the visual scene that the document shows.
    pub(super) fn visual_scene(&self) -> Result<XmlElement<'a>, ColladaError> {
        let scene = child(self.root, "scene")
            .ok_or_else(|| fault(self.root, "<scene> is missing: the file shows nothing"))?;
        let instance = child(scene, "instance_visual_scene").ok_or_else(|| {
            fault(scene, "<instance_visual_scene> is missing: the file shows nothing")
        })?;
        self.target(instance, "url", "visual_scene")
    }

    /// Returns the element with the tag name `tag` to which an attribute refers, if there is one.
    /// Unlike [`target`](Self::target), this function does not locate faults in the text, which
    /// takes time in proportion to its length.
    pub(super) fn find(
        &self,
        element: XmlElement<'a>,
        attribute: &str,
        tag: &str,
    ) -> Option<XmlElement<'a>> {
        let id = element.attribute(attribute)?.trim().strip_prefix('#')?;
        self.root.document().get_node((*self.by_id.get(&(tag, id))?)?)
    }

    /// Returns the element with the tag name `tag` to which an attribute refers.
    pub(super) fn target(
        &self,
        element: XmlElement<'a>,
        attribute: &str,
        tag: &str,
    ) -> Result<XmlElement<'a>, ColladaError> {
        let owner = element.tag_name().name();
        let Some(url) = element.attribute(attribute) else {
            return Err(fault(element, format!("<{owner}> has no attribute `{attribute}`")));
        };
        let shown = excerpt(url);
        let Some(id) = url.trim().strip_prefix('#') else {
            let message = format!("<{owner}> refers to {shown:?} outside of this file");
            return Err(fault(element, message));
        };
        match self.by_id.get(&(tag, id)) {
            Some(Some(found)) => Ok(self.root.document().get_node(*found).unwrap_or(self.root)),
            Some(None) => {
                let message =
                    format!("<{owner}> refers to {shown:?}, and several <{tag}> have this id");
                Err(fault(element, message))
            }
            None => {
                let message = format!("<{owner}> refers to {shown:?}, and no <{tag}> has this id");
                Err(fault(element, message))
            }
        }
    }

    /// Refuses an element in a part of the document with another unit.
    pub(super) fn check_unit(&self, element: XmlElement<'a>) -> Result<(), ColladaError> {
        if self.other_unit.contains(&element.id()) {
            let message =
                "this element has another <unit> than the document, which is not supported";
            return Err(fault(element, message));
        }
        Ok(())
    }
}

/// Returns the unit of the `<asset>` of an element, in m, if stated.
fn stated_unit(owner: XmlElement<'_>) -> Result<Option<f64>, ColladaError> {
    let Some(unit) = child(owner, "asset").and_then(|asset| child(asset, "unit")) else {
        return Ok(None);
    };
    let Some(meter) = unit.attribute("meter") else { return Ok(Some(1.0)) };
    match meter.trim().parse() {
        Ok(unit_m) if f64::is_finite(unit_m) && unit_m > 0.0 => Ok(Some(unit_m)),
        _ => Err(fault(
            unit,
            format!("the unit is {:?} m; it must be a number above 0", excerpt(meter)),
        )),
    }
}

/// Returns all elements in parts of the document whose unit is not `unit_m`.
fn other_unit(root: XmlElement<'_>, unit_m: f64) -> Result<HashSet<NodeId>, ColladaError> {
    let mut found = HashSet::new();
    // Elements are visited in the order of the text, so that one end is enough.
    let mut end = 0;
    for element in root.descendants().filter(XmlElement::is_element) {
        if element != root && stated_unit(element)?.is_some_and(|other_m| other_m != unit_m) {
            end = end.max(element.range().end);
        }
        if element.range().start < end {
            found.insert(element.id());
        }
    }
    Ok(found)
}

/// Returns the child elements.
pub(super) fn elements(owner: XmlElement<'_>) -> impl Iterator<Item = XmlElement<'_>> {
    owner.children().filter(XmlElement::is_element)
}

/// Returns the child elements with a tag name.
pub(super) fn children<'a>(
    owner: XmlElement<'a>,
    tag: &str,
) -> impl Iterator<Item = XmlElement<'a>> {
    elements(owner).filter(move |element| element.tag_name().name() == tag)
}

/// Returns the first child element with a tag name.
pub(super) fn child<'a>(owner: XmlElement<'a>, tag: &str) -> Option<XmlElement<'a>> {
    children(owner, tag).next()
}

/// Returns the text of an element. Comments may divide it.
fn content(element: XmlElement<'_>) -> Cow<'_, str> {
    let mut parts = element.children().filter_map(|part| part.is_text().then(|| part.text())?);
    let first = parts.next().unwrap_or_default();
    parts.fold(Cow::Borrowed(first), |content, part| content + part)
}

/// Reads the numbers of an element, which must be finite.
pub(super) fn numbers(element: XmlElement<'_>) -> Result<Vec<f64>, ColladaError> {
    list(element, finite_number, "a finite number")
}

/// Reads the numbers of an element; `None` if one of them is not finite.
pub(super) fn finite_numbers(element: XmlElement<'_>) -> Option<Vec<f64>> {
    content(element).split_ascii_whitespace().map(finite_number).collect()
}

fn finite_number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Reads the counts or indices of an element.
pub(super) fn indices(element: XmlElement<'_>) -> Result<Vec<usize>, ColladaError> {
    list(element, |word| word.parse().ok(), "an index")
}

fn list<T>(
    element: XmlElement<'_>,
    parse: impl Fn(&str) -> Option<T>,
    expected: &str,
) -> Result<Vec<T>, ColladaError> {
    let content = content(element);
    let read = |word: &str| {
        parse(word).ok_or_else(|| {
            let tag = element.tag_name().name();
            fault(element, format!("{:?} in <{tag}> is not {expected}", excerpt(word)))
        })
    };
    content.split_ascii_whitespace().map(read).collect()
}

/// Reads an attribute as a count or index, if present.
pub(super) fn count(element: XmlElement<'_>, name: &str) -> Result<Option<usize>, ColladaError> {
    let Some(text) = element.attribute(name) else { return Ok(None) };
    text.trim().parse().map(Some).map_err(|_| {
        let tag = element.tag_name().name();
        fault(element, format!("the attribute `{name}` of <{tag}> is {:?}", excerpt(text)))
    })
}

/// Returns the name of an element for messages: its tag with its `id` or `name`.
pub(super) fn title(element: XmlElement<'_>) -> String {
    let tag = element.tag_name().name();
    match element.attribute("id").or_else(|| element.attribute("name")) {
        Some(name) => format!("<{tag}> {:?}", excerpt(name)),
        None => format!("<{tag}>"),
    }
}
