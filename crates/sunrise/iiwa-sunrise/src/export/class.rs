//! Class of an exported program.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use iiwa_kin::Joints;
use iiwa_program::{
    Blend, IoEntry, IoKind, MAX_ERRORS, Motion, MotionIndex, MotionLabel, Program, RepeatBlock,
};

use crate::label_comment::label_lines;

use super::{
    awaited_motions::{AwaitedMotions, SleepCall},
    cell::WorldTree,
    error::{ExportError, ExportNotice},
    expression::MotionWriter,
    imports::ExportedImports,
    literal::comment,
    loads::{AtFlange, AttachedTools},
    loops::{ExportedStatement, UnrolledProgram},
    signals::{ExportedSignal, long_signals},
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
    /// Lines of comments before the statements of `run`, by the index of the statement.
    comments: BTreeMap<usize, String>,
    /// For each motion of the program, the index of its first statement in `run`, after the
    /// statements that complete the motion before; then the number of statements.
    starts: Vec<usize>,
    repeats: Vec<RepeatBlock>,
    /// `true` if a statement can be interrupted.
    sleeps_finely: bool,
    /// Index of the statement of the last motion, if that motion may still be running.
    under_way: Option<usize>,
    /// `true` if the program waits for such a motion.
    awaits: bool,
    /// Classes of groups of inputs and outputs, by their fields.
    groups: BTreeMap<String, String>,
}

/// Writer of the statements of motions, one after the other.
struct StatementWriter<'a, 'p> {
    class: ExportedClass,
    tree: &'a mut WorldTree<'p>,
    tools: &'a mut ExportedTools<'p>,
    notices: &'a mut Vec<ExportNotice>,
    attached: &'a AttachedTools<'p>,
    awaited: &'a AwaitedMotions,
    /// Signals with numbers beyond Java's `int`.
    long_signals: BTreeSet<&'p str>,
    /// Attached tools. A load change before the first motion is valid for the whole program.
    at_flange: &'a [AtFlange<'p>],
    before: Option<MotionBefore>,
}

