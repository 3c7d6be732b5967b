//! Well-formed JSON with invalid or unreachable motions.

/// Returns the fault, the words of which the message contains at least one, and the keys of the
/// list of motions.
pub(crate) fn invalid_motions() -> Vec<(&'static str, &'static [&'static str], String)> {
    MOTIONS
        .iter()
        .map(|(fault, words, motions)| (*fault, *words, format!("\"motions\": [{motions}]")))
        .chain(LISTS.iter().map(|(fault, words, keys)| (*fault, *words, (*keys).to_owned())))
        .map(|(fault, words, keys)| {
            let fill = |keys: String, &(name, text): &(&str, &str)| keys.replace(name, text);
            (fault, words, PLACEHOLDERS.iter().fold(keys, fill))
        })
        .collect()
}

type Invalid = (&'static str, &'static [&'static str], &'static str);

/// Texts for the placeholders of the motions, inserted in this order.
const PLACEHOLDERS: &[(&str, &str)] = &[
    ("@ptp", r#"{"type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0]}"#),
    ("@zero", r#""type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0]"#),
    ("@circ", r#""type": "circ", "aux": {@aux}, "frame": {@end}"#),
    ("@aux", r#""x_mm": 550, "y_mm": 50, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0"#),
    ("@end", r#""x_mm": 600, "y_mm": 0, "z_mm": 350, "a_deg": 0, "b_deg": 180, "c_deg": 0"#),
    // A frame within reach.
    ("@frame", "{@pose}"),
    ("@pose", r#""x_mm": 600, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0"#),
];

/// Invalid motions, with placeholders.
const MOTIONS: &[Invalid] = &[
    ("no motions", &["motion"], ""),
    ("an unknown type", &["fly", "motion 1"], r#"{"type": "fly"}"#),
    (
        "a type in capitals",
        &["PTP", "motion 1"],
        r#"{"type": "PTP", "joints_deg": [0, 0, 0, 0, 0, 0, 0]}"#,
    ),
    ("the second motion is wrong", &["motion 2"], r#"@ptp, {"type": "fly"}"#),
    (
        "six joints",
        &["joints_deg", "motion 1"],
        r#"{"type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "eight joints",
        &["joints_rad", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "joints as an object",
        &["joints_rad", "motion 1"],
        r#"{"type": "ptp", "joints_rad": {"a1": 0}}"#,
    ),
    (
        "joints twice",
        &["joints_rad", "motion 1"],
        r#"{@zero, "joints_deg": [0, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "joints and a frame",
        &["frame", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "frame": @frame}"#,
    ),
    ("no target", &["joints_deg", "motion 1"], r#"{"type": "ptp"}"#),
    (
        "a joint that is too large for a number",
        &["large", "column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [1e999, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint that is NaN",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [NaN, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint that is Infinity",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [Infinity, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint with a plus",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [+1, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint with a leading zero",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [01, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint without a digit before the point",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [.1, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a joint without a digit after the point",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [1., 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a hexadecimal joint",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0x1, 0, 0, 0, 0, 0, 0]}"#,
    ),
    (
        "a comma too many",
        &["column", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0,]}"#,
    ),
    (
        "a comma too few",
        &["column", "motion 1"],
        r#"{"type": "ptp" "joints_rad": [0, 0, 0, 0, 0, 0, 0]}"#,
    ),
    ("single quotes", &["column", "motion 1"], "{'type': 'ptp'}"),
    ("a comment", &["column", "motion 1"], "/* home */ @ptp"),
    (
        "a velocity of zero",
        &["velocity_rel"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "velocity_rel": 0}"#,
    ),
    (
        "a velocity above one",
        &["velocity_rel"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "velocity_rel": 1.01}"#,
    ),
    (
        "a velocity next to nothing",
        &["velocity_rel"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "velocity_rel": 1e-9}"#,
    ),
    (
        "six velocities",
        &["velocity_rel", "motion 1"],
        r#"{@zero, "velocity_rel": [1, 1, 1, 1, 1, 1]}"#,
    ),
    (
        "one of seven accelerations is zero",
        &["acceleration_rel"],
        r#"{@zero, "acceleration_rel": [1, 1, 1, 0, 1, 1, 1]}"#,
    ),
    (
        "a jerk above one",
        &["jerk_rel"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "jerk_rel": 2}"#,
    ),
    (
        "a velocity of the TCP on a ptp",
        &["cart_velocity_mm_s", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "cart_velocity_mm_s": 100}"#,
    ),
    (
        "an orientation on a ptp",
        &["orientation", "motion 1"],
        r#"{"type": "ptp", "frame": @frame, "orientation": "constant"}"#,
    ),
    (
        "a blend of two sizes",
        &["blend", "fraction", "motion 1"],
        r#"{@zero, "blend": {"fraction": 0.1, "cart_mm": 5}}"#,
    ),
    (
        "a blend of no size",
        &["blend", "fraction", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {}}"#,
    ),
    (
        "a blend without a value",
        &["blend", "fraction", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"fraction": null}}"#,
    ),
    (
        "a blend of more than half",
        &["blend", "fraction"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"fraction": 0.51}}"#,
    ),
    (
        "a negative blend",
        &["blend", "fraction"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"fraction": -0.1}}"#,
    ),
    (
        "a negative radius",
        &["blend", "cart_mm"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"cart_mm": -1}}"#,
    ),
    (
        "setBlendingRel above one",
        &["blend", "sunrise_rel"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"sunrise_rel": 1.5}}"#,
    ),
    (
        "an orientation in a blend of a ptp",
        &["blend", "ori_deg", "motion 1"],
        r#"{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0], "blend": {"ori_deg": 5}}"#,
    ),
    (
        "a blend before a wait",
        &["wait", "blend"],
        r#"{@zero, "blend": {"fraction": 0.5}}, {"type": "wait", "seconds": 1}"#,
    ),
    (
        "a blend before a change of the load",
        &["load", "blend"],
        r#"{@zero, "blend": {"fraction": 0.5}}, {"type": "load", "load": null}"#,
    ),
    (
        "a load with a target",
        &["frame", "motion 1"],
        r#"{"type": "load", "load": null, "frame": @frame}"#,
    ),
    ("a negative wait", &["wait", "seconds"], r#"{"type": "wait", "seconds": -1}"#),
    ("a wait of two days", &["wait", "seconds"], r#"{"type": "wait", "seconds": 172800}"#),
    (
        "a wait with a target",
        &["frame", "motion 1"],
        r#"{"type": "wait", "seconds": 1, "frame": @frame}"#,
    ),
    ("lin without a frame", &["frame", "motion 1"], r#"{"type": "lin"}"#),
    (
        "lin to joints",
        &["joints_deg", "motion 1"],
        r#"{"type": "lin", "joints_deg": [0, 30, 0, -60, 0, 90, 0]}"#,
    ),
    (
        "lin to a list",
        &["frame", "motion 1"],
        r#"{"type": "lin", "frame": [600, 0, 400, 0, 180, 0]}"#,
    ),
    (
        "lin with a fraction",
        &["fraction", "motion 1"],
        r#"{"type": "lin", "frame": @frame, "blend": {"fraction": 0.25}}"#,
    ),
    (
        "lin with an aux frame",
        &["aux", "motion 1"],
        r#"{"type": "lin", "frame": @frame, "aux": @frame}"#,
    ),
    (
        "lin with an ignored orientation",
        &["ignore", "orientation"],
        r#"{"type": "lin", "frame": @frame, "orientation": "ignore"}"#,
    ),
    (
        "an unknown orientation",
        &["orientation", "motion 1"],
        r#"{"type": "lin", "frame": @frame, "orientation": "fixed"}"#,
    ),
    (
        "a speed of zero",
        &["cart_velocity_mm_s"],
        r#"{"type": "lin", "frame": @frame, "cart_velocity_mm_s": 0}"#,
    ),
    (
        "an acceleration of next to nothing",
        &["cart_acceleration_mm_s2"],
        r#"{"type": "lin", "frame": @frame, "cart_acceleration_mm_s2": 0.5}"#,
    ),
    (
        "a jerk of zero",
        &["cart_jerk_mm_s3"],
        r#"{"type": "lin", "frame": @frame, "cart_jerk_mm_s3": 0}"#,
    ),
    (
        "a turn of zero",
        &["orientation_velocity_deg_s"],
        r#"{"type": "lin", "frame": @frame, "orientation_velocity_deg_s": 0}"#,
    ),
    (
        "an acceleration of the turn of next to nothing",
        &["orientation_acceleration_deg_s2"],
        r#"{"type": "lin", "frame": @frame, "orientation_acceleration_deg_s2": 0.01}"#,
    ),
    (
        "a jerk of the turn of zero",
        &["orientation_jerk_deg_s3"],
        r#"{"type": "lin", "frame": @frame, "orientation_jerk_deg_s3": 0}"#,
    ),
    (
        "a negative angle in a blend",
        &["ori_deg", "blend"],
        r#"{"type": "lin", "frame": @frame, "blend": {"ori_deg": -1}}"#,
    ),
    (
        "an angle twice",
        &["a_deg", "a_rad", "motion 1"],
        r#"{"type": "lin", "frame": {@pose, "a_rad": 0}}"#,
    ),
    (
        "E1 twice",
        &["e1_deg", "e1_rad", "motion 1"],
        r#"{"type": "lin", "frame": {@pose, "e1_deg": 0, "e1_rad": 0}}"#,
    ),
    ("a status of 8", &["status", "motion 1"], r#"{"type": "lin", "frame": {@pose, "status": 8}}"#),
    (
        "a status of 2.5",
        &["status", "motion 1"],
        r#"{"type": "lin", "frame": {@pose, "status": 2.5}}"#,
    ),
    ("a turn of 128", &["turn", "motion 1"], r#"{"type": "lin", "frame": {@pose, "turn": 128}}"#),
    ("a turn of -1", &["turn", "motion 1"], r#"{"type": "lin", "frame": {@pose, "turn": -1}}"#),
    ("lin_rel without an offset", &["offset", "motion 1"], r#"{"type": "lin_rel"}"#),
    (
        "lin_rel with a frame",
        &["frame", "motion 1"],
        r#"{"type": "lin_rel", "offset": {"z_mm": 10}, "frame": @frame}"#,
    ),
    (
        "an angle of an offset twice",
        &["b_deg", "b_rad", "motion 1"],
        r#"{"type": "lin_rel", "offset": {"b_deg": 10, "b_rad": 0.1}}"#,
    ),
    (
        "an offset with a status",
        &["status", "motion 1"],
        r#"{"type": "lin_rel", "offset": {"z_mm": 10, "status": 2}}"#,
    ),
    ("an offset by a name", &["offset", "motion 1"], r#"{"type": "lin_rel", "offset": "pick"}"#),
    ("circ without an aux frame", &["aux", "motion 1"], r#"{"type": "circ", "frame": @frame}"#),
    ("circ without a frame", &["frame", "motion 1"], r#"{"type": "circ", "aux": @frame}"#),
    (
        "an unknown reference",
        &["orientation_reference", "motion 1"],
        r#"{"type": "circ", "aux": @frame, "frame": @frame, "orientation_reference": "tool"}"#,
    ),
    (
        "an unknown end",
        &["end_orientation", "motion 1"],
        r#"{"type": "circ", "aux": @frame, "frame": @frame, "end_orientation": "ignore"}"#,
    ),
    (
        "an unknown aux orientation",
        &["aux_orientation", "motion 1"],
        r#"{"type": "circ", "aux": @frame, "frame": @frame, "aux_orientation": "extrapolate"}"#,
    ),
    (
        "spl with segments",
        &["segments", "motion 1"],
        r#"{"type": "spl", "frame": @frame, "segments": []}"#,
    ),
    (
        "spl with ori_joint",
        &["ori_joint", "orientation"],
        r#"{"type": "spl", "frame": @frame, "orientation": "ori_joint"}"#,
    ),
    ("a spline without segments", &["segments", "motion 1"], r#"{"type": "spline"}"#),
    ("a spline of no segment", &["segments"], r#"{"type": "spline", "segments": []}"#),
    ("a spline of 21 segments", &["segments"], r#"{"type": "spline", "segments": [@21]}"#),
    (
        "a spline with a frame",
        &["frame", "motion 1"],
        r#"{"type": "spline", "segments": [{"type": "spl", "frame": @frame}], "frame": @frame}"#,
    ),
    (
        "a spline with ori_joint",
        &["ori_joint", "orientation"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame}], "orientation": "ori_joint"}"#,
    ),
    (
        "a segment with ori_joint",
        &["ori_joint", "orientation"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame, "orientation": "ori_joint"}]}"#,
    ),
    (
        "a segment of an unknown type",
        &["segment", "type", "motion 1"],
        r#"{"type": "spline", "segments": [{"type": "ptp", "frame": @frame}]}"#,
    ),
    (
        "a segment without a frame",
        &["frame", "motion 1"],
        r#"{"type": "spline", "segments": [{"type": "spl"}]}"#,
    ),
    (
        "a segment with a blend",
        &["blend", "segment"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame, "blend": {"cart_mm": 5}}]}"#,
    ),
    (
        "a segment with a tool",
        &["tool", "motion 1"],
        r#"{"type": "spline", "segments": [{"type": "spl", "frame": @frame, "tool": "flange"}]}"#,
    ),
    (
        "a line with an aux frame",
        &["aux", "segment"],
        r#"{"type": "spline", "segments": [{"type": "lin", "frame": @frame, "aux": @frame}]}"#,
    ),
    (
        "a line with an angle",
        &["circ_angle_deg", "segment"],
        r#"{"type": "spline", "segments": [
            {"type": "lin", "frame": @frame, "circ_angle_deg": 90}]}"#,
    ),
    (
        "a segment's reference that is for circles",
        &["orientation_reference", "segment"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame, "orientation_reference": "path"}]}"#,
    ),
    (
        "a circle without an aux frame",
        &["aux", "segment"],
        r#"{"type": "spline", "segments": [{"type": "circ", "frame": @frame}]}"#,
    ),
    (
        "a segment's velocity above one",
        &["velocity_rel", "segment"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame, "velocity_rel": 1.5}]}"#,
    ),
    (
        "a segment's speed of zero",
        &["cart_velocity_mm_s", "segment"],
        r#"{"type": "spline", "segments": [
            {"type": "spl", "frame": @frame, "cart_velocity_mm_s": 0}]}"#,
    ),
    (
        "a tool that is not there",
        &["no tool", "`hook`"],
        r#"{"type": "lin", "frame": @frame, "tool": "hook"}"#,
    ),
    (
        "a tip that is not there",
        &["no tool", "flange/left"],
        r#"{"type": "lin", "frame": @frame, "tool": "flange/left"}"#,
    ),
    (
        "a tool of an empty name",
        &["no tool", "tool"],
        r#"{"type": "ptp", "frame": @frame, "tool": ""}"#,
    ),
    (
        "a base that is not there",
        &["no base", "`shelf`"],
        r#"{"type": "ptp", "frame": @frame, "base": "shelf"}"#,
    ),
    ("a frame that is not there", &["no frame", "`pick`"], r#"{"type": "ptp", "frame": "pick"}"#),
    ("a frame of an empty name", &["no frame", "frame"], r#"{"type": "ptp", "frame": ""}"#),
    (
        "a frame in a base that is not there",
        &["no base", "`shelf`"],
        r#"{"type": "ptp", "frame": {"base": "shelf", @pose}}"#,
    ),
    (
        "an offset in a frame that is not there",
        &["no frame", "`pick`"],
        r#"@ptp, {"type": "lin_rel", "offset": {"z_mm": 10}, "in": "pick"}"#,
    ),
    (
        "an aux frame that is not there",
        &["no frame", "`via`"],
        r#"@ptp, {"type": "circ", "aux": "via", "frame": @frame}"#,
    ),
    (
        "a segment's frame that is not there",
        &["no frame", "`via`"],
        r#"@ptp, {"type": "spline", "segments": [{"type": "spl", "frame": "via"}]}"#,
    ),
    ("an angle of a circle of zero", &["circ_angle_deg"], r#"@ptp, {@circ, "circ_angle_deg": 0}"#),
    (
        "an angle of a circle of two turns",
        &["circ_angle_deg"],
        r#"@ptp, {@circ, "circ_angle_deg": 720}"#,
    ),
];

/// Invalid lists: names of tools, bases and frames, and the current tool and base.
const LISTS: &[Invalid] = &[
    (
        "a tool in use that is not there",
        &["no tool", "`hook`"],
        r#""tool": "hook", "motions": [@ptp]"#,
    ),
    (
        "a tip in use that is not there",
        &["no tool", "hand/left"],
        r#""tools": {"hand": {"tcp": {}}}, "tool": "hand/left", "motions": [@ptp]"#,
    ),
    (
        "a base in use that is not there",
        &["no base", "`shelf`"],
        r#""base": "shelf", "motions": [@ptp]"#,
    ),
    (
        "a base in a base that is not there",
        &["no base", "`shelf`"],
        r#""bases": {"table": {"base": "shelf"}}, "base": "table", "motions": [@ptp]"#,
    ),
    (
        "a base in itself",
        &["base", "`table`"],
        r#""bases": {"table": {"base": "table"}}, "base": "table", "motions": [@ptp]"#,
    ),
    (
        "bases in each other",
        &["base", "table", "tray"],
        r#""bases": {"table": {"base": "tray"}, "tray": {"base": "table"}},
            "base": "table", "motions": [@ptp]"#,
    ),
    ("a tool without a TCP", &["tcp", "column"], r#""tools": {"hand": {}}, "motions": [@ptp]"#),
    ("a tool called flange", &["flange"], r#""tools": {"flange": {"tcp": {}}}, "motions": [@ptp]"#),
    (
        "a tool with a slash in its name",
        &["hand/left", "/"],
        r#""tools": {"hand/left": {"tcp": {}}}, "motions": [@ptp]"#,
    ),
    (
        "a tool without a name",
        &["name", "tools"],
        r#""tools": {"": {"tcp": {}}}, "motions": [@ptp]"#,
    ),
    (
        "a tip without a name",
        &["name", "tip"],
        r#""tools": {"hand": {"tcp": {}, "tips": {"": {}}}}, "motions": [@ptp]"#,
    ),
    ("a base called robot", &["robot"], r#""bases": {"robot": {}}, "motions": [@ptp]"#),
    ("a base without a name", &["name", "bases"], r#""bases": {"": {}}, "motions": [@ptp]"#),
    ("a frame called tcp", &["tcp"], r#""frames": {"tcp": @frame}, "motions": [@ptp]"#),
    ("a frame without a name", &["name", "frames"], r#""frames": {"": @frame}, "motions": [@ptp]"#),
    (
        "a frame without an angle",
        &["a_deg", "column"],
        r#""frames": {"pick": {"x_mm": 0, "y_mm": 0, "z_mm": 0, "b_deg": 0, "c_deg": 0}},
            "motions": [@ptp]"#,
    ),
    (
        "an angle of a base twice",
        &["c_deg", "c_rad", "table"],
        r#""bases": {"table": {"c_deg": 0, "c_rad": 0}}, "motions": [@ptp]"#,
    ),
    (
        "an angle of a tool twice",
        &["a_deg", "a_rad", "hand"],
        r#""tools": {"hand": {"tcp": {"a_deg": 0, "a_rad": 0}}}, "motions": [@ptp]"#,
    ),
    (
        "a load of less than nothing",
        &["mass_kg", "hand"],
        r#""tools": {"hand": {"tcp": {}, "load": {"mass_kg": -1}}}, "motions": [@ptp]"#,
    ),
    (
        "a load without a mass",
        &["mass_kg", "column"],
        r#""tools": {"hand": {"tcp": {}, "load": {}}}, "motions": [@ptp]"#,
    ),
    (
        "two of the centre's numbers",
        &["center_mm", "column"],
        r#""tools": {"hand": {"tcp": {}, "load": {"mass_kg": 1, "center_mm": [0, 0]}}},
            "motions": [@ptp]"#,
    ),
    (
        "two tools of one name",
        &["hand", "twice"],
        r#""tools": {"hand": {"tcp": {}}, "hand": {"tcp": {}}}, "motions": [@ptp]"#,
    ),
    (
        "two frames of one name",
        &["pick", "twice"],
        r#""frames": {"pick": @frame, "pick": @frame}, "motions": [@ptp]"#,
    ),
    ("the mode T2", &["mode", "t2", "column"], r#""mode": "t2", "motions": [@ptp]"#),
    ("the mode T1 in capitals", &["mode", "T1", "column"], r#""mode": "T1", "motions": [@ptp]"#),
    ("a version", &["version"], r#""version": 1, "motions": [@ptp]"#),
    ("a start", &["start"], r#""start": {"joints_deg": [0, 0, 0, 0, 0, 0, 0]}, "motions": [@ptp]"#),
    ("an included file", &["include"], r#""include": "cell.json", "motions": [@ptp]"#),
    ("a robot", &["robot"], r#""robot": "lbr_iiwa_7_r800", "motions": [@ptp]"#),
    ("a key in capitals", &["Mode"], r#""Mode": "t1", "motions": [@ptp]"#),
    (
        "motions as an object",
        &["motions", "column"],
        r#""motions": {"type": "wait", "seconds": 1}"#,
    ),
    ("motions within motions", &["motion 1"], r#""motions": [[@ptp]]"#),
];
