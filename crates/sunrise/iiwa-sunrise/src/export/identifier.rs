//! Java names.

use std::collections::BTreeSet;

use super::error::ExportError;

/// Words that are not valid identifiers.
const RESERVED: [&str; 53] = [
    "abstract",
    "assert",
    "boolean",
    "break",
    "byte",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "continue",
    "default",
    "do",
    "double",
    "else",
    "enum",
    "extends",
    "false",
    "final",
    "finally",
    "float",
    "for",
    "goto",
    "if",
    "implements",
    "import",
    "instanceof",
    "int",
    "interface",
    "long",
    "native",
    "new",
    "null",
    "package",
    "private",
    "protected",
    "public",
    "return",
    "short",
    "static",
    "strictfp",
    "super",
    "switch",
    "synchronized",
    "this",
    "throw",
    "throws",
    "transient",
    "true",
    "try",
    "void",
    "volatile",
    "while",
];

/// Classes that an exported class uses, or whose names its package may hide.
const CLASSES: [&str; 26] = [
    "BasicMotions",
    "Boolean",
    "CIRC",
    "Double",
    "Exception",
    "Frame",
    "Inject",
    "Integer",
    "InterruptedException",
    "LBR",
    "LIN",
    "Math",
    "Object",
    "OrientationReferenceSystem",
    "Override",
    "PTP",
    "RoboticsAPIApplication",
    "SPL",
    "Spline",
    "SplineOrientationType",
    "String",
    "System",
    "ThreadUtil",
    "TimeUnit",
    "Tool",
    "Transformation",
];

/// Returns the class name for a program called `name`: its words joined, each with a capital.
pub(super) fn class_of(name: &str) -> String {
    let mut class = String::new();
    for word in words(&in_ascii(name)) {
        let (first, rest) = word.split_at(1);
        class.extend([&first.to_ascii_uppercase(), rest]);
    }
    if class.is_empty() {
        return "MotionProgram".to_owned();
    }
    if class.starts_with(|c: char| c.is_ascii_digit()) || CLASSES.contains(&class.as_str()) {
        class = format!("Program{class}");
    }
    class
}

/// Checks a class name that the user has chosen.
pub(super) fn check_class(name: &str) -> Result<(), ExportError> {
    let wrong = |why| Err(ExportError::ClassName { name: name.to_owned(), why });
    let mut letters = name.chars();
    if !letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') {
        return wrong("it must begin with a letter from A to Z");
    }
    if !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return wrong("it may have letters from A to Z, digits and underscores only");
    }
    if RESERVED.contains(&name) {
        return wrong("Java reserves this word");
    }
    if CLASSES.contains(&name) {
        return wrong("the program itself uses a class of this name");
    }
    Ok(())
}

/// Returns true for a name that can be a part of an identifier.
pub(super) fn is_name_part(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Assigns unique names to variables.
pub(super) struct VariableNames(BTreeSet<String>);

impl VariableNames {
    /// Reserves the names in `taken`.
    pub(super) fn besides(taken: impl IntoIterator<Item = String>) -> Self {
        Self(taken.into_iter().collect())
    }

    /// Returns a variable name for an item called `name`.
    pub(super) fn give(&mut self, name: &str) -> String {
        let mut wanted = String::new();
        for word in words(&in_ascii(name)) {
            let (first, rest) = word.split_at(1);
            let first = if wanted.is_empty() {
                first.to_ascii_lowercase()
            } else {
                first.to_ascii_uppercase()
            };
            wanted.extend([&first, rest]);
        }
        if !wanted.starts_with(|c: char| c.is_ascii_alphabetic()) {
            wanted = format!("tool{wanted}");
        }
        if RESERVED.contains(&wanted.as_str()) {
            wanted.push('_');
        }
        let mut given = wanted.clone();
        let mut count = 1;
        while !self.0.insert(given.clone()) {
            count += 1;
            given = format!("{wanted}_{count}");
        }
        given
    }
}

/// Replaces German letters as in addresses of web sites. File names of classes and variables have
/// ASCII letters only, which every encoding has.
fn in_ascii(name: &str) -> String {
    let mut ascii = String::with_capacity(name.len());
    for letter in name.chars() {
        match letter {
            'ä' => ascii.push_str("ae"),
            'ö' => ascii.push_str("oe"),
            'ü' => ascii.push_str("ue"),
            'Ä' => ascii.push_str("Ae"),
            'Ö' => ascii.push_str("Oe"),
            'Ü' => ascii.push_str("Ue"),
            'ß' => ascii.push_str("ss"),
            _ => ascii.push(letter),
        }
    }
    ascii
}

/// Returns the runs of ASCII letters and digits.
fn words(name: &str) -> impl Iterator<Item = &str> {
    name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_named_after_programs() {
        for (name, class) in [
            ("pick-and-place", "PickAndPlace"),
            ("Weld 2.json", "Weld2Json"),
            ("2-stations", "Program2Stations"),
            ("frame", "ProgramFrame"),
            ("", "MotionProgram"),
            ("溶接", "MotionProgram"),
            ("Käfig öffnen", "KaefigOeffnen"),
            ("iiwa7R800", "Iiwa7R800"),
        ] {
            assert_eq!(class_of(name), class);
            check_class(&class_of(name)).unwrap();
        }
        for wrong in ["", "2a", "a-b", "class", "LBR", "a b", "é"] {
            check_class(wrong).unwrap_err();
        }
    }

    #[test]
    fn variables_differ() {
        let mut variables = VariableNames::besides(["lbr".to_owned()]);
        let given = ["Gripper", "gripper", "LBR", "lbr", "new", "2 jaws", "Ø"]
            .map(|name| variables.give(name));
        assert_eq!(given, ["gripper", "gripper_2", "lBR", "lbr_2", "new_", "tool2Jaws", "tool"]);
    }
}
