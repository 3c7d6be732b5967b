//! How a broken rule is reported.

use std::collections::BTreeMap;

/// Fails with `remedy` when there are offenders. They map to what is wrong with each.
pub(crate) fn forbid(rule: &str, offenders: &BTreeMap<String, String>, remedy: &str) {
    let list: Vec<String> = offenders
        .iter()
        .map(|(offender, what)| format!("{rule}: {offender}\n    {what}"))
        .collect();
    assert!(list.is_empty(), "{}\n{remedy}", list.join("\n"));
}
