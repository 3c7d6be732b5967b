//! A picture of a plan: the path of the flange, and the joints' speeds over time.

use iiwa_kin::Robot;
use iiwa_traj::{PieceKind, Section};
use plotters::prelude::{
    ChartBuilder, Circle, Color, LineSeries, PathElement, Rectangle, SeriesLabelPosition, WHITE,
};

use super::{
    Area, COLOURS, DASH, Drawn, FINE, HEIGHT, INK, SHADE, Space, WIDTH, font, legend, shade, svg,
};
use crate::ViewError;

/// Radius of a circle at a blend's end.
const DOT: i32 = 20;

/// Samples that a picture can show; a longer program is thinned out.
const SAMPLES: usize = 20_000;

/// A picture of a plan, drawn from a bounded number of samples that are taken while it is made: the path of
/// the flange, and the joints' speeds.
#[derive(Debug)]
pub struct PlanPicture {
    robot: Robot,
    step_s: f64,
    next_s: f64,
    samples: Vec<Sample>,
    blends: Vec<BlendMark>,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    t_s: f64,
    tcp_mm: [f64; 3],
    /// Share of each joint's speed limit.
    speed: [f64; 7],
}

#[derive(Debug)]
struct BlendMark {
    start_s: f64,
    end_s: f64,
    ends_mm: [[f64; 3]; 2],
}

impl PlanPicture {
    /// A picture of a plan for `robot`, without any section yet.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self {
            robot: robot.clone(),
            step_s: 0.004,
            next_s: 0.0,
            samples: Vec::new(),
            blends: Vec::new(),
        }
    }

    /// Takes in the next section.
    pub fn add(&mut self, section: &Section) {
        while self.next_s <= section.end_s() {
            let state = section.at(self.next_s);
            let limits = &self.robot.limits().velocity_rad_s;
            self.samples.push(Sample {
                t_s: state.t_s,
                tcp_mm: self.robot.flange_position(&state.q).map(|v| 1e3 * v),
                speed: std::array::from_fn(|j| state.dq[j] / limits[j]),
            });
            self.next_s += self.step_s;
            if self.samples.len() >= SAMPLES {
                let mut keep = [true, false].into_iter().cycle();
                self.samples.retain(|_| keep.next().unwrap_or(true));
                self.step_s *= 2.0;
            }
        }
        let tcp = |t_s| self.robot.flange_position(&section.at(t_s).q).map(|v| 1e3 * v);
        for piece in section.pieces().iter().filter(|piece| piece.kind == PieceKind::Blend) {
            let (start_s, end_s) = (piece.start_s, piece.end_s);
            self.blends.push(BlendMark { start_s, end_s, ends_mm: [tcp(start_s), tcp(end_s)] });
        }
    }

    /// The picture as SVG.
    ///
    /// # Errors
    ///
    /// [`ViewError::Draw`].
    pub fn draw(&self) -> Result<String, ViewError> {
        svg([WIDTH, HEIGHT], |root| {
            let (top, bottom) = root.split_vertically(FINE * HEIGHT * 3 / 5);
            self.draw_path(&top)?;
            self.draw_speeds(&bottom)
        })
    }

    /// The flange's path in the plane that shows most of it, with the same scale on both axes.
    fn draw_path(&self, area: &Area<'_>) -> Drawn {
        let space = Space::of(self.samples.iter().map(|sample| sample.tcp_mm));
        let [(across, up), ..] = space.planes();
        let caption = "Path of the flange, coloured by the fastest joint's share of its limit";
        let mut chart = space.chart(area, caption, (across, up))?;
        let point = |mm: [f64; 3]| (mm[across], mm[up]);
        for blend in &self.blends {
            for end in blend.ends_mm {
                chart.draw_series([Circle::new(point(end), DOT, INK.stroke_width(FINE))])?;
            }
        }
        let mut from = 0;
        for run in self.samples.chunk_by(|a, b| tone(a) == tone(b)) {
            // Each run of one colour reaches to the first point of the next.
            let to = (from + run.len()).min(self.samples.len() - 1);
            let line: Vec<_> = self.samples[from..=to].iter().map(|s| point(s.tcp_mm)).collect();
            let colour = shade(f64::from(tone(&run[0])) / f64::from(TONES));
            chart.draw_series([PathElement::new(line, colour.stroke_width(3 * FINE))])?;
            from = to;
        }
        for share in 0..=4 {
            let share = f64::from(share) / 4.0;
            chart
                .draw_series(LineSeries::new([], shade(share).stroke_width(4 * FINE)))?
                .label(format!("{:.0} %", 100.0 * share))
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + DASH, y)], shade(share).stroke_width(4 * FINE))
                });
        }
        if !self.blends.is_empty() {
            chart
                .draw_series([Circle::new(
                    point(self.blends[0].ends_mm[0]),
                    DOT,
                    INK.stroke_width(FINE),
                )])?
                .label("start and end of blends")
                .legend(|(x, y)| Circle::new((x + DASH / 2, y), DOT, INK.stroke_width(FINE)));
        }
        legend(&mut chart, SeriesLabelPosition::UpperRight)
    }

    /// The joints' speeds; blends are shaded.
    fn draw_speeds(&self, area: &Area<'_>) -> Drawn {
        let end = self.samples.last().map_or(1.0, |sample| sample.t_s).max(1e-3);
        let mut chart = ChartBuilder::on(area)
            .caption("Joint speeds in % of their limits, blends shaded", font())
            .margin(14 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(62 * FINE)
            .build_cartesian_2d(0.0..end, -105.0..105.0)?;
        chart.draw_series(self.blends.iter().map(|blend| {
            Rectangle::new([(blend.start_s, -105.0), (blend.end_s, 105.0)], SHADE.filled())
        }))?;
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .bold_line_style(SHADE.stroke_width(FINE))
            .axis_style(INK.stroke_width(FINE))
            .label_style(font())
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc("time in s")
            .y_desc("speed in %")
            .draw()?;
        for (joint, colour) in COLOURS.iter().enumerate() {
            if self.samples.iter().all(|sample| sample.speed[joint] == 0.0) {
                continue;
            }
            let points = self.samples.iter().map(|s| (s.t_s, 100.0 * s.speed[joint]));
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2 * FINE)))?
                .label(format!("A{}", joint + 1))
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + DASH, y)], colour.stroke_width(2 * FINE))
                });
        }
        legend(&mut chart, SeriesLabelPosition::UpperRight)
    }
}

/// Steps of colour from standstill to full speed.
const TONES: u8 = 40;

/// The fastest joint's share of its limit, in steps of colour.
fn tone(sample: &Sample) -> u8 {
    let fastest = sample.speed.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to TONES")]
    let tone = (fastest.min(1.0) * f64::from(TONES)).round() as u8;
    tone
}
