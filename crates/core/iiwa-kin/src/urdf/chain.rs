//! Selection of the seven robot joints among all joints of a URDF.

use std::collections::{HashMap, HashSet};

use nalgebra::{Isometry3, UnitQuaternion};

use super::{Listed, UrdfError, joint::UrdfJoint, read::Description};
use crate::Joints;

/// Seven revolute joints, with the fixed joints between and after them.
pub(super) struct Chain<'a> {
    pub(super) base: &'a str,
    pub(super) tip: &'a str,
    pub(super) joints: Vec<&'a UrdfJoint<'a>>,
    /// Indices of the revolute joints.
    moving: [usize; 7],
}

impl<'a> Chain<'a> {
    pub(super) fn revolute(&self) -> [&'a UrdfJoint<'a>; 7] {
        self.moving.map(|index| self.joints[index])
    }

    /// Poses, in the base, of the seven joints (before their rotation) and of the tip.
    pub(super) fn poses(&self, joints_rad: &Joints) -> ([Isometry3<f64>; 7], Isometry3<f64>) {
        let mut pose = Isometry3::identity();
        let mut poses = [pose; 7];
        let mut number = 0;
        for joint in &self.joints {
            pose *= joint.origin;
            if joint.is_revolute() {
                poses[number] = pose;
                pose *= UnitQuaternion::from_axis_angle(&joint.axis, joints_rad[number]);
                number += 1;
            }
        }
        (poses, pose)
    }
}

