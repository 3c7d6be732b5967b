//! Converts the tools, bases and frames of a program to those of a project.

use std::collections::{BTreeMap, BTreeSet};

use iiwa_kin::{Status, Turn};
use iiwa_program::{Base, Frame, NameFault, Target, TargetRef, Tool, Workcell};

use crate::data_file::{DataFile, TaughtRedundancy, ToolFrame, ToolTemplate, WorldFrame};

/// Name of the robot base among bases.
const FOOT: &str = "robot";

/// Frames of a project under construction.
pub(super) struct WorldTree<'p> {
    workcell: &'p Workcell,
    /// Device name in Sunrise, to which the redundancy of the frames refers.
    device: String,
    nodes: Vec<TreeNode<'p>>,
    /// Names of all nodes with their parents.
    taken: BTreeSet<(Option<usize>, String)>,
    /// Nodes of the bases and of the frames, by their names in the program.
    bases: BTreeMap<&'p str, usize>,
    targets: BTreeMap<&'p str, usize>,
    /// Nodes of targets that are given inline.
    given: BTreeMap<GivenKey, usize>,
}

/// Frame of the world.
struct TreeNode<'p> {
    name: String,
    /// Name in the program, if the frame is a base.
    base: Option<&'p str>,
    parent: Option<usize>,
    frame: Frame,
    /// E1, status and turn, if the frame is a motion target.
    target: Option<(Option<f64>, Option<Status>, Option<Turn>)>,
    children: Vec<usize>,
}

/// Key of a target: its parent and the bits of its numbers.
type GivenKey = (Option<usize>, [u64; 6], Option<u64>, Option<String>, Option<u8>);

impl<'p> WorldTree<'p> {
    /// Adds all bases and frames of a program.
    pub(super) fn new(workcell: &'p Workcell, device: String) -> Result<Self, NameFault> {
        let mut tree = Self {
            workcell,
            device,
            nodes: Vec::new(),
            taken: BTreeSet::new(),
            bases: BTreeMap::new(),
            targets: BTreeMap::new(),
            given: BTreeMap::new(),
        };
        for name in workcell.bases.keys() {
            // Checks that the base leads to the robot base.
            workcell.base(Some(name))?;
            tree.base(name);
        }
        for (name, target) in &workcell.frames {
            let parent = tree.parent_of(target, None)?;
            let index = tree.add_target(name, parent, target);
            tree.targets.insert(name, index);
        }
        Ok(tree)
    }

    /// Returns the node of a base that leads to the robot base; `None` is the robot base.
    fn base(&mut self, name: &str) -> Option<usize> {
        if let Some(known) = self.bases.get(name) {
            return Some(*known);
        }
        let (name, Base { frame, base }) = self.workcell.bases.get_key_value(name)?;
        let parent = base.as_deref().and_then(|base| self.base(base));
        let above = base.as_deref().filter(|_| parent.is_some());
        let index = self.add(&relative_name(name, above), parent, *frame);
        self.nodes[index].base = Some(name);
        self.bases.insert(name, index);
        Some(index)
    }

    /// Returns the node that a target is given in; `base` is the base of the motion.
    fn parent_of(
        &mut self,
        target: &Target,
        base: Option<&str>,
    ) -> Result<Option<usize>, NameFault> {
        let base_name = target.base.as_deref().or(base).or(self.workcell.base.as_deref());
        let name = base_name.unwrap_or(FOOT);
        self.workcell.base(Some(name))?;
        Ok(if name == FOOT { None } else { self.base(name) })
    }

    /// Adds a motion target; a base with the same name, parent and numbers is reused.
    fn add_target(&mut self, name: &str, parent: Option<usize>, target: &Target) -> usize {
        let is_same = |node: &&usize| {
            let node = &self.nodes[**node];
            node.parent == parent && node.frame == target.frame && node.target.is_none()
        };
        let index = self.bases.get(name).filter(is_same).copied().unwrap_or_else(|| {
            let above = parent.and_then(|parent| self.nodes[parent].base);
            self.add(&relative_name(name, above), parent, target.frame)
        });
        let Target { e1_rad, status, turn, .. } = target;
        self.nodes[index].target = Some((*e1_rad, *status, turn.and_then(Turn::new)));
        index
    }

    fn add(&mut self, wanted: &str, parent: Option<usize>, frame: Frame) -> usize {
        let name = free(wanted, |name| self.taken.contains(&(parent, name.to_owned())));
        self.taken.insert((parent, name.clone()));
        let index = self.nodes.len();
        if let Some(parent) = parent {
            self.nodes[parent].children.push(index);
        }
        self.nodes.push(TreeNode {
            name,
            base: None,
            parent,
            frame,
            target: None,
            children: Vec::new(),
        });
        index
    }

    /// Returns the path of the frame or base in whose orientation an offset is given; `None` for
    /// the robot base.
    pub(super) fn reference_path(
        &mut self,
        target: &TargetRef,
        base: Option<&str>,
        name: &str,
    ) -> Result<Option<String>, NameFault> {
        self.workcell.reference(target, base)?;
        match target {
            TargetRef::Named(known) if !self.targets.contains_key(known.as_str()) => {
                Ok(self.bases.get(known.as_str()).map(|index| self.path_of(Some(*index))))
            }
            target => self.path(target, base, name).map(Some),
        }
    }

