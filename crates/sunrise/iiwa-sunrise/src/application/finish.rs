//! Builds the program from the commanded motions of an application.

use std::collections::BTreeSet;

use crate::Question;
use iiwa_java::SourceLine;
use iiwa_program::{Circ, Course, Motion, Program, SegmentCourse, Target, TargetRef, Workcell};

use crate::application::station::{FLANGE, FOOT, Station};

/// Names that motions use.
#[derive(Default)]
struct Used {
    tools: BTreeSet<String>,
    frames: BTreeSet<String>,
    bases: BTreeSet<String>,
}

impl Station {
    /// Returns the program, the place of each of its motions, and the questions. The program
    /// contains only the tools, bases and frames that its motions use.
    pub(crate) fn finish(self) -> (Program, Vec<SourceLine>, Vec<Question>) {
        let Self { schedule, workcell, robot_name, flange_m, start_rad, .. } = self;
        let (questions, first_override) = (self.questions, self.first_override);
        let (mut motions, places): (Vec<Motion>, Vec<SourceLine>) =
            schedule.finish().into_iter().unzip();
        let mut used = Used::default();
        used.tools.extend(workcell.tool.clone());
        let of_program = workcell.tool.clone().unwrap_or_else(|| FLANGE.to_owned());
        for motion in &mut motions {
            let Motion::Cartesian(cartesian) = motion else { continue };
            cartesian.tool = cartesian.tool.take().filter(|tool| *tool != of_program);
            used.tools.extend(cartesian.tool.as_deref().map(tool_of));
            used.course(&cartesian.course);
        }
        let mut program = Program::from_rad(start_rad).build();
        program.robot = Some(robot_name);
        program.motions = motions;
        program.workcell = used.of(workcell);
        program.workcell.flange_m = flange_m;
        program.workcell.speed_override = first_override.filter(|share| *share < 1.0);
        (program, places, questions)
    }
}

fn tool_of(name: &str) -> String {
    name.split_once('/').map_or(name, |(tool, _)| tool).to_owned()
}

impl Used {
    fn course(&mut self, course: &Course) {
        match course {
            Course::Ptp { to } | Course::Lin { to } => self.target(to),
            Course::LinRel { within, .. } => {
                if let Some(within) = within {
                    self.target(within);
                }
            }
            Course::Circ(circ) => self.circ(circ),
            Course::Spline(segments) => {
                for segment in segments {
                    match &segment.course {
                        SegmentCourse::Spl { to } | SegmentCourse::Lin { to } => self.target(to),
                        SegmentCourse::Circ(circ) => self.circ(circ),
                    }
                }
            }
        }
    }

    fn circ(&mut self, circ: &Circ) {
        self.target(&circ.aux);
        self.target(&circ.to);
    }

    fn target(&mut self, target: &TargetRef) {
        match target {
            TargetRef::Named(name) => {
                self.frames.insert(name.clone());
            }
            TargetRef::Given(Target { base, .. }) => self.bases.extend(base.clone()),
        }
    }

    /// Reduces a workcell to the used entries; bases are kept with their parents.
    fn of(mut self, workcell: Workcell) -> Workcell {
        let frames = workcell.frames.iter().filter(|(name, _)| self.frames.contains(*name));
        self.bases.extend(frames.filter_map(|(_, frame)| frame.base.clone()));
        let mut open: Vec<String> = self.bases.iter().cloned().collect();
        while let Some(name) = open.pop() {
            let above = workcell.bases.get(&name).and_then(|base| base.base.clone());
            open.extend(above.filter(|above| self.bases.insert(above.clone())));
        }
        self.bases.remove(FOOT);
        let Workcell { mut tools, mut bases, mut frames, .. } = workcell;
        tools.retain(|name, _| self.tools.contains(name));
        bases.retain(|name, _| self.bases.contains(name));
        frames.retain(|name, _| self.frames.contains(name));
        Workcell { tools, bases, frames, ..workcell }
    }
}