impl<'t> Description<'t> {
    /// Chain of seven revolute joints that ends at `tip`, or at the only possible link.
    pub(super) fn chain(&self, tip: Option<&str>) -> Result<Chain<'_>, UrdfError> {
        self.find_chain(tip, false).map_err(|error| self.unless_xacro(error))
    }

    /// Chain of the seven revolute joints of the only arm; any link after the seventh joint may be
    /// its tip.
    pub(super) fn chain_of_arm(&self) -> Result<Chain<'_>, UrdfError> {
        self.find_chain(None, true).map_err(|error| self.unless_xacro(error))
    }

    /// Explains a fault of a file with xacro elements, whose links and joints are not complete.
    fn unless_xacro(&self, error: UrdfError) -> UrdfError {
        match &self.xacro {
            Some((span, element)) => {
                UrdfError::Xacro { place: span.place(), element: element.clone() }
            }
            None => error,
        }
    }

    /// Chain that ends at `tip`; without a tip, at the only possible link, or, with `any_tip`, at
    /// any possible link of the only arm.
    fn find_chain(&self, tip: Option<&str>, any_tip: bool) -> Result<Chain<'_>, UrdfError> {
        let index_of: HashMap<&str, usize> =
            self.links.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
        let find = |joint: &UrdfJoint<'_>, link: &str| {
            index_of.get(link).copied().ok_or_else(|| UrdfError::UnknownLink {
                place: joint.span.place(),
                joint: joint.name.clone(),
                link: link.to_owned(),
            })
        };
        let mut above: Vec<Option<(&UrdfJoint<'_>, usize)>> = vec![None; self.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for joint in &self.joints {
            let (parent, child) = (find(joint, &joint.parent)?, find(joint, &joint.child)?);
            if above[child].is_some() {
                return Err(UrdfError::SecondParent {
                    place: joint.span.place(),
                    joint: joint.name.clone(),
                    link: joint.child.clone(),
                });
            }
            above[child] = Some((joint, parent));
            below[parent].push(child);
        }
        let tip = match tip {
            Some(tip) => *index_of.get(tip).ok_or_else(|| UrdfError::UnknownTip {
                place: self.span.place(),
                tip: tip.to_owned(),
                links: Listed(self.links.clone()),
            })?,
            None => self.default_tip(&above, &below, any_tip)?,
        };
        let mut joints = Vec::new();
        let mut link = tip;
        while let Some((joint, parent)) = above[link] {
            joints.push(joint);
            if joints.len() > self.joints.len() {
                return Err(UrdfError::Cycle {
                    place: joint.span.place(),
                    link: self.links[tip].clone(),
                });
            }
            link = parent;
        }
        joints.reverse();
        self.seven(joints, &self.links[tip])
    }

    /// The chain without its mounting, if it consists of seven revolute joints and fixed joints. A
    /// mounting may move, as a linear axis or a mobile platform does.
    fn seven<'a>(
        &'a self,
        mut joints: Vec<&'a UrdfJoint<'t>>,
        tip: &'a str,
    ) -> Result<Chain<'a>, UrdfError> {
        let is_other = |joint: &UrdfJoint<'_>| !joint.is_revolute() && !joint.is_fixed();
        if let Some(last) = joints.iter().rposition(|joint| is_other(joint)) {
            let is_in_arm = joints[..last].iter().any(|joint| joint.is_revolute());
            let after = joints[last..].iter().filter(|joint| joint.is_revolute()).count();
            if is_in_arm && after != 7 {
                let joint = joints[last];
                let kind = if joint.mimics { "mimic" } else { &joint.kind };
                return Err(UrdfError::JointKind {
                    place: joint.span.place(),
                    joint: joint.name.clone(),
                    found: kind.to_owned(),
                });
            }
            joints.drain(..=last);
        }
        let mounting = joints.iter().take_while(|joint| joint.is_fixed()).count();
        joints.drain(..mounting);
        let moving: Vec<usize> = (0..joints.len()).filter(|&i| joints[i].is_revolute()).collect();
        match <[usize; 7]>::try_from(moving) {
            Ok(moving) => Ok(Chain { base: &joints[0].parent, tip, moving, joints }),
            Err(moving) => Err(UrdfError::JointCount {
                place: joints.last().map_or(self.span, |joint| joint.span).place(),
                tip: tip.to_owned(),
                found: moving.len(),
            }),
        }
    }

    /// Link at the end of the longest chain with exactly seven revolute joints and otherwise fixed
    /// joints, after a mounting that may move; if no such chain exists, the link at the end of the
    /// longest chain. If several links qualify, the first one is the tip only with `any_tip`, and
    /// only if all of them follow the same seventh joint.
    fn default_tip(
        &self,
        above: &[Option<(&UrdfJoint<'_>, usize)>],
        below: &[Vec<usize>],
        any_tip: bool,
    ) -> Result<usize, UrdfError> {
        let mut queue: Vec<QueuedLink> = (0..self.links.len())
            .filter(|&link| above[link].is_none())
            .map(|link| QueuedLink { link, depth: 0, revolute: 0, moved_by: link })
            .collect();
        let (mut longest, mut tips, mut tip_depth) = ((0, 0), Vec::new(), 0);
        // Child links of the seventh joints.
        let mut arms = HashSet::new();
        let mut next = 0;
        while let Some(&QueuedLink { link, depth, revolute, moved_by }) = queue.get(next) {
            next += 1;
            if depth > longest.1 {
                longest = (link, depth);
            }
            if revolute == 7 {
                if depth > tip_depth {
                    tips.clear();
                    tip_depth = depth;
                }
                // The queue yields links in order of depth.
                tips.push(link);
                arms.insert(moved_by);
            }
            queue.extend(below[link].iter().map(|&child| {
                let (revolute, moved_by) = match above[child] {
                    Some((joint, _)) if joint.is_revolute() => (revolute + 1, child),
                    Some((joint, _)) if joint.is_fixed() => (revolute, moved_by),
                    _ => (0, child),
                };
                QueuedLink { link: child, depth: depth + 1, revolute, moved_by }
            }));
        }
        match *tips {
            [] if self.links.is_empty() => Err(UrdfError::Missing {
                place: self.span.place(),
                owner: "the robot".to_owned(),
                missing: "<link>",
            }),
            [] => Ok(longest.0),
            [tip] if !any_tip => Ok(tip),
            [tip, ..] if any_tip && arms.len() == 1 => Ok(tip),
            _ if any_tip => {
                let mut arms: Vec<usize> = arms.into_iter().collect();
                arms.sort_unstable();
                let links = arms.into_iter().map(|link| self.links[link].clone()).collect();
                Err(UrdfError::SeveralArms { place: self.span.place(), links: Listed(links) })
            }
            _ => Err(UrdfError::AmbiguousTip {
                place: self.span.place(),
                links: Listed(tips.into_iter().map(|tip| self.links[tip].clone()).collect()),
            }),
        }
    }
}

/// A link in the search for the tip, from the roots on.
struct QueuedLink {
    link: usize,
    /// Number of joints above the link.
    depth: usize,
    /// Number of revolute joints above the link, after the last joint that is neither revolute nor
    /// fixed.
    revolute: usize,
    /// Child link of the last joint above that is not fixed.
    moved_by: usize,
}
