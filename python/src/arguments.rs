//! Places of errors as arguments: the caller of a function has not seen the JSON text that is made
//! from its arguments.

use std::fmt::Write as _;

/// One step down into a JSON value.
#[derive(Clone, Debug)]
enum ArgumentStep {
    Key(String),
    Index(usize),
}

/// Path to the value at the byte `at` of a valid JSON text; for a key, the path to its object.
fn path_to(text: &str, at: usize) -> Vec<ArgumentStep> {
    let bytes = text.as_bytes();
    let mut path: Vec<ArgumentStep> = Vec::new();
    // The last string at the start of an entry, which is a key if a colon follows.
    let mut key = String::new();
    let mut i = 0;
    while i < bytes.len() && i <= at {
        match bytes[i] {
            b'"' => {
                let start = i + 1;
                i = start;
                while i < bytes.len() && bytes[i] != b'"' {
                    i += if bytes[i] == b'\\' { 2 } else { 1 };
                }
                if at <= i {
                    break;
                }
                let word = text.get(start - 1..=i).unwrap_or_default();
                key = serde_json::from_str(word).unwrap_or_default();
            }
            b':' => path.push(ArgumentStep::Key(std::mem::take(&mut key))),
            // The path to an object in which no key has been read yet is the path to its parent.
            b'{' if i == at => return path,
            b'[' => {
                if i == at {
                    return path;
                }
                path.push(ArgumentStep::Index(0));
            }
            b',' => match path.last_mut() {
                Some(ArgumentStep::Index(index)) => *index += 1,
                _ => {
                    path.pop();
                }
            },
            b'}' if is_empty_object(bytes, i) => {}
            b'}' | b']' => {
                path.pop();
            }
            _ => {}
        }
        i += 1;
    }
    path
}

fn is_empty_object(bytes: &[u8], closing: usize) -> bool {
    bytes[..closing].iter().rev().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
}

/// Names of arguments that have another name than the key of a motion.
const MOTION_ARGUMENTS: [(&str, &str); 3] =
    [("joints_deg", "deg"), ("joints_rad", "rad"), ("in", "within")];

/// Name of the argument at a path within the keys of a motion, or of a program.
fn argument(path: &[ArgumentStep], is_motion: bool) -> String {
    let mut name = String::new();
    for (depth, step) in path.iter().enumerate() {
        match step {
            ArgumentStep::Index(index) => {
                let _ = write!(name, "[{index}]");
            }
            ArgumentStep::Key(key) => {
                let known =
                    MOTION_ARGUMENTS.iter().find(|(in_text, _)| is_motion && key == in_text);
                let key = known.map_or(key.as_str(), |(_, argument)| argument);
                match (depth, name.as_str()) {
                    (0, _) => name.push_str(key),
                    (1, "blend") if is_motion => name = format!("blend_{key}"),
                    (1, "offset") if is_motion => key.clone_into(&mut name),
                    (1, "start") if !is_motion => {
                        name = match key {
                            "joints_deg" => "start_deg".to_owned(),
                            "joints_rad" => "start_rad".to_owned(),
                            _ => format!("start_{key}"),
                        };
                    }
                    _ => {
                        let _ = write!(name, ".{key}");
                    }
                }
            }
        }
    }
    name
}

/// Adds the argument at the byte `at` of `text` to a message, unless the message names it. `text`
/// is a program made from arguments.
pub(crate) fn in_program(message: &str, text: &str, at: usize) -> String {
    let path = path_to(text, at);
    let mut inner = path.as_slice();
    // A motion of a repeat block is several lists deep.
    while let [ArgumentStep::Key(list), ArgumentStep::Index(_), deeper @ ..] = inner
        && list == "motions"
    {
        inner = deeper;
    }
    if inner.len() < path.len() {
        let Some(number) = message.strip_prefix("motion ") else { return message.to_owned() };
        let rest = number.trim_start_matches(|c: char| c.is_ascii_digit());
        let prefix = &message[..message.len() - rest.len()];
        // A source of the motion in parentheses may follow its number.
        let Some((source, rest)) = rest.split_once(": ") else { return message.to_owned() };
        return match named(rest, &argument(inner, true)) {
            Some(name) => format!("{prefix}{source}, {name}: {rest}"),
            None => message.to_owned(),
        };
    }
    match named(message, &argument(&path, false)) {
        Some(name) => format!("{name}: {message}"),
        None => message.to_owned(),
    }
}

/// Adds the path at the byte `at` of `text` to a message; `outer` is the path to the argument
/// `name` in the text.
pub(crate) fn in_argument(
    message: &str,
    text: &str,
    at: usize,
    outer: &[&str],
    name: &str,
) -> String {
    let path = path_to(text, at);
    let is_in = path.len() >= outer.len()
        && outer
            .iter()
            .zip(&path)
            .all(|(key, step)| matches!(step, ArgumentStep::Key(it) if it == key));
    let inner = argument(if is_in { &path[outer.len()..] } else { &[] }, false);
    if inner.is_empty() {
        format!("{name}: {message}")
    } else {
        format!("{name}.{inner}: {message}")
    }
}

/// The argument, if a message does not name it in its first words.
fn named<'a>(message: &str, argument: &'a str) -> Option<&'a str> {
    let last = argument.rsplit(['.', ']']).next().unwrap_or(argument);
    let begins = !last.is_empty() && message.starts_with(last);
    let states_start = message.starts_with("the start pose") && argument.starts_with("start");
    (!argument.is_empty() && argument != "motions" && !begins && !states_start).then_some(argument)
}
