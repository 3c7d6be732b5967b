//! Motions as Java expressions.

use std::fmt::Write as _;

use iiwa_program::{
    AuxOrientation, ByKind, CartesianMotion, Circ, Course, Frame, LimitKind, MotionIndex,
    NameFault, OrientationType, PathBlend, Ptp, SegmentCourse, SplineSegment, TargetRef,
    ToolLimits,
};

use super::{
    cell::WorldTree,
    error::ExportError,
    imports::ExportedImports,
    literal::{angle, millimetres, number, text},
};

/// Call with its argument motions, and the setters on its result.
pub(super) struct MotionCall {
    call: String,
    segments: Vec<Self>,
    setters: Vec<String>,
}

/// Maximum line width of the program, where lines can be broken.
const WIDTH: usize = 110;

impl MotionCall {
    fn new(call: String) -> Self {
        Self { call, segments: Vec::new(), setters: Vec::new() }
    }

    fn set(&mut self, name: &str, value: &str) {
        self.setters.push(format!(".{name}({value})"));
    }

    /// Returns the statement with this call as argument: `before`, the call, `);`.
    pub(super) fn statement(&self, before: &str, indent: usize) -> String {
        format!("{:indent$}{before}{});", "", self.written(indent, before.len() + 2))
    }

    /// Formats the call at `indent`, with `around` more characters on its line.
    fn written(&self, indent: usize, around: usize) -> String {
        let deeper = indent + 8;
        let mut written = self.call.clone();
        if !self.segments.is_empty() {
            let segment = |it: &Self| format!("\n{:deeper$}{}", "", it.written(deeper, 2));
            let segments = self.segments.iter().map(segment).collect::<Vec<_>>();
            written = format!("{written}{})", segments.join(","));
        }
        let one_line = self.setters.concat();
        let fits = indent + around + written.len() + one_line.len() <= WIDTH;
        if fits {
            written += &one_line;
        } else {
            for setter in &self.setters {
                let _ = write!(written, "\n{:deeper$}{setter}", "");
            }
        }
        written
    }
}

/// Writes motions, with their frames in the project tree.
pub(super) struct MotionWriter<'a, 'p> {
    pub(super) tree: &'a mut WorldTree<'p>,
    pub(super) imports: &'a mut ExportedImports,
    /// Current motion.
    pub(super) motion: MotionIndex,
    /// Base of the current motion.
    pub(super) base: Option<&'p str>,
}

type WrittenMotion = Result<MotionCall, ExportError>;

impl MotionWriter<'_, '_> {
    /// Writes a PTP motion to joint positions. Without `blends` the robot stops at its end.
    pub(super) fn ptp(&mut self, ptp: &Ptp, blends: bool) -> WrittenMotion {
        self.imports.basic_motion("ptp");
        let mut written = MotionCall::new(format!("ptp({})", ptp.target_rad.map(angle).join(", ")));
        for kind in LimitKind::ALL {
            share(&mut written, kind, ptp.share(kind));
        }
        if let Some(blend) = ptp.blend.filter(|_| blends) {
            self.blend(&mut written, &blend.into())?;
        }
        Ok(written)
    }

    /// Writes a motion to a frame. Without `blends` the robot stops at its end.
    pub(super) fn cartesian(&mut self, cartesian: &CartesianMotion, blends: bool) -> WrittenMotion {
        let number = self.motion.number();
        let mut written = match &cartesian.course {
            Course::Ptp { to } => {
                if cartesian.tool_limits != ToolLimits::NONE {
                    return self.not_in_sunrise(
                        "frame",
                        "a point-to-point motion has no limits of the TCP in Sunrise",
                    );
                }
                self.going("ptp", to, &format!("P{number}"))?
            }
            Course::Lin { to } => self.going("lin", to, &format!("P{number}"))?,
            Course::LinRel { offset, e1_rad: None, within } => {
                self.lin_rel(offset, within.as_ref())?
            }
            Course::LinRel { .. } => {
                return self.not_in_sunrise(
                    "e1_deg",
                    "a relative motion keeps E1 in Sunrise; give the frame with `lin`",
                );
            }
            Course::Circ(circ) => self.circ(circ, &format!("P{number}"))?,
            Course::Spline(segments) if cartesian.is_single_spl() => match segments.as_slice() {
                [SplineSegment { course: SegmentCourse::Spl { to }, .. }] => {
                    self.going("spl", to, &format!("P{number}"))?
                }
                segments => self.spline(segments)?,
            },
            Course::Spline(segments) => self.spline(segments)?,
        };
        if cartesian.orientation != OrientationType::default() && !cartesian.is_ptp() {
            self.orientation(&mut written, cartesian.orientation)?;
        }
        for kind in LimitKind::ALL {
            share(&mut written, kind, &cartesian.shares[kind]);
        }
        tool_limits(&mut written, &cartesian.tool_limits);
        if let Some(blend) = cartesian.blend.filter(|_| blends) {
            self.blend(&mut written, &blend)?;
        }
        Ok(written)
    }

