//! What does not keep a rule yet.

use std::collections::BTreeMap;

/// Offenders as `rule: offender`. Remove those that have been mended; add none.
#[rustfmt::skip]
const KNOWN: &[&str] = &[
    "circle: cli/src/args.rs",
    "circle: cli/src/args/compare.rs",
    "circle: cli/src/args/experiment.rs",
    "circle: cli/src/args/identify.rs",
    "circle: cli/src/args/link.rs",
    "circle: cli/src/args/report.rs",
    "circle: cli/src/args/twin.rs",
    "circle: cli/src/commands/plan.rs",
    "circle: cli/src/commands/plan/many.rs",
    "circle: cli/src/commands/plan/programs.rs",
    "circle: cli/src/experiment.rs",
    "circle: cli/src/experiment/blends.rs",
    "circle: cli/src/experiment/chapter.rs",
    "circle: cli/src/experiment/cycle_time.rs",
    "circle: cli/src/experiment/limits.rs",
    "circle: cli/src/experiment/settle.rs",
    "circle: cli/src/experiment/zone_velocity.rs",
    "circle: crates/iiwa-drive/src/cabinet.rs",
    "circle: crates/iiwa-drive/src/cabinet/fri.rs",
    "circle: crates/iiwa-drive/src/cabinet/line.rs",
    "circle: crates/iiwa-drive/src/cabinet/program.rs",
    "circle: crates/iiwa-fri/src/error.rs",
    "circle: crates/iiwa-fri/src/v1.rs",
    "circle: crates/iiwa-fri/src/wire.rs",
    "circle: crates/iiwa-link/src/timed_joints.rs",
    "circle: crates/iiwa-link/src/timed_joints/differences.rs",
    "circle: crates/iiwa-log/src/joint_log.rs",
    "circle: crates/iiwa-log/src/joint_log/columns.rs",
    "circle: crates/iiwa-log/src/joint_log/recording.rs",
    "circle: crates/iiwa-log/src/joint_log/samples.rs",
    "circle: crates/iiwa-log/src/joint_log/table.rs",
    "circle: crates/iiwa-log/src/reader.rs",
    "circle: crates/iiwa-log/src/recording.rs",
    "circle: crates/iiwa-path/src/circle.rs",
    "circle: crates/iiwa-path/src/fault.rs",
    "circle: crates/iiwa-path/src/grid.rs",
    "circle: crates/iiwa-path/src/line.rs",
    "circle: crates/iiwa-path/src/polynomial.rs",
    "circle: crates/iiwa-path/src/program.rs",
    "circle: crates/iiwa-path/src/segment.rs",
    "circle: crates/iiwa-traj/src/audit.rs",
    "circle: crates/iiwa-traj/src/figures.rs",
    "circle: crates/iiwa-traj/src/interval.rs",
    "circle: crates/iiwa-traj/src/section.rs",
    "document: docs/equations.md: iiwa_path::kappa_iiwa",
    "file: benches/src/bin/realtime.rs",
    "file: crates/iiwa-drive/src/drive/wire_tests.rs",
    "file: crates/iiwa-drive/tests/link/bad_input.rs",
    "file: crates/iiwa-fri/src/controller.rs",
    "file: crates/iiwa-link/tests/timed_joints.rs",
    "file: crates/iiwa-log/tests/joint_log.rs",
    "hint: crates/iiwa-drive/src/cabinet/fri.rs",
    "hint: crates/iiwa-drive/src/drive.rs",
    "hint: crates/iiwa-eval/src/compare/plan.rs",
    "hint: crates/iiwa-link/src/client.rs",
    "hint: crates/iiwa-link/src/security/error.rs",
    "link: docs/equations.md: ../crates/iiwa-link/src/cabinet.rs",
    "link: docs/equations.md: ../crates/iiwa-link/src/drive.rs",
    "link: docs/equations.md: ../crates/iiwa-link/src/fri.rs",
    "link: docs/equations.md: ../crates/iiwa-link/src/robot_program.rs",
    "size: cli/src",
    "size: crates/iiwa-drive/src",
    "type: iiwa-drive: Asked",
    "type: iiwa-drive: Braking",
    "type: iiwa-drive: Done",
    "type: iiwa-drive: Input",
    "type: iiwa-drive: Outcome",
    "type: iiwa-drive: Task",
    "type: iiwa-drive: Waiting",
    "type: iiwa-eval: Curve",
    "type: iiwa-eval: CycleTime",
    "type: iiwa-eval: Followed",
    "type: iiwa-eval: Line",
    "type: iiwa-log: Content",
    "type: iiwa-log: Motion",
    "type: iiwa-traj: Curve",
    "type: iiwa-traj: Leg",
    "type: iiwa-traj: Plan",
    "type: iiwa-traj: Sample",
    "type: iiwa-traj: Side",
    "type: iiwa-traj: State",
    "type: iiwasim-benches: Row",
    "type: iiwasim-benches: Samples",
    "type: iiwasim: Answer",
    "type: iiwasim: Arm",
    "type: iiwasim: Blend",
    "type: iiwasim: BlendRow",
    "type: iiwasim: Corner",
    "type: iiwasim: ForPage",
    "type: iiwasim: Io",
    "type: iiwasim: Kind",
    "type: iiwasim: MotionRow",
    "type: iiwasim: Outcome",
    "type: iiwasim: Planned",
    "type: iiwasim: Report",
    "type: iiwasim: Run",
    "type: iiwasim: Sample",
    "type: iiwasim: Source",
    "type: iiwasim: State",
    "type: iiwasim: Twin",
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
