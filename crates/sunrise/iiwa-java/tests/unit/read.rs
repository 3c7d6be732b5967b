//! Tests of the Java reader.

mod bounds;
mod classes;
mod expressions;
mod faults;
mod lines;
mod shown;
mod statements;
mod truncated;

use super::read;
use crate::{
    source_error::SourceError,
    syntax::{CompilationUnit, Expression, Member, Statement},
};

fn unit(text: &str) -> CompilationUnit {
    read("A.java", text).unwrap_or_else(|error| panic!("{error}\n{text:.300}"))
}

fn fault(text: &str) -> SourceError {
    read("A.java", text).err().unwrap_or_else(|| panic!("read: {text:.300}"))
}

/// Returns the statements of a method.
fn body(statements: &str) -> Vec<Statement> {
    let unit = unit(&format!("class A {{ void a() {{\n{statements}\n}} }}"));
    let method = std::sync::Arc::into_inner(unit.classes.into_iter().next().unwrap())
        .and_then(|class| class.methods.into_iter().next())
        .and_then(std::sync::Arc::into_inner);
    method.unwrap().body.unwrap()
}

/// Returns the value of a field.
fn value(expression: &str) -> Expression {
    let unit = unit(&format!("class A {{ Object a = {expression}; }}"));
    let class = std::sync::Arc::into_inner(unit.classes.into_iter().next().unwrap()).unwrap();
    match class.members.into_iter().next().unwrap() {
        Member::Field(field) => field.initial.unwrap(),
        Member::Initializer { .. } => panic!("{expression} is not a field"),
    }
}
