//! Picture of a plan: TCP path, and joint speeds over time.

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_program::{PlacedFrame, Program};
use iiwa_traj::{PieceKind, Section};
use plotters::prelude::{
    ChartBuilder, Circle, Color, IntoFont, LineSeries, PathElement, Rectangle, Text,
};

use super::{
    AXES, Area, COLOURS, Chart, DrawResult, FINE, HEIGHT, INK, SHADE, Space, WIDTH, font,
    key::{LegendEntry, LegendSign, title_and_legend},
    mesh, shade, svg,
};
use crate::PictureError;

/// Radius of the circles at blend ends.
const DOT: i32 = 20;

/// Height of the TCP speed chart.
const TCP_HEIGHT: u32 = 220;

/// Maximum number of samples in a picture; longer programs are sampled more coarsely.
const SAMPLES: usize = 20_000;

/// Picture of a plan, drawn from a bounded number of samples that are taken while the plan is
/// computed: TCP path and joint speeds; for programs with frames also the TCP speed.
#[derive(Debug)]
pub struct PlanPicture {
    robot: Robot,
    step_s: f64,
    next_s: f64,
    samples: Vec<PictureSample>,
    blends: Vec<BlendMark>,
    frames: Vec<PlacedFrame>,
    has_tools: bool,
    has_frames: bool,
}

#[derive(Clone, Copy, Debug)]
struct PictureSample {
    t_s: f64,
    tcp_mm: [f64; 3],
    tcp_mm_s: f64,
    /// TCP in the flange frame.
    offset_m: [f64; 3],
    /// Joint speeds relative to their limits.
    speed: [f64; 7],
}

#[derive(Debug)]
struct BlendMark {
    start_s: f64,
    end_s: f64,
    ends_mm: [[f64; 3]; 2],
}

