//! Test that the common steps of all front ends have one implementation: reading a program with its
//! files, choosing its robot, planning, warnings.

use std::collections::BTreeMap;

use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{files, root, shown, text};

/// Calls, and the folders that may contain them.
const CALLS: [(&str, &[&str]); 6] = [
    // Searches for faster programs plan single sections of changed paths.
    (
        "Planner::new(",
        &["crates/core/iiwa-traj", "crates/core/iiwa-plan", "crates/analysis/iiwa-optimise"],
    ),
    ("Program::from_json_with(", &["crates/core/iiwa-program", "crates/core/iiwa-plan"]),
    ("Program::merged_json(", &["crates/core/iiwa-program", "crates/core/iiwa-plan"]),
    (
        "JointPath::on_other_robot(",
        &[
            "crates/core/iiwa-path",
            "crates/core/iiwa-plan",
            "crates/analysis/iiwa-eval",
            "crates/analysis/iiwa-optimise",
        ],
    ),
    (".torque_warnings()", &["crates/core/iiwa-plan"]),
    ("TurnContradiction::all(", &["crates/core/iiwa-path", "crates/core/iiwa-plan"]),
];

#[test]
fn front_ends_plan_by_requests() {
    let mut wrong = BTreeMap::new();
    for folder in ["crates", "cli/src", "python/src"] {
        for file in files(&root().join(folder), &["rs"]) {
            let name = shown(&file);
            if name.contains("/tests/") {
                continue;
            }
            let code: String =
                text(&file).lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            for (call, allowed) in CALLS {
                if code.contains(call) && !allowed.iter().any(|folder| name.starts_with(folder)) {
                    wrong.insert(format!("{name}: {call}"), allowed.join(", "));
                }
            }
        }
    }
    forbid("use case", &wrong, "Ask iiwa-plan for it: ProgramSource, PlanRequest, Planning.");
}
