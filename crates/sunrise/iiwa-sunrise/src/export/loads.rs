//! Tools and loads at the flange during each motion.

use iiwa_program::{Load, Motion, Program, Workcell};

/// Item at the flange: a tool, or a tool with a load.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AtFlange<'p> {
    /// Tool; `None` for a load at the bare flange.
    pub(super) tool: Option<&'p str>,
    /// Total payload, if it differs from the tool's own load.
    pub(super) load: Option<Load>,
}

/// Items at the flange at each entry of a program, in order; a wait keeps the previous ones.
pub(super) struct AttachedTools<'p>(Vec<Vec<AtFlange<'p>>>);

impl<'p> AttachedTools<'p> {
    pub(super) fn new(program: &'p Program) -> Self {
        let workcell = &program.workcell;
        let loads = program.loads();
        let tool_of = |index: usize| match program.motions.get(index)? {
            Motion::Ptp(_) => Some(workcell.tool.as_deref()),
            Motion::Cartesian(cartesian) => {
                Some(cartesian.tool.as_deref().or(workcell.tool.as_deref()))
            }
            _ => None,
        };
        // Tool of the next motion, because a load change precedes the motions that use it.
        let mut tool = workcell.tool.as_deref();
        let mut tools = vec![tool; program.motions.len()];
        for index in (0..program.motions.len()).rev() {
            tool = tool_of(index).unwrap_or(tool);
            tools[index] = tool;
        }
        let mut before: Option<Vec<AtFlange<'p>>> = None;
        let mut all = Vec::with_capacity(tools.len());
        for (index, motion) in program.motions.iter().enumerate() {
            let is_wait = motion.wait_s().is_some();
            let needed = || attached(workcell, tools[index].and_then(tool_part), loads[index]);
            let now = match before {
                Some(before) if is_wait || serves(workcell, &before, &needed()) => before,
                _ => needed(),
            };
            all.push(now.clone());
            before = Some(now);
        }
        Self(all)
    }

    /// Returns the items at an entry.
    pub(super) fn at(&self, index: usize) -> &[AtFlange<'p>] {
        self.0.get(index).map_or(&[], Vec::as_slice)
    }
}

/// Returns true if the held items include all needed ones, and no others with a load.
fn serves(workcell: &Workcell, held: &[AtFlange<'_>], needed: &[AtFlange<'_>]) -> bool {
    let is_weightless = |it: &AtFlange<'_>| {
        let tool = it.tool.and_then(|tool| workcell.tools.get(tool));
        it.load.is_none() && tool.is_some_and(|tool| tool.load.is_none())
    };
    needed.iter().all(|it| held.contains(it))
        && held.iter().all(|it| needed.contains(it) || is_weightless(it))
}

/// Returns the tool of `TOOL` or `TOOL/TIP`; `None` for the bare flange.
pub(super) fn tool_part(name: &str) -> Option<&str> {
    let tool = name.split_once('/').map_or(name, |(tool, _)| tool);
    (tool != "flange").then_some(tool)
}

/// Returns the items at the flange for a motion of `tool` with this total load.
fn attached<'p>(
    workcell: &'p Workcell,
    tool: Option<&'p str>,
    load: Option<Load>,
) -> Vec<AtFlange<'p>> {
    let own_load = |name: &str| Some(workcell.tools.get(name)?.load.as_ref()?.load);
    let attached = |tool| AtFlange { tool: Some(tool), load: None };
    let in_use = workcell.tool.as_deref().and_then(tool_part);
    let by_that_in_use = || in_use.filter(|in_use| own_load(in_use) == load);
    match tool {
        Some(tool) if own_load(tool) == load => vec![attached(tool)],
        // A tool without a load, next to the current tool.
        Some(tool) if own_load(tool).is_none() => match by_that_in_use() {
            Some(in_use) => vec![attached(in_use), attached(tool)],
            None => vec![AtFlange { tool: Some(tool), load }],
        },
        Some(tool) => vec![AtFlange { tool: Some(tool), load }],
        None => match (by_that_in_use(), in_use, load) {
            (Some(in_use), ..) => vec![attached(in_use)],
            (None, _, None) => Vec::new(),
            (None, tool, load) => vec![AtFlange { tool, load }],
        },
    }
}
