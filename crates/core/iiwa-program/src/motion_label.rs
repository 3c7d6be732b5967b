//! Names, comments and groups of motions.

use serde::{Deserialize, Serialize};

/// Longest name of a motion or a group, in characters.
pub const MAX_NAME: usize = 200;

/// Longest comment of a motion, in characters.
pub const MAX_COMMENT: usize = 2000;

/// Name, comment and group of a motion. They have no effect on the trajectory; tables, reports,
/// messages and exports contain them.
///
/// ```
/// use iiwa_program::MotionLabel;
///
/// let label = MotionLabel::named("approach").in_group("pick");
/// assert_eq!(label.name.as_deref(), Some("approach"));
/// assert_eq!(label.group.as_deref(), Some("pick"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MotionLabel {
    /// Name; need not be unique.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Comment, possibly of several lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
    /// Group of motions whose times are added up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
}

impl MotionLabel {
    /// Label with a name.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..Self::default() }
    }

    /// Sets the group.
    #[must_use]
    pub fn in_group(self, group: impl Into<String>) -> Self {
        Self { group: Some(group.into()), ..self }
    }

    /// Sets the comment.
    #[must_use]
    pub fn with_comment(self, comment: impl Into<String>) -> Self {
        Self { comment: Some(comment.into()), ..self }
    }

    /// Returns true if the motion has neither a name, nor a comment, nor a group.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.name.is_none() && self.comment.is_none() && self.group.is_none()
    }

    /// Key of the first text that a program cannot have, with the reason: an empty name or group, a
    /// text that is too long, a control character.
    #[must_use]
    pub fn fault(&self) -> Option<(&'static str, String)> {
        let Self { name, comment, group } = self;
        let is_forbidden = |c: char| c.is_control();
        let of_name = |key, text: &Option<String>| {
            let text = text.as_deref()?;
            let message = text_fault(key, text, MAX_NAME, is_forbidden);
            let empty = text.is_empty().then(|| format!("`{key}` is empty"));
            Some((key, empty.or(message)?))
        };
        let of_comment = || {
            let is_forbidden = |c: char| is_forbidden(c) && !['\n', '\r', '\t'].contains(&c);
            let message = text_fault("comment", comment.as_deref()?, MAX_COMMENT, is_forbidden);
            Some(("comment", message?))
        };
        of_name("name", name).or_else(of_comment).or_else(|| of_name("group", group))
    }
}

/// Message about a text that is too long, or contains a forbidden character.
pub(crate) fn text_fault(
    key: &str,
    text: &str,
    max: usize,
    is_forbidden: impl Fn(char) -> bool,
) -> Option<String> {
    let length = text.chars().count();
    if length > max {
        return Some(format!("`{key}` has {length} characters; at most {max} are allowed"));
    }
    let character = text.chars().find(|c| is_forbidden(*c))?;
    let shown = character.escape_unicode();
    Some(format!("`{key}` contains the control character {shown}"))
}
