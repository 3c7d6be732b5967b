//! Report of broken rules.

use std::collections::BTreeMap;

/// Fails with `remedy` if there are offenders, which map to descriptions of the violations.
pub(crate) fn forbid(rule: &str, offenders: &BTreeMap<String, String>, remedy: &str) {
    let list: Vec<String> = offenders
        .iter()
        .map(|(offender, description)| format!("{rule}: {offender}\n    {description}"))
        .collect();
    assert!(list.is_empty(), "{}\n{remedy}", list.join("\n"));
}
