//! Keys of motions in all languages. The types that read programs are also those of the JSON
//! Schema, so that the schema lists every key that the Rust code reads. These tests compare the
//! schema with the motions of the Python package, with the sources of the Java robot program, and
//! with the conformance cases that every robot program has to pass: a new key has to be added there
//! as well.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use iiwa_program::Program;
use iiwasim_tests::conformance;
use serde_json::{Map, Value, json};

/// Name of a definition in the schema, and one of its keys.
type Key = (String, String);

/// Keys of programs that lists of motions lack.
const OF_PROGRAMS: [&str; 9] = [
    "$schema",
    "version",
    "robot",
    "flange_mm",
    "include",
    "start",
    "limit_torque_percent",
    "override_percent",
    "tasks",
];

/// Keys without effect on a motion.
const NOTES: [&str; 4] = ["source", "name", "comment", "group"];

/// Definitions of inputs and outputs, which the drive refuses in lists of motions.
const IO: [&str; 2] = ["Set", "WaitFor"];

/// Keys that robot programs need not read: the drive removes notes and shapes of loads, completes
/// auxiliary positions to frames, writes out repeat blocks and refuses inputs and outputs; a robot
/// program refuses waits during which the robot moves.
fn is_unread(key: &Key) -> bool {
    let (definition, key) = (key.0.as_str(), key.1.as_str());
    ["Source", "Point", "Repeat", "Shape", "ShapeType"].contains(&definition)
        || IO.contains(&definition)
        || NOTES.contains(&key)
        || [("Wait", "overlap_motions"), ("Load", "shapes")].contains(&(definition, key))
}

/// The schema of programs, restricted to the keys of a list of motions.
struct Schema {
    root: Value,
    definitions: Map<String, Value>,
}

impl Schema {
    fn of_motion_lists() -> Self {
        let schema = Program::schema();
        let mut properties = schema["properties"].as_object().unwrap().clone();
        for key in OF_PROGRAMS {
            assert!(properties.remove(key).is_some(), "programs have no key {key}");
        }
        let definitions = schema["$defs"].as_object().unwrap().clone();
        Self { root: json!({ "properties": properties }), definitions }
    }

    /// The schema that a reference names, with its name; any other schema with the name `owner`.
    fn resolved<'a>(&'a self, schema: &'a Value, owner: &'a str) -> (&'a str, &'a Value) {
        match schema["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/")) {
            Some(name) => (name, &self.definitions[name]),
            None => (owner, schema),
        }
    }

    /// Alternatives of a schema.
    fn options(schema: &Value) -> impl Iterator<Item = &Value> {
        let lists = ["anyOf", "oneOf"].into_iter().filter_map(|key| schema[key].as_array());
        lists.flatten()
    }

    /// Definitions of the motion types, by the names of the types.
    fn motions(&self) -> BTreeMap<String, &str> {
        let options = Self::options(&self.definitions["Motion"]);
        let motions = options.map(|option| {
            let (definition, schema) = self.resolved(option, "");
            (schema["properties"]["type"]["enum"][0].as_str().unwrap().to_owned(), definition)
        });
        motions.collect()
    }

    /// Keys of a definition.
    fn keys(&self, definition: &str) -> BTreeSet<&str> {
        let schema = &self.definitions[definition];
        let owners = Self::options(schema).chain([schema]);
        owners
            .filter_map(|owner| owner["properties"].as_object())
            .flat_map(Map::keys)
            .map(String::as_str)
            .collect()
    }

    /// All keys of a list of motions.
    fn all_keys(&self) -> BTreeSet<Key> {
        let mut keys = BTreeSet::new();
        self.add_all(&self.root, "Program", &mut BTreeSet::new(), &mut keys);
        keys
    }

    fn add_all<'a>(
        &'a self,
        schema: &'a Value,
        owner: &'a str,
        done: &mut BTreeSet<&'a str>,
        keys: &mut BTreeSet<Key>,
    ) {
        let (name, schema) = self.resolved(schema, owner);
        if name != owner && !done.insert(name) {
            return;
        }
        for (key, value) in schema["properties"].as_object().into_iter().flatten() {
            // `false` excludes a key in one of several alternatives.
            if *value != false {
                keys.insert((name.to_owned(), key.clone()));
                self.add_all(value, name, done, keys);
            }
        }
        let nested = [&schema["additionalProperties"], &schema["items"]];
        for part in Self::options(schema).chain(nested).filter(|part| part.is_object()) {
            self.add_all(part, name, done, keys);
        }
    }

    /// Adds the keys of a value.
    fn add_used(&self, schema: &Value, owner: &str, value: &Value, keys: &mut BTreeSet<Key>) {
        let (name, schema) = self.resolved(schema, owner);
        for option in Self::options(schema).filter(|option| self.fits(option, value)) {
            self.add_used(option, name, value, keys);
        }
        for (key, value) in value.as_object().into_iter().flatten() {
            let property = &schema["properties"][key];
            if property.is_object() {
                keys.insert((name.to_owned(), key.clone()));
                self.add_used(property, name, value, keys);
            } else {
                self.add_used(&schema["additionalProperties"], name, value, keys);
            }
        }
        for element in value.as_array().into_iter().flatten() {
            self.add_used(&schema["items"], name, element, keys);
        }
    }

    /// Returns true if an alternative has all keys of a value, with the value's type of motion.
    fn fits(&self, option: &Value, value: &Value) -> bool {
        let (_, schema) = self.resolved(option, "");
        let Some(object) = value.as_object() else { return true };
        let has_all = object.iter().all(|(key, value)| {
            let property = &schema["properties"][key];
            let known = property["enum"].as_array();
            property.is_object() && known.is_none_or(|known| known.contains(value))
        });
        has_all || Self::options(schema).any(|option| self.fits(option, value))
    }
}