    /// Returns the path of a frame, such as `/Table/P1`. A target that is given inline becomes a
    /// frame of the project called `name`, unless an equal one exists.
    pub(super) fn path(
        &mut self,
        target: &TargetRef,
        base: Option<&str>,
        name: &str,
    ) -> Result<String, NameFault> {
        let index = match target {
            TargetRef::Named(known) => {
                // Checks that the frame exists.
                self.workcell.target(target, base)?;
                self.targets.get(known.as_str()).copied()
            }
            TargetRef::Given(target) => {
                let parent = self.parent_of(target, base)?;
                let [x, y, z] = target.frame.xyz_mm.map(f64::to_bits);
                let [a, b, c] = target.frame.abc_rad.map(f64::to_bits);
                let status = target.status.map(|status| status.to_string());
                let e1 = target.e1_rad.map(f64::to_bits);
                let key = (parent, [x, y, z, a, b, c], e1, status, target.turn);
                let known = self.given.get(&key).copied();
                Some(known.unwrap_or_else(|| {
                    let index = self.add_target(name, parent, target);
                    self.given.insert(key, index);
                    index
                }))
            }
        };
        Ok(self.path_of(index))
    }

    fn path_of(&self, mut node: Option<usize>) -> String {
        let mut names = Vec::new();
        while let Some(index) = node {
            names.push(self.nodes[index].name.as_str());
            node = self.nodes[index].parent;
        }
        names.iter().rev().flat_map(|name| ["/", name]).collect()
    }

    /// Returns the data file with all frames and these tools.
    pub(super) fn finish(&self, tools: Vec<ToolTemplate>) -> DataFile {
        let outermost = (0..self.nodes.len()).filter(|index| self.nodes[*index].parent.is_none());
        let frames = outermost.map(|index| self.frame(index)).collect();
        DataFile { frames, tools, ..DataFile::default() }
    }

    fn frame(&self, index: usize) -> WorldFrame {
        let TreeNode { name, frame, target, children, .. } = &self.nodes[index];
        let redundancy = target.and_then(|(e1_rad, status, turn)| {
            let is_stated = e1_rad.is_some() || status.is_some() || turn.is_some();
            // On a frame with children, the redundancy marks the frame as a motion target.
            (is_stated || !children.is_empty()).then(|| TaughtRedundancy {
                device: self.device.clone(),
                e1_rad,
                status,
                turn,
            })
        });
        WorldFrame {
            name: name.clone(),
            frame: *frame,
            redundancy,
            teaching: None,
            children: children.iter().map(|child| self.frame(*child)).collect(),
        }
    }
}

/// Tool template of an exported tool.
pub(super) struct ExportedTool {
    /// Name in the project.
    pub(super) name: String,
    /// Names of the TCP frame and of the tip frames; tips by their names in the program.
    pub(super) tcp: String,
    pub(super) tips: BTreeMap<String, String>,
    frames: Vec<ToolFrame>,
}

impl ExportedTool {
    /// Creates a template without a load; `name` is unique.
    pub(super) fn new(name: String, tool: &Tool) -> Self {
        let mut taken = BTreeSet::new();
        let mut frames = Vec::new();
        let mut add = |wanted: &str, frame: Frame| {
            let name = free(wanted, |name| taken.contains(name));
            taken.insert(name.clone());
            frames.push(ToolFrame { name: name.clone(), frame, children: Vec::new() });
            name
        };
        // Tips keep their names.
        let tcp = free("TCP", |name| tool.tips.contains_key(name));
        let tcp = add(&tcp, tool.tcp);
        let tips = tool.tips.iter();
        let tips = tips.map(|(tip, frame)| (tip.clone(), add(&plain(tip), *frame))).collect();
        Self { name, tcp, tips, frames }
    }

    /// Returns the template for the data file, with a load.
    pub(super) fn with_load(&self, name: &str, load: Option<iiwa_kin::Load>) -> ToolTemplate {
        ToolTemplate {
            name: name.to_owned(),
            class: None,
            default_frame: Some(format!("/{}", self.tcp)),
            frames: self.frames.clone(),
            load,
        }
    }
}

/// Returns the name of a frame relative to its parent, which is called `above` in the program.
fn relative_name(name: &str, above: Option<&str>) -> String {
    let relative = above.and_then(|above| name.strip_prefix(above)?.strip_prefix('/'));
    plain(relative.unwrap_or(name))
}

/// Replaces slashes and control characters in a name; a slash separates names in a path.
pub(super) fn plain(name: &str) -> String {
    match name {
        "" => "unnamed".to_owned(),
        name => name.replace(|c: char| c == '/' || c.is_control(), "_"),
    }
}

/// Returns the name, or the name with the first free number appended.
pub(super) fn free(wanted: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut given = wanted.to_owned();
    let mut count = 1;
    while is_taken(&given) {
        count += 1;
        given = format!("{wanted}_{count}");
    }
    given
}
