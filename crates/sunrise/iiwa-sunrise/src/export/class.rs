//! Class of an exported program.

use std::fmt::Write as _;

use iiwa_kin::Joints;
use iiwa_program::{Blend, Motion, MotionIndex, Program};

use super::{
    awaited_motions::{AwaitedMotions, SleepCall},
    cell::WorldTree,
    error::{ExportError, ExportNotice},
    expression::MotionWriter,
    imports::ExportedImports,
    literal::comment,
    loads::{AtFlange, AttachedTools},
    tools::ExportedTools,
};

/// Maximum number of statements in a readable method.
const MAX_STATEMENTS: usize = 60;

/// Indentation of statements.
const INDENT: usize = 8;

/// Head of a class.
pub(super) struct ClassHeading<'a> {
    pub(super) class: &'a str,
    /// Name of the program.
    pub(super) program: &'a str,
    pub(super) start_deg: &'a Joints,
}

/// Class under construction.
pub(super) struct ExportedClass {
    imports: ExportedImports,
    /// Tool variables with their templates.
    tools: Vec<(String, String)>,
    initialize: Vec<String>,
    run: Vec<String>,
    /// `true` if a statement can be interrupted.
    sleeps_finely: bool,
    /// Index of the statement of the last motion, if that motion may still be running.
    under_way: Option<usize>,
    /// `true` if the program waits for such a motion.
    awaits: bool,
}

/// State after the previous motion.
struct MotionBefore {
    motion: MotionIndex,
    point: String,
    /// `true` if the motion is blended into the next one.
    is_blended: bool,
}

impl ExportedClass {
    /// Writes the statements of a program; frames and tools that they use are added to `tree` and
    /// `tools`.
    pub(super) fn new<'p>(
        program: &'p Program,
        tree: &mut WorldTree<'p>,
        tools: &mut ExportedTools<'p>,
        notices: &mut Vec<ExportNotice>,
    ) -> Result<Self, ExportError> {
        let mut class = Self {
            imports: ExportedImports::default(),
            tools: Vec::new(),
            initialize: Vec::new(),
            run: Vec::new(),
            sleeps_finely: false,
            under_way: None,
            awaits: false,
        };
        class.imports.class("com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication");
        class.imports.class("com.kuka.roboticsAPI.deviceModel.LBR");
        class.imports.class("javax.inject.Inject");
        let attached = AttachedTools::new(program);
        let awaited = AwaitedMotions::new(program)?;
        // A load change before the first motion applies to the whole program.
        let mut at_flange: &[AtFlange<'p>] = &[];
        let mut before: Option<MotionBefore> = None;
        for (motion, entry) in program.entries() {
            let index = motion.index();
            let now = attached.at(index);
            if *now != *at_flange {
                if let Some(MotionBefore { motion, is_blended: true, .. }) = before {
                    return Err(another_tool(motion));
                }
                class.come_into_step();
                let into = if before.is_none() { &mut class.initialize } else { &mut class.run };
                swap(tools, at_flange, now, into);
                at_flange = now;
            }
            match entry {
                Motion::Wait { seconds, overlap } => {
                    if *overlap == 0 {
                        class.come_into_step();
                    }
                    class.wait(motion, *seconds, notices);
                }
                // The attached tools already state the load.
                Motion::Load(_) => class.come_into_step(),
                Motion::Ptp(_) | Motion::Cartesian(_) => {
                    if awaited.is_in_step(index) {
                        class.come_into_step();
                    }
                    let blends = awaited.blends(index);
                    let point = point(entry, motion, at_flange, before.as_ref(), tools)?;
                    let base = match entry {
                        Motion::Cartesian(cartesian) => cartesian.base.as_deref(),
                        _ => None,
                    };
                    let mut expressions = MotionWriter {
                        tree: &mut *tree,
                        imports: &mut class.imports,
                        motion,
                        base,
                    };
                    let written = match entry {
                        Motion::Ptp(ptp) => expressions.ptp(ptp, blends)?,
                        Motion::Cartesian(cartesian) => expressions.cartesian(cartesian, blends)?,
                        Motion::Wait { .. } | Motion::Load(_) => continue,
                    };
                    let is_async = awaited.is_asynchronous(index);
                    let method = if is_async { "moveAsync" } else { "move" };
                    class.under_way = (is_async && !blends).then_some(class.run.len());
                    class.run.push(written.statement(&format!("{point}.{method}("), INDENT));
                    before = Some(MotionBefore { motion, point, is_blended: blends });
                }
            }
        }
        class.come_into_step();
        class.tools =
            tools.used().map(|(name, template)| (name.to_owned(), template.to_owned())).collect();
        if !class.tools.is_empty() {
            class.imports.class("com.kuka.roboticsAPI.geometricModel.Tool");
        }
        Ok(class)
    }

    /// Waits for the end of a motion that may still be running.
    fn come_into_step(&mut self) {
        let Some(statement) = self.under_way.take() else { return };
        if let Some(statement) = self.run.get_mut(statement) {
            statement.insert_str(INDENT, "sent = ");
        }
        self.run.push(format!("{:INDENT$}sent.await();", ""));
        self.imports.class("com.kuka.roboticsAPI.motionModel.IMotionContainer");
        self.awaits = true;
    }

    fn wait(&mut self, motion: MotionIndex, seconds: f64, notices: &mut Vec<ExportNotice>) {
        let (sleep, is_rounded) = SleepCall::of(seconds);
        if is_rounded {
            let message = format!("{seconds} s is rounded to whole nanoseconds");
            notices.push(ExportNotice { motion: Some(motion), key: "seconds", message });
        }
        let statement = match sleep {
            SleepCall::Milliseconds(ms) => {
                self.imports.class("com.kuka.common.ThreadUtil");
                format!("ThreadUtil.milliSleep({ms}L);")
            }
            SleepCall::Nanoseconds(ns) => {
                self.imports.class("java.util.concurrent.TimeUnit");
                self.sleeps_finely = true;
                format!("TimeUnit.NANOSECONDS.sleep({ns}L);")
            }
        };
        self.run.push(format!("{:INDENT$}{statement}", ""));
    }

    /// Returns the source file of the class.
    pub(super) fn text(&self, heading: &ClassHeading<'_>) -> String {
        let ClassHeading { class, program, start_deg } = heading;
        let mut text = format!("package application;\n\n{}\n", self.imports.text());
        let start = start_deg.map(|deg| deg.to_string()).join(", ");
        let _ = writeln!(
            text,
            "/**\n * Motions of the program {}, written by iiwasim.",
            comment(program)
        );
        let _ = writeln!(
            text,
            " * <p>\n * The joints must be at {start} deg before the application runs."
        );
        let _ = writeln!(text, " */\npublic class {class} extends RoboticsAPIApplication {{");
        text.push_str("    @Inject\n    private LBR lbr;\n\n");
        for (variable, _) in &self.tools {
            let _ = writeln!(text, "    private Tool {variable};");
        }
        if self.awaits {
            text.push_str("    private IMotionContainer sent;\n");
        }
        if !self.tools.is_empty() || self.awaits {
            text.push('\n');
        }
        let create = self.tools.iter().map(|(variable, template)| {
            let template = super::literal::text(template);
            format!(
                "{:INDENT$}{variable} = getApplicationData().createFromTemplate({template});",
                ""
            )
        });
        let initialize: Vec<String> = create.chain(self.initialize.iter().cloned()).collect();
        self.method(&mut text, "public void initialize()", true, &initialize);
        let parts: Vec<&[String]> = self.run.chunks(MAX_STATEMENTS).collect();
        if let [only] = parts.as_slice() {
            self.method(&mut text, "public void run()", true, only);
        } else {
            let calls: Vec<String> =
                (1..=parts.len()).map(|part| format!("{:INDENT$}part{part}();", "")).collect();
            self.method(&mut text, "public void run()", true, &calls);
            for (index, part) in parts.iter().enumerate() {
                let signature = format!("private void part{}()", index + 1);
                self.method(&mut text, &signature, false, part);
            }
        }
        // Methods are separated by an empty line; the last one is not followed by one.
        text.truncate(text.trim_end().len());
        text.push_str("\n}\n");
        text
    }

    fn method(&self, text: &mut String, signature: &str, overrides: bool, statements: &[String]) {
        if overrides {
            text.push_str("    @Override\n");
        }
        let is_run = !signature.contains("initialize");
        let throws = if is_run && self.sleeps_finely { " throws InterruptedException" } else { "" };
        let _ = writeln!(text, "    {signature}{throws} {{");
        for statement in statements {
            let _ = writeln!(text, "{statement}");
        }
        text.push_str("    }\n\n");
    }
}