impl PlanPicture {
    /// Creates a picture of a plan for `robot`, without sections.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self {
            robot: robot.clone(),
            step_s: 0.004,
            next_s: 0.0,
            samples: Vec::new(),
            blends: Vec::new(),
            frames: Vec::new(),
            has_tools: false,
            has_frames: false,
        }
    }

    /// Adds the frames of a program, if it has any.
    #[must_use]
    pub fn with_frames(self, program: &Program) -> Self {
        let frames = program.placed_frames().unwrap_or_default();
        Self { frames, has_frames: program.has_frames(), ..self }
    }

    /// Adds the next section.
    pub fn add(&mut self, section: &Section) {
        let path = section.path();
        self.has_tools |= path.has_tools();
        while self.next_s <= section.end_s() {
            let state = section.at(self.next_s);
            let limits = &self.robot.limits().velocity_rad_s;
            self.samples.push(PictureSample {
                t_s: state.t_s,
                tcp_mm: self.tcp_mm(path.tcp(state.motion), &state.q),
                offset_m: path.tcp(state.motion).position_m,
                tcp_mm_s: if self.has_frames {
                    1e3 * self.robot.tcp_speed_m_s(path.tcp(state.motion), &state.q, &state.dq)
                } else {
                    0.0
                },
                speed: std::array::from_fn(|j| state.dq[j] / limits[j]),
            });
            self.next_s += self.step_s;
            if self.samples.len() >= SAMPLES {
                let mut keep = [true, false].into_iter().cycle();
                self.samples.retain(|_| keep.next().unwrap_or(true));
                self.step_s *= 2.0;
            }
        }
        for piece in section.pieces().iter().filter(|piece| piece.kind == PieceKind::Blend) {
            let (start_s, end_s) = (piece.start_s, piece.end_s);
            // A blend belongs to the motion that it leads into, with the TCP of that motion.
            let ends_mm =
                [start_s, end_s].map(|t_s| self.tcp_mm(path.tcp(piece.motion), &section.at(t_s).q));
            self.blends.push(BlendMark { start_s, end_s, ends_mm });
        }
    }

    /// Returns the position, in mm, of a TCP given in the flange frame.
    fn tcp_mm(&self, tcp: &Pose, joints_rad: &Joints) -> [f64; 3] {
        let place_m = match tcp.position_m {
            [0.0, 0.0, 0.0] => self.robot.flange_position(joints_rad),
            _ => self.robot.flange_pose(joints_rad).then(tcp).position_m,
        };
        place_m.map(|v| 1e3 * v)
    }

    /// Draws the picture as SVG.
    ///
    /// # Errors
    ///
    /// [`PictureError::Drawing`].
    pub fn draw(&self) -> Result<String, PictureError> {
        let height = if self.has_frames { HEIGHT + TCP_HEIGHT } else { HEIGHT };
        svg([WIDTH, height], |root| {
            let (top, bottom) = root.split_vertically(FINE * HEIGHT * 3 / 5);
            self.draw_path(&top)?;
            if !self.has_frames {
                return self.draw_speeds(&bottom);
            }
            let (joints, tcp) = bottom.split_vertically(FINE * HEIGHT * 2 / 5);
            self.draw_speeds(&joints)?;
            self.draw_tcp_speed(&tcp)
        })
    }

    /// Draws the TCP path in the plane that shows most of it, with the same scale on both axes.
    fn draw_path(&self, area: &Area<'_>) -> DrawResult {
        let space = Space::of(self.samples.iter().map(|sample| sample.tcp_mm));
        let [(across, up), ..] = space.planes();
        let subject = if self.has_tools { "TCP" } else { "flange" };
        let caption =
            format!("Path of the {subject}, coloured by the fastest joint's share of its limit");
        let mut entries: Vec<LegendEntry> = (0..=4_u8)
            .map(|step| f64::from(step) / 4.0)
            .map(|share| (share, shade(share).stroke_width(4 * FINE)))
            .map(|(share, style)| (LegendSign::Line, style, format!("{:.0} %", 100.0 * share)))
            .collect();
        if !self.blends.is_empty() {
            let text = "start and end of blends".to_owned();
            entries.push((LegendSign::Circle, INK.stroke_width(FINE), text));
        }
        let area = title_and_legend(area, &caption, &entries)?;
        let mut chart = space.chart(&area, (across, up))?;
        let point = |mm: [f64; 3]| (mm[across], mm[up]);
        for blend in &self.blends {
            for end in blend.ends_mm {
                chart.draw_series([Circle::new(point(end), DOT, INK.stroke_width(FINE))])?;
            }
        }
        let mut from = 0;
        for run in self.samples.chunk_by(|a, b| tone(a) == tone(b) && a.offset_m == b.offset_m) {
            // Each run of one colour extends to the first point of the next, unless that point
            // belongs to another TCP.
            let next = from + run.len();
            let goes_on = self.samples.get(next).is_some_and(|it| it.offset_m == run[0].offset_m);
            let to = if goes_on { next } else { next - 1 };
            let line: Vec<_> = self.samples[from..=to].iter().map(|s| point(s.tcp_mm)).collect();
            let colour = shade(f64::from(tone(&run[0])) / f64::from(TONES));
            chart.draw_series([PathElement::new(line, colour.stroke_width(3 * FINE))])?;
            from = next;
        }
        self.draw_frames(&mut chart, (across, up))
    }

    /// Draws the frame axes, x red, y green, z blue, and the frame names.
    fn draw_frames(&self, chart: &mut Chart<'_>, (across, up): (usize, usize)) -> DrawResult {
        /// Length of an axis, relative to the range of the chart.
        const AXIS: f64 = 0.04;
        /// Maximum number of frames; more would hide each other.
        const FRAMES: usize = 500;
        let shown = chart.x_range();
        let length = AXIS * (shown.end - shown.start);
        for frame in self.frames.iter().take(FRAMES) {
            let position_mm = frame.pose.position_m.map(|v| 1e3 * v);
            for (axis, colour) in AXES.iter().enumerate() {
                let end = |i: usize| position_mm[i] + length * frame.pose.rotation[i][axis];
                let line = [(position_mm[across], position_mm[up]), (end(across), end(up))];
                chart.draw_series([PathElement::new(line, colour.stroke_width(2 * FINE))])?;
            }
            if let Some(name) = &frame.name {
                let style = ("sans-serif", 12 * FINE).into_font().color(&INK);
                let place = (position_mm[across] + 0.2 * length, position_mm[up] - 0.2 * length);
                chart.draw_series([Text::new(name.clone(), place, style)])?;
            }
        }
        Ok(())
    }

    /// Draws the TCP speed.
    fn draw_tcp_speed(&self, area: &Area<'_>) -> DrawResult {
        let end = self.samples.last().map_or(1.0, |sample| sample.t_s).max(1e-3);
        let max_mm_s =
            self.samples.iter().fold(1e-3_f64, |max_mm_s, sample| max_mm_s.max(sample.tcp_mm_s));
        let mut chart = ChartBuilder::on(area)
            .caption("Speed of the TCP in mm/s", font())
            .margin(14 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(62 * FINE)
            .build_cartesian_2d(0.0..end, 0.0..1.05 * max_mm_s)?;
        mesh(&mut chart)
            .y_labels(5)
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc("time in s")
            .y_desc("mm/s")
            .draw()?;
        let points = self.samples.iter().map(|sample| (sample.t_s, sample.tcp_mm_s));
        chart.draw_series(LineSeries::new(points, COLOURS[0].stroke_width(2 * FINE)))?;
        Ok(())
    }

    /// Draws the joint speeds; blends are shaded.
    fn draw_speeds(&self, area: &Area<'_>) -> DrawResult {
        let end = self.samples.last().map_or(1.0, |sample| sample.t_s).max(1e-3);
        let moves = |joint: &usize| self.samples.iter().any(|sample| sample.speed[*joint] != 0.0);
        let moving: Vec<usize> = (0..COLOURS.len()).filter(moves).collect();
        let style = |joint: usize| COLOURS[joint].stroke_width(2 * FINE);
        let entry = |&joint: &usize| (LegendSign::Line, style(joint), format!("A{}", joint + 1));
        let entries: Vec<LegendEntry> = moving.iter().map(entry).collect();
        let title = "Joint speeds in % of their limits, blends shaded";
        let area = title_and_legend(area, title, &entries)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(14 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(62 * FINE)
            .build_cartesian_2d(0.0..end, -105.0..105.0)?;
        chart.draw_series(self.blends.iter().map(|blend| {
            Rectangle::new([(blend.start_s, -105.0), (blend.end_s, 105.0)], SHADE.filled())
        }))?;
        mesh(&mut chart)
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc("time in s")
            .y_desc("speed in %")
            .draw()?;
        for joint in moving {
            let points = self.samples.iter().map(|s| (s.t_s, 100.0 * s.speed[joint]));
            chart.draw_series(LineSeries::new(points, style(joint)))?;
        }
        Ok(())
    }
}

/// Colour steps from standstill to full speed.
const TONES: u8 = 40;

/// Returns the largest joint speed relative to its limit, in colour steps.
fn tone(sample: &PictureSample) -> u8 {
    let fastest = sample.speed.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to TONES")]
    let tone = (fastest.min(1.0) * f64::from(TONES)).round() as u8;
    tone
}