    fn not_in_sunrise<T>(&self, key: &'static str, why: &'static str) -> Result<T, ExportError> {
        Err(ExportError::NotInSunrise { motion: self.motion, key, why })
    }

    /// Returns the target frame of a motion.
    fn frame(
        &mut self,
        key: &'static str,
        target: &TargetRef,
        name: &str,
    ) -> Result<String, ExportError> {
        let path = self.tree.path(target, self.base, name);
        let path = path.map_err(|fault| self.name_error(key, fault))?;
        Ok(format!("getApplicationData().getFrame({})", text(&path)))
    }

    fn name_error(&self, key: &'static str, fault: NameFault) -> ExportError {
        ExportError::Name { motion: Some(self.motion), key, fault }
    }

    fn going(&mut self, method: &'static str, to: &TargetRef, name: &str) -> WrittenMotion {
        self.imports.basic_motion(method);
        Ok(MotionCall::new(format!("{method}({})", self.frame("frame", to, name)?)))
    }

    fn lin_rel(&mut self, offset: &Frame, within: Option<&TargetRef>) -> WrittenMotion {
        self.imports.basic_motion("linRel");
        let [x, y, z] = offset.xyz_mm.map(number);
        let mut arguments = if offset.abc_rad == [0.0; 3] {
            format!("{x}, {y}, {z}")
        } else {
            self.imports.class("com.kuka.roboticsAPI.geometricModel.math.Transformation");
            let [a, b, c] = offset.abc_rad.map(angle);
            format!("Transformation.ofRad({x}, {y}, {z}, {a}, {b}, {c})")
        };
        if let Some(within) = within {
            let name = format!("P{}_in", self.motion);
            let path = self.tree.reference_path(within, self.base, &name);
            let path = path.map_err(|fault| self.name_error("in", fault))?;
            let frame = if let Some(path) = path {
                format!("getApplicationData().getFrame({})", text(&path))
            } else {
                self.imports.class("com.kuka.roboticsAPI.geometricModel.World");
                "World.Current.getRootFrame()".to_owned()
            };
            arguments = format!("{arguments}, {frame}");
        }
        Ok(MotionCall::new(format!("linRel({arguments})")))
    }

    fn circ(&mut self, circ: &Circ, name: &str) -> WrittenMotion {
        if circ.aux_orientation != AuxOrientation::Consider {
            return self.not_in_sunrise(
                "aux_orientation",
                "only `consider`, the default of Sunrise, is exported: give `aux` angles (a \
                 position alone has none), and leave `aux_orientation` out",
            );
        }
        if circ.extrapolates {
            return self.not_in_sunrise(
                "end_orientation",
                "the Sunrise setting is not known; only `interpolate`, its default, is exported",
            );
        }
        self.imports.basic_motion("circ");
        let aux = self.frame("aux", &circ.aux, &format!("{name}_aux"))?;
        let to = self.frame("frame", &circ.to, name)?;
        let mut written = MotionCall::new(format!("circ({aux}, {to})"));
        if let Some(angle_rad) = circ.angle_rad {
            written.set("setCircAngle", &angle(angle_rad));
        }
        // KUKA does not publish the controller's default, so the system is always stated.
        self.imports.class("com.kuka.roboticsAPI.motionModel.OrientationReferenceSystem");
        let system = if circ.turns_with_path { "Path" } else { "Base" };
        written
            .set("setOrientationReferenceSystem", &format!("OrientationReferenceSystem.{system}"));
        Ok(written)
    }

