//! The JSON Schemas against documents that the readers take and refuse, by the crate
//! `jsonschema`. What the readers do with them is tested in their crates.

mod messages;
mod motions;
mod programs;
mod scenes;

use jsonschema::Validator;
use serde_json::Value;

/// A schema that can be validated against.
fn validator(schema: &Value) -> Validator {
    jsonschema::validator_for(schema).unwrap()
}

/// Panics with everything that is wrong with a value.
fn assert_fits(schema: &Validator, value: &Value) {
    let errors: Vec<_> = schema.iter_errors(value).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{value}: {errors:?}");
}