impl<'p> StatementWriter<'_, 'p> {
    /// Adds the statements of an entry.
    fn add(
        &mut self,
        motion: MotionIndex,
        entry: &'p Motion,
        label: Option<&MotionLabel>,
    ) -> Result<(), ExportError> {
        let Self { class, tree, tools, notices, attached, awaited, at_flange, before, .. } = self;
        let index = motion.index();
        let now = attached.at(index);
        if matches!(entry, Motion::Load(_)) {
            // The attached tools state the load.
            class.come_into_step();
            class.starts.push(class.run.len());
        }
        let before_swap = class.run.len();
        if *now != **at_flange {
            if let Some(MotionBefore { motion, is_blended: true, .. }) = before {
                return Err(another_tool(*motion));
            }
            class.come_into_step();
            let into = if before.is_none() { &mut class.initialize } else { &mut class.run };
            swap(tools, at_flange, now, into);
            *at_flange = now;
        }
        match entry {
            Motion::Wait { seconds, overlap } => {
                if *overlap == 0 {
                    class.come_into_step();
                }
                class.starts.push(class.run.len());
                class.label(label);
                class.wait(motion, *seconds, notices);
            }
            Motion::Io(io) => {
                if io.overlap == 0 {
                    class.come_into_step();
                }
                class.starts.push(class.run.len());
                class.label(label);
                class.signal(motion, io, &self.long_signals)?;
            }
            Motion::Load(_) if class.run.len() == before_swap => class.comment(label),
            // The import sees the load change at the last statement.
            Motion::Load(_) => class.label_at(class.run.len() - 1, label),
            Motion::Ptp(_) | Motion::Cartesian(_) => {
                if awaited.is_in_step(index) {
                    class.come_into_step();
                }
                class.starts.push(class.run.len());
                let blends = awaited.blends(index);
                let point = point(entry, motion, at_flange, before.as_ref(), tools)?;
                let base = match entry {
                    Motion::Cartesian(cartesian) => cartesian.base.as_deref(),
                    _ => None,
                };
                let mut expressions =
                    MotionWriter { tree, imports: &mut class.imports, motion, base };
                let written = match entry {
                    Motion::Ptp(ptp) => expressions.ptp(ptp, blends)?,
                    Motion::Cartesian(cartesian) => expressions.cartesian(cartesian, blends)?,
                    Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => return Ok(()),
                };
                let is_async = awaited.is_asynchronous(index);
                let method = if is_async { "moveAsync" } else { "move" };
                class.label(label);
                class.under_way = (is_async && !blends).then_some(class.run.len());
                class.run.push(written.statement(&format!("{point}.{method}("), INDENT));
                *before = Some(MotionBefore { motion, point, is_blended: blends });
            }
        }
        Ok(())
    }
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
            comments: BTreeMap::new(),
            starts: Vec::with_capacity(program.motions.len() + 1),
            repeats: program.sources.repeats().to_vec(),
            sleeps_finely: false,
            under_way: None,
            awaits: false,
            groups: BTreeMap::new(),
        };
        class.imports.class("com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication");
        class.imports.class("com.kuka.roboticsAPI.deviceModel.LBR");
        class.imports.class("javax.inject.Inject");
        let attached = AttachedTools::new(program);
        let awaited = AwaitedMotions::new(program)?;
        let mut writer = StatementWriter {
            class,
            tree,
            tools,
            notices,
            attached: &attached,
            awaited: &awaited,
            long_signals: long_signals(program),
            at_flange: &[],
            before: None,
        };
        let mut errors = Vec::new();
        // Motions in first rounds: a motion with an error in each round has one error.
        let mut faulty = BTreeSet::new();
        for (motion, entry) in program.entries() {
            let first = program.sources.in_first_rounds(motion);
            let notices = writer.notices.len();
            if let Err(error) = writer.add(motion, entry, program.sources.label(motion)) {
                // The next motion must not have an error because of this one.
                writer.before = None;
                if faulty.insert(first) {
                    errors.push(error);
                }
            }
            if first != motion && program.motions.get(first.index()) == Some(entry) {
                // The first round has the same notices.
                writer.notices.truncate(notices);
            }
            if errors.len() == MAX_ERRORS {
                break;
            }
        }
        let StatementWriter { mut class, tools, .. } = writer;
        if !errors.is_empty() {
            return Err(ExportError::several(errors));
        }
        class.come_into_step();
        class.starts.push(class.run.len());
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

    /// Adds the label of a motion as comment lines before the next statement.
    fn label(&mut self, label: Option<&MotionLabel>) {
        self.label_at(self.run.len(), label);
    }

    /// Adds the label of a motion as comment lines before a statement.
    fn label_at(&mut self, statement: usize, label: Option<&MotionLabel>) {
        for line in label.map(label_lines).unwrap_or_default() {
            let text = self.comments.entry(statement).or_default();
            let _ = writeln!(text, "{:INDENT$}{line}", "");
        }
    }

    /// Adds name and comment of a load change without a statement, as comment lines that belong to
    /// no motion.
    fn comment(&mut self, label: Option<&MotionLabel>) {
        let Some(MotionLabel { name, comment: remark, .. }) = label else { return };
        let lines = remark.as_deref().unwrap_or_default().lines();
        let lines = lines.map(str::trim_end).filter(|line| !line.is_empty());
        for line in name.as_deref().into_iter().chain(lines) {
            let line = comment(&line.replace('\t', " "));
            let text = self.comments.entry(self.run.len()).or_default();
            let _ = writeln!(text, "{:INDENT$}// {line}", "");
        }
    }

    /// Statements of the method `run`, with the comments before them and with loops.
    fn statements(&self) -> Vec<ExportedStatement> {
        let unrolled = UnrolledProgram {
            statements: &self.commented_run(),
            starts: &self.starts,
            max_size: MAX_STATEMENTS,
            indent: INDENT,
        };
        unrolled.with_loops(&self.repeats)
    }

    /// Statements of the method `run`, with the comments before them.
    fn commented_run(&self) -> Vec<String> {
        let comment = |index| self.comments.get(&index).map_or("", String::as_str);
        let mut run: Vec<String> = self
            .run
            .iter()
            .enumerate()
            .map(|(index, statement)| format!("{}{statement}", comment(index)))
            .collect();
        if let Some(last) = run.last_mut()
            && let Some(text) = self.comments.get(&self.run.len())
        {
            last.push('\n');
            last.push_str(text.trim_end());
        }
        run
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

    fn signal(
        &mut self,
        motion: MotionIndex,
        entry: &IoEntry,
        long_signals: &BTreeSet<&str>,
    ) -> Result<(), ExportError> {
        let signal = ExportedSignal::new(motion, entry)?;
        self.run.push(signal.statement(motion, entry, long_signals, INDENT)?);
        self.imports.generated(signal.import());
        if let IoKind::WaitFor { .. } = entry.kind {
            self.imports.class("com.kuka.common.ThreadUtil");
        }
        self.groups.insert(signal.field(), signal.class());
        Ok(())
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
        for (field, class) in &self.groups {
            let _ = writeln!(text, "    @Inject\n    private {class} {field};\n");
        }
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
        let parts = methods(self.statements());
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

/// Divides statements into methods of a readable length.
fn methods(statements: Vec<ExportedStatement>) -> Vec<Vec<String>> {
    let mut parts: Vec<Vec<String>> = Vec::new();
    let mut size = 0;
    for statement in statements {
        size += statement.size;
        match parts.last_mut() {
            Some(part) if size <= MAX_STATEMENTS => part.push(statement.text),
            _ => {
                size = statement.size;
                parts.push(vec![statement.text]);
            }
        }
    }
    parts
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
        Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => (None, true),
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
