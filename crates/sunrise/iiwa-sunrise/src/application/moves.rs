//! Sends motions: appends them to the program, and tracks the robot's position.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, SourceLine, Value};
use iiwa_kin::{Pose, Status};
use iiwa_program::{
    Blend, ByKind, CartesianMotion, Circ, Course, Frame, MAX_OVERLAP, Motion, OrientationType,
    PathBlend, Program, Ptp, SegmentCourse, SegmentLimits, SplineSegment, Target, TargetRef,
};

use crate::application::{
    arrival::{joints_at, moved_by, on_circle},
    frame_value::Parent,
    motion_value::{
        Blending, MotionPath, MotionSettings, MotionValue, PlanningObstacle, TargetFrame,
    },
    robot_value::{RobotValue, Sent, robot},
    robotics::Robotics,
    spot::Spot,
    station::FOOT,
};

/// Maximum number of motions; more indicate an endless loop.
const MAX_MOTIONS: usize = 100_000;

/// Target frame with its pose.
struct Destination {
    target: TargetRef,
    /// Pose relative to the robot base.
    pose: Pose,
    e1_rad: Option<f64>,
    status: Option<Status>,
}

impl Robotics<'_> {
    /// Sends a motion of a TCP, and waits for its end unless it is asynchronous. Returns the motion
    /// container.
    pub(crate) fn send(
        &mut self,
        mover: Spot,
        motion: &Rc<RefCell<MotionValue>>,
        is_async: bool,
    ) -> Result<Value, EvaluationStop> {
        self.note_default_frame(mover);
        let mover = self.station.default_frame(mover);
        self.check_known(mover)?;
        if self.station.in_flange(mover).is_none() {
            let subject = self.spot_name(mover);
            return self
                .reject(format!("{subject} moves, but it is not attached to the robot's flange"));
        }
        self.keep_override()?;
        let mut has_break = false;
        for (motion, settings) in members(motion, &MotionSettings::default()) {
            has_break |= settings.has_break;
            self.send_one(mover, &motion, &settings)?;
        }
        if !is_async {
            self.station.schedule.await_all();
        }
        let sent = Sent { count: self.station.schedule.sent(), has_break };
        Ok(robot(RobotValue::Container(Rc::new(sent))))
    }

    /// Checks that the override does not change: a program has only the override of its first
    /// motion.
    fn keep_override(&mut self) -> Result<(), EvaluationStop> {
        let station = &mut *self.station;
        let now = station.speed_override.as_ref().map_or(1.0, |(share, _)| *share);
        let first = *station.first_override.get_or_insert(now);
        if now == first {
            return Ok(());
        }
        let place = station.speed_override.as_ref().map(|(_, place)| format!(" ({place})"));
        let [first, now] = [first, now].map(|share| share * 100.0);
        self.reject(format!(
            "the application continues at {now} % of its speed{}, after motions at {first} %: a \
             program has one override; plan the parts separately",
            place.unwrap_or_default()
        ))
    }

    fn send_one(
        &mut self,
        mover: Spot,
        motion: &MotionValue,
        settings: &MotionSettings,
    ) -> Result<(), EvaluationStop> {
        match &motion.obstacle {
            Some(PlanningObstacle::Unknown(subject, unknown)) => {
                return self.reject_unknown(subject, unknown);
            }
            Some(PlanningObstacle::Refused(reason)) => return self.reject(reason.clone()),
            None => {}
        }
        if self.station.schedule.sent() >= MAX_MOTIONS {
            return self.reject(format!("the arm is moved more than {MAX_MOTIONS} times"));
        }
        if let MotionPath::Hold(time) = motion.way {
            return self.hold(time);
        }
        self.begin_to_move()?;
        let shares = ByKind::from_fn(|kind| settings.shares[kind].unwrap_or([1.0; 7]));
        let to_rad = match motion.way {
            MotionPath::Joints(joints_rad) => Some(joints_rad),
            MotionPath::Home => Some(self.station.home_rad),
            _ => None,
        };
        if let Some(target_rad) = to_rad {
            if let Err(outside) = self.station.robot.limits().check(&target_rad) {
                return self.reject(format!("the arm cannot go there: {outside}"));
            }
            let mut ptp = Ptp { blend: one_blend(&settings.blending), ..Ptp::to(target_rad) };
            for (kind, share) in shares {
                *ptp.share_mut(kind) = share;
            }
            self.station.at_rad = target_rad;
            return self.put(Motion::Ptp(ptp));
        }
        let law = self.law_of(&motion.way, settings.orientation).unwrap_or_default();
        let course = self.course(mover, motion, settings, law)?;
        let mut cartesian = CartesianMotion::new(course);
        cartesian.tool = self.station.tcp_name(mover);
        cartesian.shares = shares;
        cartesian.tool_limits = settings.tool;
        cartesian.blend = if cartesian.is_ptp() {
            one_blend(&settings.blending).map(PathBlend::from)
        } else {
            cartesian.orientation = law;
            path_blend(&settings.blending)
        };
        self.put(Motion::Cartesian(Box::new(cartesian)))
    }

    /// Adds a motion, if it is valid in a program.
    fn put(&mut self, motion: Motion) -> Result<(), EvaluationStop> {
        self.check(&motion)?;
        self.station.schedule.send(motion, self.place.clone());
        Ok(())
    }

    /// Adds a wait during which the robot continues its motions.
    pub(crate) fn wait(&mut self, seconds: f64) -> Result<(), EvaluationStop> {
        self.check_wait(seconds)?;
        let overlap = self.station.schedule.under_way();
        if overlap > MAX_OVERLAP {
            return self.reject(format!(
                "a wait begins while {overlap} motions are under way; it can be {MAX_OVERLAP}"
            ));
        }
        self.station.schedule.wait(seconds, self.place.clone());
        Ok(())
    }

    /// Refuses a wait that is longer than a program allows.
    pub(crate) fn check_wait(&self, seconds: f64) -> Result<(), EvaluationStop> {
        self.check(&Motion::Wait { seconds, overlap: 0 })
    }

    /// Refuses a motion that is not valid in a program.
    pub(crate) fn check(&self, motion: &Motion) -> Result<(), EvaluationStop> {
        let mut program = Program::from_rad(self.station.start_rad).build();
        program.motions.push(motion.clone());
        match program.check_numbers() {
            Ok(()) => Ok(()),
            Err(fault) => {
                let text = fault.to_string();
                self.reject(text.strip_prefix("motion 1: ").unwrap_or(&text))
            }
        }
    }

    /// Returns the course of a motion, and moves the robot to its end.
    fn course(
        &mut self,
        mover: Spot,
        motion: &MotionValue,
        settings: &MotionSettings,
        law: OrientationType,
    ) -> Result<Course, EvaluationStop> {
        let tcp = self.station.in_flange(mover).unwrap_or_default().pose();
        let from = self.station.robot.flange_pose(&self.station.at_rad).then(&tcp);
        let with_law = |pose: &Pose| match law {
            OrientationType::Constant => Pose { rotation: from.rotation, ..*pose },
            _ => *pose,
        };
        // Along a path, the robot keeps its status; only with joint interpolation of the wrist can
        // it change.
        let status_of =
            |place: &Destination| place.status.filter(|_| law == OrientationType::Joints);
        match &motion.way {
            MotionPath::Ptp(to) => {
                let place = self.place_of(to)?;
                self.arrive(&place.target, (&place.pose, &tcp), place.e1_rad, place.status)?;
                Ok(Course::Ptp { to: place.target })
            }
            MotionPath::Lin(to) => {
                let place = self.place_of(to)?;
                let pose = with_law(&place.pose);
                self.arrive(&place.target, (&pose, &tcp), place.e1_rad, status_of(&place))?;
                Ok(Course::Lin { to: place.target })
            }
            MotionPath::LinRel { offset, within } => {
                let within = within.as_ref().map(|within| self.place_of(within)).transpose()?;
                let axes = within.as_ref().map_or(from.rotation, |within| within.pose.rotation);
                let pose = with_law(&moved_by(&from, &offset.pose(), &axes));
                let to = TargetRef::from(Frame::from(&pose));
                self.arrive(&to, (&pose, &tcp), None, None)?;
                let within = within.map(|within| within.target);
                Ok(Course::LinRel { offset: *offset, e1_rad: None, within })
            }
            MotionPath::Circ { aux, to } => {
                let (aux, place) = (self.place_of(aux)?, self.place_of(to)?);
                let mut pose = with_law(&place.pose);
                if let Some(angle) = settings.circ_angle_rad {
                    let points = [&from.position_m, &aux.pose.position_m, &place.pose.position_m];
                    let Some(position_m) = on_circle(points, angle) else {
                        return self.reject(
                            "start, auxiliary frame and end are on one line: no circle passes \
                             through them",
                        );
                    };
                    pose.position_m = position_m;
                }
                self.arrive(&place.target, (&pose, &tcp), place.e1_rad, status_of(&place))?;
                Ok(Course::Circ(circ(aux.target, place.target, settings)))
            }
            MotionPath::Spl(to) => {
                let place = self.place_of(to)?;
                let pose = with_law(&place.pose);
                self.arrive(&place.target, (&pose, &tcp), place.e1_rad, None)?;
                Ok(Course::Spline(vec![SplineSegment {
                    course: SegmentCourse::Spl { to: place.target },
                    orientation: None,
                    limits: SegmentLimits::default(),
                }]))
            }
            MotionPath::Spline(segments) => self.spline(&from, &tcp, law, segments),
            MotionPath::Joints(_)
            | MotionPath::Home
            | MotionPath::Batch(_)
            | MotionPath::Hold(_)
            | MotionPath::Refused => self.reject("this motion has no course of the TCP"),
        }
    }

    /// Returns the orientation type of a motion. `OriJoint` on a spline is planned as `Variable`,
    /// because the wrist motion along a spline is unknown.
    fn law_of(
        &mut self,
        way: &MotionPath,
        law: Option<OrientationType>,
    ) -> Option<OrientationType> {
        let is_spline = matches!(way, MotionPath::Spl(_) | MotionPath::Spline(_));
        if is_spline && law == Some(OrientationType::Joints) {
            self.note("`OriJoint` on a spline is planned as `Variable`, which is an assumption");
            return Some(OrientationType::Variable);
        }
        law
    }

    /// Returns the segments of a spline, and moves the robot to the end of the last one.
    fn spline(
        &mut self,
        from: &Pose,
        tcp: &Pose,
        law: OrientationType,
        segments: &[Rc<RefCell<MotionValue>>],
    ) -> Result<Course, EvaluationStop> {
        let mut position = *from;
        let mut e1_rad = None;
        let mut last = None;
        let mut course_segments = Vec::with_capacity(segments.len());
        for segment in segments {
            let segment = segment.borrow();
            match &segment.obstacle {
                Some(PlanningObstacle::Unknown(subject, unknown)) => {
                    return self.reject_unknown(subject, unknown);
                }
                Some(PlanningObstacle::Refused(reason)) => return self.reject(reason.clone()),
                None => {}
            }
            let settings = &segment.settings;
            if settings.blending != Blending::default() {
                return self.reject("a segment of a spline has a blending: set it on the spline");
            }
            let segment_law = self.law_of(&MotionPath::Spline(Vec::new()), settings.orientation);
            let own_law = segment_law.unwrap_or(law);
            let (place, course) = match &segment.way {
                MotionPath::Spl(to) => {
                    let place = self.place_of(to)?;
                    let to = place.target.clone();
                    (place, SegmentCourse::Spl { to })
                }
                MotionPath::Lin(to) => {
                    let place = self.place_of(to)?;
                    let to = place.target.clone();
                    (place, SegmentCourse::Lin { to })
                }
                MotionPath::LinRel { offset, within } => {
                    let axes = match within {
                        Some(within) => self.place_of(within)?.pose.rotation,
                        None => position.rotation,
                    };
                    let pose = moved_by(&position, &offset.pose(), &axes);
                    let target = TargetRef::Given(in_foot(Frame::from(&pose)));
                    let to = target.clone();
                    (
                        Destination { target, pose, e1_rad: None, status: None },
                        SegmentCourse::Lin { to },
                    )
                }
                MotionPath::Circ { aux, to } => {
                    let (aux, place) = (self.place_of(aux)?, self.place_of(to)?);
                    let circ = circ(aux.target, place.target.clone(), settings);
                    (place, SegmentCourse::Circ(circ))
                }
                _ => {
                    return self.reject(
                        "a spline has a segment that is not a TCP path: segments are spl, lin, \
                         linRel and circ",
                    );
                }
            };
            position = match own_law {
                OrientationType::Constant => Pose { rotation: position.rotation, ..place.pose },
                _ => place.pose,
            };
            e1_rad = place.e1_rad.or(e1_rad);
            last = Some(place.target);
            let limits = SegmentLimits { shares: settings.shares, tool: settings.tool };
            course_segments.push(SplineSegment { course, orientation: segment_law, limits });
        }
        let Some(last) = last else { return self.reject("a spline has no segments") };
        self.arrive(&last, (&position, tcp), e1_rad, None)?;
        Ok(Course::Spline(course_segments))
    }

    /// Moves the robot to a TCP pose.
    fn arrive(
        &mut self,
        target: &TargetRef,
        poses: (&Pose, &Pose),
        e1_rad: Option<f64>,
        status: Option<Status>,
    ) -> Result<(), EvaluationStop> {
        let station = &self.station;
        match joints_at(&station.robot, &station.at_rad, poses, e1_rad, status) {
            Ok(joints_rad) => {
                self.station.at_rad = joints_rad;
                Ok(())
            }
            Err(_) if self.station.is_survey => Ok(()),
            Err(reason) => {
                let subject = match target {
                    TargetRef::Named(name) => format!("the frame `{name}`"),
                    TargetRef::Given(_) => "the target of this motion".to_owned(),
                };
                let hint = self.station.start_hint.as_ref();
                let hint = hint.filter(|_| self.station.schedule.sent() == 0);
                let hint = hint.map_or_else(String::new, |hint| format!("; {hint}"));
                self.reject(format!("{subject} cannot be reached: {reason}{hint}"))
            }
        }
    }

    /// Resolves a target frame: its pose and its name in the program.
    fn place_of(&mut self, goal: &TargetFrame) -> Result<Destination, EvaluationStop> {
        match goal {
            TargetFrame::Spot(Spot::Tree(index)) => {
                self.note_world_after_drive();
                let Some(tree_frame) = self.station.tree.get(*index).cloned() else {
                    return self.reject("this frame is not in the data file");
                };
                self.check_known(Spot::Tree(*index))?;
                if self.station.is_changed(*index) {
                    return Ok(self.changed_place(*index, &tree_frame.name));
                }
                let Some(target) = self.station.workcell.frames.get(&tree_frame.name) else {
                    // A base that is not itself a motion target.
                    let base =
                        Target { base: Some(tree_frame.name), ..Target::at(Frame::default()) };
                    return Ok(Destination { pose: tree_frame.pose, ..destination_of(base) });
                };
                Ok(Destination {
                    pose: tree_frame.pose,
                    e1_rad: target.e1_rad,
                    status: target.status,
                    target: TargetRef::Named(tree_frame.name),
                })
            }
            TargetFrame::Spot(Spot::World) => {
                let target = in_foot(Frame::default());
                Ok(destination_of(target))
            }
            TargetFrame::Spot(spot) => {
                self.check_known(*spot)?;
                if self.station.in_flange(*spot).is_some() {
                    let subject = self.spot_name(*spot);
                    return self
                        .reject(format!("{subject} is a target, but it moves with the arm"));
                }
                if let Some(frame) = self.station.in_world(*spot) {
                    Ok(destination_of(in_foot(frame)))
                } else {
                    let subject = self.spot_name(*spot);
                    self.reject(format!("{subject} is a target, but is not attached to anything"))
                }
            }
            TargetFrame::Frame(frame) => {
                let frame = frame.borrow().clone();
                if let Some(unknown) = &frame.unknown {
                    return self.reject_unknown("the target of this motion", unknown);
                }
                if matches!(frame.parent, Parent::Spot(Spot::Tree(_))) {
                    self.note_world_after_drive();
                }
                if let Parent::Spot(parent) = frame.parent {
                    self.check_known(parent)?;
                }
                let Some(place) = self.station.frame_in_world(&frame) else {
                    return self.reject(
                        "the target of this motion is given in something that is attached to \
                         nothing",
                    );
                };
                let redundancy = frame.redundancy;
                let target = Target {
                    e1_rad: redundancy.e1_rad,
                    status: redundancy.status,
                    turn: redundancy.turn,
                    ..in_foot(place)
                };
                Ok(destination_of(target))
            }
        }
    }

    /// Resolves a frame of the data file that the application has moved: its current pose, with the
    /// redundancy of the data file.
    fn changed_place(&self, index: usize, name: &str) -> Destination {
        let place = self.station.in_world(Spot::Tree(index)).unwrap_or_default();
        let target = match self.station.workcell.frames.get(name) {
            Some(taught) => Target { frame: place, base: Some(FOOT.to_owned()), ..taught.clone() },
            None => in_foot(place),
        };
        destination_of(target)
    }

    /// Before the first motion, sets the program's tool and load from the bodies at the flange.
    fn begin_to_move(&mut self) -> Result<(), EvaluationStop> {
        if self.station.has_moved {
            return Ok(());
        }
        let tools = (0..self.station.bodies.len()).find_map(|index| {
            let body = self.station.bodies.get(index).filter(|body| !body.is_workpiece)?;
            body.in_programs.as_ref()?;
            self.station.tool_at_flange(index).map(str::to_owned)
        });
        self.station.workcell.tool = tools;
        self.station.has_moved = true;
        self.station.carried = self.station.workcell.load(None).copied();
        let place = self.station.attached_at.take().unwrap_or_else(|| self.place.clone());
        self.carry(place)
    }

    /// Applies a payload change: at once if the robot has moved, otherwise at the first motion.
    pub(crate) fn load_changed(&mut self) -> Result<(), EvaluationStop> {
        let place = self.place.clone();
        if self.station.has_moved {
            return self.carry(place);
        }
        self.station.attached_at = Some(place);
        Ok(())
    }

    /// Appends a load change if the payload differs from the program's load.
    fn carry(&mut self, place: SourceLine) -> Result<(), EvaluationStop> {
        let wanted = self.station.flange_load();
        if self.station.carried == wanted {
            return Ok(());
        }
        let load = self.station.workcell.load(None).copied();
        let step = (wanted != load).then(|| wanted.unwrap_or_default());
        self.check(&Motion::Load(step.map(Into::into)))?;
        self.station.schedule.load(step, place);
        self.station.carried = wanted;
        Ok(())
    }

    /// Formats a station frame for messages.
    pub(crate) fn spot_name(&self, spot: Spot) -> String {
        match spot {
            Spot::World => "the world".to_owned(),
            Spot::Flange => "the flange".to_owned(),
            Spot::Tree(index) => {
                let name = self.station.tree.get(index).map_or("", |frame| &frame.path);
                format!("the frame `{name}`")
            }
            Spot::Root(_) | Spot::Of(..) => {
                let body = spot.body().and_then(|index| self.station.bodies.get(index));
                let (name, kind) = body.map_or(("", "tool"), |body| {
                    (&body.name, if body.is_workpiece { "workpiece" } else { "tool" })
                });
                format!("the {kind} `{name}`")
            }
        }
    }
}