/// Returns the point that a motion moves. A PTP motion to joint positions continues with the point
/// of a motion that is blended into it, unless the blend of the PTP motion is itself defined by a
/// TCP distance.
fn point<'p>(
    entry: &'p Motion,
    motion: MotionIndex,
    at_flange: &[AtFlange<'p>],
    before: Option<&MotionBefore>,
    tools: &mut ExportedTools<'p>,
) -> Result<String, ExportError> {
    let (tool, is_free) = match entry {
        Motion::Cartesian(cartesian) => (cartesian.tool.as_deref(), false),
        Motion::Ptp(ptp) => (None, !matches!(ptp.blend, Some(Blend::CartMm(_)))),
        Motion::Wait { .. } | Motion::Load(_) => (None, true),
    };
    let point = tools.point(tool, at_flange).map_err(|fault| ExportError::Name {
        motion: Some(motion),
        key: "tool",
        fault,
    })?;
    match before {
        Some(MotionBefore { point: other, is_blended: true, .. }) if is_free => Ok(other.clone()),
        Some(MotionBefore { motion, point: other, is_blended: true }) if *other != point => {
            Err(another_tool(*motion))
        }
        _ => Ok(point),
    }
}

fn another_tool(motion: MotionIndex) -> ExportError {
    ExportError::NotInSunrise {
        motion,
        key: "blend",
        why: "another TCP moves after it, and Sunrise stops there; remove the blend",
    }
}

/// Detaches tools that are no longer used at the flange, and attaches the missing ones.
fn swap<'p>(
    tools: &mut ExportedTools<'p>,
    was: &[AtFlange<'p>],
    now: &[AtFlange<'p>],
    statements: &mut Vec<String>,
) {
    for detached in was.iter().filter(|it| !now.contains(it)) {
        statements.push(format!("{:INDENT$}{}.detach();", "", tools.variable(detached)));
    }
    for new in now.iter().filter(|it| !was.contains(it)) {
        let variable = tools.variable(new);
        statements.push(format!("{:INDENT$}{variable}.attachTo(lbr.getFlange());", ""));
    }
}
