//! Java of robot programs, read and evaluated without the robot.
//!
//! [`read()`] parses a source file into a [`CompilationUnit`], [`Classes`] resolve the names of a
//! project's classes, and a [`Machine`] evaluates them: fields, locals, methods, inheritance,
//! arrays, collections, loops, exceptions. A value unknown before run time, such as the time of
//! day, is an unknown [`Value`] with a reason; it is an error only if the program's actions depend
//! on it. Classes outside the project and the Java library belong to a [`Host`], which also defines
//! the actions. Steps, depth and memory are bounded.
//!
//! Threads and reflection are not evaluated.

mod calls;
mod class_id;
mod classes;
mod combined;
mod construction;
mod conversion;
mod effect_search;
mod effects;
mod expressions;
mod flow;
mod foreign;
mod formats;
mod function;
mod functions;
mod host_value;
mod interfaces;
mod java_collections;
mod java_collectors;
mod java_functions;
mod java_lists;
mod java_maps;
mod java_math;
mod java_sorting;
mod java_state;
mod java_streams;
mod java_strings;
mod java_unknown;
mod library_calls;
mod loops;
mod machine;
mod operators;
mod overloads;
mod patterns;
mod place;
mod read;
#[cfg(test)]
#[path = "../tests/unit/snippets.rs"]
mod snippets;
mod source_error;
mod source_text;
mod statements;
mod static_types;
mod stop;
mod stream;
mod switches;
mod syntax;
mod tasks;
mod text;
mod type_arguments;
mod type_names;
mod unknown;
mod value;
mod variables;
mod waiting_loops;

pub use class_id::ClassId;
pub use classes::{ClassName, Classes};
pub use host_value::HostValue;
pub use machine::{Host, HostCounts, Machine, Note};
pub use place::SourceLine;
pub use read::read;
pub use source_error::{SourceError, SourceFault};
pub use source_text::decode;
pub use stop::{EvaluationStop, JavaRefusal};
pub use syntax::CompilationUnit;
pub use tasks::TaskEffects;
pub use unknown::Unknown;
pub use value::{
    Array, Collector, Function, Iteration, JavaObject, JavaStream, List, Map, MapOrder, Thrown,
    Value,
};