/// Returns the motions of a batch, each with its settings and, where unset, those of the batch; any
/// other motion alone.
fn members(
    motion: &Rc<RefCell<MotionValue>>,
    defaults: &MotionSettings,
) -> Vec<(MotionValue, MotionSettings)> {
    let copied = motion.borrow().clone();
    let settings = copied.settings.or(defaults);
    match &copied.way {
        // A batch that cannot be planned is not split, so that its reason is reported.
        MotionPath::Batch(motions) if copied.obstacle.is_none() => {
            motions.iter().flat_map(|motion| members(motion, &settings)).collect()
        }
        _ => vec![(copied, settings)],
    }
}

fn circ(aux: TargetRef, to: TargetRef, settings: &MotionSettings) -> Circ {
    Circ {
        aux,
        to,
        angle_rad: settings.circ_angle_rad,
        turns_with_path: settings.turns_with_path.unwrap_or_default(),
        aux_orientation: settings.aux_orientation.unwrap_or_default(),
        extrapolates: false,
    }
}

fn in_foot(frame: Frame) -> Target {
    Target { base: Some(FOOT.to_owned()), ..Target::at(frame) }
}

fn destination_of(target: Target) -> Destination {
    Destination {
        pose: target.frame.pose(),
        e1_rad: target.e1_rad,
        status: target.status,
        target: TargetRef::Given(target),
    }
}

/// Returns the blend of a PTP motion: the Cartesian one, if several are set.
fn one_blend(blending: &Blending) -> Option<Blend> {
    blending.cart_mm.map(Blend::CartMm).or(blending.rel.map(Blend::SunriseRel))
}

/// Returns the blend of a path.
fn path_blend(blending: &Blending) -> Option<PathBlend> {
    let blend = PathBlend {
        cart_mm: blending.cart_mm,
        orientation_rad: blending.orientation_rad,
        sunrise_rel: blending.rel,
        fraction: None,
    };
    (*blending != Blending::default()).then_some(blend)
}