    fn spline(&mut self, segments: &[SplineSegment]) -> WrittenMotion {
        self.imports.class("com.kuka.roboticsAPI.motionModel.Spline");
        let mut spline = MotionCall::new("new Spline(".to_owned());
        for (index, segment) in segments.iter().enumerate() {
            let name = format!("P{}_{}", self.motion, index + 1);
            let mut written = match &segment.course {
                SegmentCourse::Spl { to } => self.going("spl", to, &name)?,
                SegmentCourse::Lin { to } => self.going("lin", to, &name)?,
                SegmentCourse::Circ(circ) => self.circ(circ, &name)?,
            };
            if let Some(orientation) = segment.orientation {
                self.orientation(&mut written, orientation)?;
            }
            for kind in LimitKind::ALL {
                if let Some(shares) = &segment.limits.shares[kind] {
                    stated_share(&mut written, kind, shares);
                }
            }
            tool_limits(&mut written, &segment.limits.tool);
            spline.segments.push(written);
        }
        Ok(spline)
    }

    fn orientation(
        &mut self,
        written: &mut MotionCall,
        orientation: OrientationType,
    ) -> Result<(), ExportError> {
        let name = match orientation {
            OrientationType::Variable => "VariableOrientation",
            OrientationType::Constant => "Constant",
            OrientationType::Joints => "OriJoint",
            OrientationType::Ignore => "Ignore",
            _ => return self.not_in_sunrise("orientation", "Sunrise knows no such orientation"),
        };
        self.imports.class("com.kuka.roboticsAPI.motionModel.SplineOrientationType");
        written.set("setOrientationType", &format!("SplineOrientationType.{name}"));
        Ok(())
    }

    fn blend(&self, written: &mut MotionCall, blend: &PathBlend) -> Result<(), ExportError> {
        let PathBlend { cart_mm, orientation_rad, sunrise_rel, fraction } = *blend;
        if let Some(share) = fraction {
            // Sunrise's relative blending refers to half a motion.
            let relative = 2.0 * share;
            if share > 0.0 && relative < iiwa_program::SUNRISE_REL_MIN {
                return self.not_in_sunrise(
                    "blend",
                    "a `fraction` below 0.025 is a stop in Sunrise; leave the blend out, or \
                     enlarge it",
                );
            }
            written.set("setBlendingRel", &number(relative));
        }
        if let Some(relative) = sunrise_rel {
            written.set("setBlendingRel", &number(relative));
        }
        if let Some(radius_mm) = cart_mm {
            written.set("setBlendingCart", &number(radius_mm));
        }
        if let Some(orientation_rad) = orientation_rad {
            written.set("setBlendingOri", &angle(orientation_rad));
        }
        Ok(())
    }
}

/// Returns the name of a limit kind with a capital, for the names of Java methods.
fn capital(kind: LimitKind) -> String {
    let (first, rest) = kind.name().split_at(1);
    first.to_ascii_uppercase() + rest
}

/// Sets a fraction of the joint limits, unless it is 1 for all joints.
fn share(written: &mut MotionCall, kind: LimitKind, shares: &[f64; 7]) {
    if *shares != [1.0; 7] {
        stated_share(written, kind, shares);
    }
}

fn stated_share(written: &mut MotionCall, kind: LimitKind, shares: &[f64; 7]) {
    let value = if shares.iter().all(|share| *share == shares[0]) {
        number(shares[0])
    } else {
        format!("new double[] {{{}}}", shares.map(number).join(", "))
    };
    written.set(&format!("setJoint{}Rel", capital(kind)), &value);
}

fn tool_limits(written: &mut MotionCall, limits: &ToolLimits) {
    let mut set = |limits: &ByKind<f64>, name: &str, unit: fn(f64) -> String| {
        for (kind, limit) in limits {
            if limit.is_finite() {
                written.set(&format!("set{name}{}", capital(kind)), &unit(*limit));
            }
        }
    };
    set(&limits.way, "Cart", millimetres);
    set(&limits.turn, "Orientation", angle);
}
