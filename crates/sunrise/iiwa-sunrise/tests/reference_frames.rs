//! Reference frames of offsets in exported programs.

use crate::export::{export, java, read_with};

/// An offset in the orientation of a base, and of the robot base.
#[test]
fn offsets_in_bases_have_the_frame_of_the_base() {
    let lin_rel = |within: &str| {
        format!(r#"{{ "type": "lin_rel", "offset": {{ "x_mm": 5 }}, "in": "{within}" }}"#)
    };
    let cell = r#""bases": { "table": { "a_deg": 90 }, "tray": { "base": "table", "z_mm": 5 } },"#;
    let program = read_with(cell, &[lin_rel("tray"), lin_rel("robot")].join(","));
    assert_eq!(
        java(&program),
        "lbr.move(linRel(5.0, 0.0, 0.0, getApplicationData().getFrame(\"/table/tray\"))); \
         lbr.move(linRel(5.0, 0.0, 0.0, World.Current.getRootFrame()));"
    );
    let import = "import com.kuka.roboticsAPI.geometricModel.World;";
    assert!(export(&program).java.contains(import));
}
