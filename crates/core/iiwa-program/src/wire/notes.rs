//! Common keys of all motions: name, comment, group and source.

use crate::{motion_label::MotionLabel, source::Source};

/// Pattern of names: no control characters.
pub(super) const NAME_PATTERN: &str = r"^[^\x00-\x1f\x7f-\x9f]*$";

/// Pattern of comments: no control characters but line ends and tabs.
pub(super) const COMMENT_PATTERN: &str = r"^[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]*$";

/// Declares a type with the common keys of all motions after its other keys, and access to them by
/// `notes_mut`.
macro_rules! noted_wire {
    (
        $(#[$meta:meta])* pub(super) struct $name:ident {
            $($(#[$field_meta:meta])* $field:ident: $field_type:ty,)*
        }
    ) => {
        $(#[$meta])*
        pub(super) struct $name {
            $($(#[$field_meta])* $field: $field_type,)*
            /// Name of the motion, for tables, reports and messages, without control characters;
            /// need not be unique.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(
                length(min = 1, max = 200),
                regex(pattern = $crate::wire::notes::NAME_PATTERN)
            )]
            name: Option<String>,
            /// Comment on the motion, for reports and exports.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(
                length(max = 2000),
                regex(pattern = $crate::wire::notes::COMMENT_PATTERN)
            )]
            comment: Option<String>,
            /// Group of the motion: the plan adds up the times of all motions of a group.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(
                length(min = 1, max = 200),
                regex(pattern = $crate::wire::notes::NAME_PATTERN)
            )]
            group: Option<String>,
            /// Source line of the motion.
            #[serde(
                default,
                deserialize_with = "iiwa_json::object_or_null",
                skip_serializing_if = "Option::is_none"
            )]
            source: Option<$crate::source::Source>,
        }

        impl $name {
            /// Common keys of all motions.
            pub(super) fn notes_mut(&mut self) -> $crate::wire::notes::NotesMut<'_> {
                $crate::wire::notes::NotesMut {
                    name: &mut self.name,
                    comment: &mut self.comment,
                    group: &mut self.group,
                    source: &mut self.source,
                }
            }
        }
    };
}

pub(super) use noted_wire;

/// Declares a type without these keys.
macro_rules! plain_wire {
    ($($declaration:tt)*) => { $($declaration)* };
}

pub(super) use plain_wire;

/// Common keys of a motion.
pub(super) struct NotesMut<'a> {
    pub(super) name: &'a mut Option<String>,
    pub(super) comment: &'a mut Option<String>,
    pub(super) group: &'a mut Option<String>,
    pub(super) source: &'a mut Option<Source>,
}

impl NotesMut<'_> {
    /// Removes the values.
    pub(super) fn take(self) -> (MotionLabel, Option<Source>) {
        let Self { name, comment, group, source } = self;
        let label = MotionLabel { name: name.take(), comment: comment.take(), group: group.take() };
        (label, source.take())
    }

    /// Sets the values.
    pub(super) fn set(self, label: Option<&MotionLabel>, source: Option<&Source>) {
        let label = label.cloned().unwrap_or_default();
        *self.name = label.name;
        *self.comment = label.comment;
        *self.group = label.group;
        *self.source = source.cloned();
    }
}
