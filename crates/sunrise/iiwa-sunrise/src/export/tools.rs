//! Tools of a program as templates and variables.

use std::collections::{BTreeMap, BTreeSet};

use iiwa_program::{Load, NameFault, Program, Tool, Workcell};

use crate::data_file::ToolTemplate;

use super::{
    cell::{ExportedTool, free, plain},
    identifier::VariableNames,
    literal::text,
    loads::{AtFlange, tool_part},
    loops::LOOP_VARIABLES,
    signals::fields,
};

/// Tools of a program, and the ones that are attached.
pub(super) struct ExportedTools<'p> {
    workcell: &'p Workcell,
    templates: BTreeMap<&'p str, ExportedTool>,
    /// Template names in use.
    taken: BTreeSet<String>,
    variables: VariableNames,
    /// Attached items, in the order of their first use.
    used: Vec<UsedTool<'p>>,
}

/// Item that is attached to the flange.
struct UsedTool<'p> {
    item: AtFlange<'p>,
    variable: String,
    template: String,
}

impl<'p> ExportedTools<'p> {
    pub(super) fn new(program: &'p Program) -> Self {
        let workcell = &program.workcell;
        let mut taken = BTreeSet::new();
        let mut templates = BTreeMap::new();
        for (name, tool) in &workcell.tools {
            let called = free(&plain(name), |name| taken.contains(name));
            taken.insert(called.clone());
            templates.insert(name.as_str(), ExportedTool::new(called, tool));
        }
        let known = ["lbr", "sent"].into_iter().chain(LOOP_VARIABLES).map(str::to_owned);
        let variables = VariableNames::besides(known.chain(fields(program)));
        Self { workcell, templates, taken, variables, used: Vec::new() }
    }

    /// Returns the variable of an attached item.
    pub(super) fn variable(&mut self, item: &AtFlange<'p>) -> String {
        if let Some(known) = self.used.iter().find(|used| used.item == *item) {
            return known.variable.clone();
        }
        let tool_template = item.tool.and_then(|tool| self.templates.get(tool));
        let template = match (tool_template, item.load) {
            (Some(tool_template), None) => tool_template.name.clone(),
            (tool_template, _) => {
                // A readable name that differs from the tool's.
                let name = tool_template.map_or_else(
                    || "Load".to_owned(),
                    |tool_template| format!("{}_Loaded", tool_template.name),
                );
                let name = free(&name, |name| self.taken.contains(name));
                self.taken.insert(name.clone());
                name
            }
        };
        let variable = self.variables.give(&template);
        let used = UsedTool { item: item.clone(), variable: variable.clone(), template };
        self.used.push(used);
        variable
    }

    /// Returns the point that a motion moves, `TOOL` or `TOOL/TIP`, as an expression; `attached` is
    /// at the flange.
    pub(super) fn point(
        &mut self,
        tool: Option<&'p str>,
        attached: &[AtFlange<'p>],
    ) -> Result<String, NameFault> {
        // Checks that the tool exists.
        self.workcell.tcp(tool)?;
        let name = tool.or(self.workcell.tool.as_deref());
        let Some((name, part)) = name.and_then(|name| Some((name, tool_part(name)?))) else {
            return Ok("lbr".to_owned());
        };
        let holder = attached.iter().find(|it| it.tool == Some(part)).cloned();
        let variable = self.variable(&holder.unwrap_or(AtFlange { tool: Some(part), load: None }));
        let frame = self.templates.get(part).and_then(|template| match name.split_once('/') {
            Some((_, tip)) => template.tips.get(tip),
            None => Some(&template.tcp),
        });
        let path = format!("/{}", frame.map_or("", String::as_str));
        Ok(format!("{variable}.getFrame({})", text(&path)))
    }

    /// Returns the variables with the names of their templates.
    pub(super) fn used(&self) -> impl Iterator<Item = (&str, &str)> {
        self.used.iter().map(|used| (used.variable.as_str(), used.template.as_str()))
    }

    /// Returns all templates: the program's tools, and the tools with a load.
    pub(super) fn templates(&self) -> Vec<ToolTemplate> {
        let tool = |name: &str| self.workcell.tools.get(name);
        let unloaded = self.templates.iter().map(|(name, template)| {
            let load = tool(name).and_then(|tool| Some(tool.load.as_ref()?.load));
            template.with_load(&template.name, load)
        });
        let loaded = self.used.iter().filter(|used| used.item.load.is_some()).map(|used| {
            let AtFlange { tool, load } = &used.item;
            match tool.and_then(|tool| self.templates.get(tool)) {
                Some(template) => template.with_load(&used.template, *load),
                None => bare(&used.template, *load),
            }
        });
        unloaded.chain(loaded).collect()
    }
}

/// Returns the template of a load at the bare flange.
fn bare(name: &str, load: Option<Load>) -> ToolTemplate {
    ExportedTool::new(name.to_owned(), &Tool::default()).with_load(name, load)
}