#[test]
fn conformance_cases_use_every_key_that_a_robot_program_reads() {
    let schema = Schema::of_motion_lists();
    let text = fs::read_to_string(conformance::folder().join("motions.jsonl")).unwrap();
    let mut used = BTreeSet::new();
    for line in text.lines() {
        let case: Value = serde_json::from_str(line).unwrap();
        let sent = case["steps"].as_array().unwrap().iter().map(|step| &step["send"]);
        for instruction in sent.filter(|sent| sent["type"] == "run_motions") {
            let mut list = instruction.clone();
            list.as_object_mut()
                .unwrap()
                .retain(|key, _| !["seq", "type", "run"].contains(&&**key));
            schema.add_used(&schema.root, "Program", &list, &mut used);
        }
    }
    let all = schema.all_keys();
    assert!(all.len() > 150, "{}", all.len());
    let unused: Vec<_> = all.difference(&used).filter(|key| !is_unread(key)).collect();
    assert!(
        unused.is_empty(),
        "no case of sunrise/conformance/motions.jsonl has the keys {unused:?}; add one, and read \
         the keys in sunrise/src/main/java"
    );
}

/// String literals of some Java sources.
fn java_literals(files: &[&str]) -> BTreeSet<String> {
    let folder = conformance::folder().join("../src/main/java/iiwasim/program");
    let texts = files.iter().map(|file| fs::read_to_string(folder.join(file)).unwrap());
    texts
        .flat_map(|text| text.split('"').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>())
        .collect()
}

#[test]
fn the_java_robot_program_reads_every_key() {
    let schema = Schema::of_motion_lists();
    let literals =
        java_literals(&["MotionReader.java", "Workcell.java", "Limits.java", "Blend.java"]);
    // Keys such as `a_deg` are composed of axis and unit.
    let is_read = |key: &str| {
        let composed = key.rsplit_once('_').is_some_and(|(axis, unit)| {
            literals.contains(axis) && literals.contains(&format!("_{unit}"))
        });
        composed || literals.contains(key)
    };
    let unread: Vec<_> =
        schema.all_keys().into_iter().filter(|key| !is_unread(key) && !is_read(&key.1)).collect();
    assert!(unread.is_empty(), "the Java robot program does not read {unread:?}");
    let motions = schema.motions();
    let unknown: Vec<_> = motions
        .iter()
        .filter(|(name, definition)| !literals.contains(*name) && !IO.contains(definition))
        .collect();
    assert!(unknown.is_empty(), "the Java robot program does not know the motions {unknown:?}");
}

/// Functions of the Python module of motions, by their names.
fn python_functions() -> BTreeMap<&'static str, &'static str> {
    let text = include_str!("../../python/iiwasim/motions.py");
    let functions = text.split("\ndef ").skip(1);
    functions.filter_map(|function| Some((function.split_once('(')?.0, function))).collect()
}

#[test]
fn the_python_functions_write_every_key_of_motions() {
    let schema = Schema::of_motion_lists();
    let functions = python_functions();
    for (name, definition) in schema.motions() {
        // A spline of one segment: Python writes it as `spline`.
        if name == "spl" {
            continue;
        }
        // `set` is a type of Python.
        let called = if name == "set" { "set_io" } else { name.as_str() };
        let function = functions.get(called);
        let function = function.unwrap_or_else(|| panic!("motions.py has no function {name}"));
        let is_argument = |key: &str| {
            let argument = format!("{key}=");
            let ends_in_word =
                |text: &str| text.ends_with(|c: char| c.is_alphanumeric() || c == '_');
            let mut places = function.match_indices(&argument);
            places.any(|(at, _)| !ends_in_word(&function[..at]))
                || function.contains(&format!("\"{key}\""))
        };
        let mut keys = schema.keys(definition);
        // Sources are those of generated programs.
        keys.retain(|key| !["type", "source"].contains(key));
        for key in &keys {
            // Further keyword arguments become keys, except the blend.
            let is_passed_on = function.contains("**limits") && *key != "blend";
            assert!(is_passed_on || is_argument(key), "{name} in motions.py does not write {key}");
        }
        for key in function.lines().filter_map(|line| line.strip_prefix("        ")) {
            let Some((key, _)) = key.split_once('=') else { continue };
            let is_key =
                key.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
            assert!(!is_key || keys.contains(key), "{name} in motions.py writes {key}");
        }
        let blend = if name == "ptp" { "Blend" } else { "PathBlend" };
        for size in schema.keys(blend).iter().filter(|_| keys.contains("blend")) {
            let is_given = function.contains(&format!("    blend_{size}:"));
            assert!(is_given, "{name} in motions.py has no argument blend_{size}");
        }
    }
    let load = functions["load"];
    for key in schema.keys("Load") {
        assert!(load.contains(&format!("\"{key}\"")), "load in motions.py does not write {key}");
    }
}
