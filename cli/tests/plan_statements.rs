//! Statements about a plan in the table, in JSON and in the page of `iiwasim report`.

use std::fs;

use predicates::str::contains;
use tempfile::tempdir;

use crate::report::{data, page};
use crate::run::iiwasim;

/// The page contains operating mode, override and warnings of the plan.
#[test]
fn mode_override_and_warnings_are_in_the_page() {
    let folder = tempdir().unwrap();
    let text = r#"{ "version": 1, "mode": "t1",
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [
            { "type": "lin_rel", "offset": { "z_mm": -40 }, "blend": { "cart_mm": 50 } },
            { "type": "lin_rel", "offset": { "y_mm": 150 } }
        ] }"#;
    fs::write(folder.path().join("slowly.json"), text).unwrap();
    let arguments = ["plan", "slowly.json", "--override", "30", "-o", "plan.mcap"];
    let shortened = "its blend of 50 mm is shortened to 20.0 mm";
    let mode = "Operating mode T1: TCP and flange are limited to 225 mm/s";
    iiwasim(&folder, &arguments).success().stdout(contains(mode)).stderr(contains(shortened));
    let figures = &data(&page(&folder, &["plan.mcap"]))["figures"];
    assert_eq!((&figures["mode"], &figures["override_percent"]), (&"t1".into(), &30.0.into()));
    assert!(figures["warnings"][0].as_str().unwrap().contains(shortened), "{figures}");
    assert_eq!(figures["blends"][0]["shortened"]["half_of_motion"], 1);
}
