//! What does not keep a rule yet.

use std::collections::BTreeMap;

/// Offenders as `rule: offender`. Remove those that have been mended; add none.
#[rustfmt::skip]
const KNOWN: &[&str] = &[
    "circle: crates/iiwa-log/src/joint_log.rs",
    "circle: crates/iiwa-log/src/joint_log/columns.rs",
    "circle: crates/iiwa-log/src/joint_log/recording.rs",
    "circle: crates/iiwa-log/src/joint_log/samples.rs",
    "circle: crates/iiwa-log/src/joint_log/table.rs",
    "circle: crates/iiwa-log/src/reader.rs",
    "circle: crates/iiwa-log/src/recording.rs",
    "file: benches/src/bin/realtime.rs",
    "file: crates/iiwa-log/tests/joint_log.rs",
    "size: crates/iiwa-drive/src",
    "type: iiwasim-benches: Row",
    "type: iiwasim-benches: Samples",
];

/// Fails with `remedy` when there are offenders that are not in [`KNOWN`], or known ones that keep the rule by now.
/// Offenders map to what is wrong with each.
pub(crate) fn hold(rule: &str, offenders: &BTreeMap<String, String>, remedy: &str) {
    let known: Vec<&str> =
        KNOWN.iter().filter_map(|entry| entry.strip_prefix(rule)?.strip_prefix(": ")).collect();
    let mut complaints: Vec<String> = offenders
        .iter()
        .filter(|(offender, _)| !known.contains(&offender.as_str()))
        .map(|(offender, what)| format!("\"{rule}: {offender}\",\n    {what}"))
        .collect();
    if !complaints.is_empty() {
        complaints.push(remedy.to_owned());
    }
    let mended: Vec<String> = known
        .iter()
        .filter(|offender| !offenders.contains_key(**offender))
        .map(|offender| format!("\"{rule}: {offender}\","))
        .collect();
    if !mended.is_empty() {
        complaints.push("These keep the rule now; remove them from KNOWN in known.rs:".to_owned());
        complaints.extend(mended);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
