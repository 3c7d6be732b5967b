//! Java type names: primitive types, and boxed types.

use crate::{
    classes::simple,
    syntax::{Literal, TypeName},
    value::Value,
};

/// Type of `null`.
pub(crate) const NULL: &str = "null";

/// Primitive number types, each widened to those after it, except that no type widens to `char`.
pub(crate) const WIDENING: [&str; 7] = ["byte", "short", "char", "int", "long", "float", "double"];

/// Creates a type without dimensions.
pub(crate) fn plain(name: &str) -> TypeName {
    TypeName::new(name, 0)
}

pub(crate) fn of_literal(literal: &Literal) -> TypeName {
    plain(match literal {
        Literal::Null => NULL,
        Literal::Boolean(_) => "boolean",
        Literal::Char(_) => "char",
        Literal::Int(_) => "int",
        Literal::Long(_) => "long",
        Literal::Float(_) => "float",
        Literal::Double(_) => "double",
        Literal::String(_) => "String",
    })
}

pub(crate) fn is_text(type_name: &TypeName) -> bool {
    type_name.dimensions == 0 && simple(&type_name.name) == "String"
}

pub(crate) fn is_primitive(type_name: &TypeName) -> bool {
    type_name.dimensions == 0 && (type_name.name == "boolean" || rank(&type_name.name).is_some())
}

pub(crate) fn rank(name: &str) -> Option<usize> {
    WIDENING.iter().position(|primitive| *primitive == name)
}

pub(crate) fn widens_to(from: &str, to: &str) -> bool {
    match (rank(from), rank(to)) {
        (Some(from), Some(to)) => from == to || (from < to && to != 2 && !(from == 2 && to < 3)),
        _ => from == to,
    }
}

const BOXES: [(&str, &str); 8] = [
    ("Byte", "byte"),
    ("Short", "short"),
    ("Character", "char"),
    ("Integer", "int"),
    ("Long", "long"),
    ("Float", "float"),
    ("Double", "double"),
    ("Boolean", "boolean"),
];

pub(crate) fn boxed_names() -> impl Iterator<Item = &'static str> {
    BOXES.iter().map(|(boxed, _)| *boxed)
}

pub(crate) fn boxed(name: &str) -> Option<&'static str> {
    BOXES.iter().find(|(_, primitive)| *primitive == name).map(|(boxed, _)| *boxed)
}

/// Returns the primitive type of a primitive or boxed type.
pub(crate) fn unboxed(type_name: &TypeName) -> Option<&'static str> {
    let name = simple(&type_name.name);
    let boxing = BOXES.iter().find(|(boxed, primitive)| *boxed == name || *primitive == name);
    boxing.map(|(_, primitive)| *primitive).filter(|_| type_name.dimensions == 0)
}

/// Returns true if equal values are boxed to the same object: integers from -128 to 127, and
/// booleans.
pub(crate) fn is_cached(value: &Value) -> bool {
    match value {
        Value::Boolean(_) => true,
        Value::Char(_) | Value::Int(_) | Value::Long(_) => {
            value.integer().is_some_and(|number| (-128..=127).contains(&number))
        }
        _ => false,
    }
}
