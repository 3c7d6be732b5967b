//! Common parts of pictures.

mod comparison;
mod format;
mod key;
mod picture_error;
#[cfg(feature = "optimise")]
mod place_map;
mod plan;
#[cfg(feature = "png-pdf")]
mod rendered;

use plotters::{
    chart::{ChartContext, MeshStyle},
    coord::{Shift, cartesian::Cartesian2d, types::RangedCoordf64},
    prelude::{ChartBuilder, Color, DrawingArea, IntoDrawingArea, RGBColor, SVGBackend, WHITE},
};

pub use comparison::draw as draw_comparison;
pub use format::PictureFormat;
pub use picture_error::PictureError;
#[cfg(feature = "optimise")]
pub use place_map::draw as draw_places;
pub use plan::PlanPicture;

/// Colours for the colour-blind (Okabe and Ito), one per joint.
pub(crate) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(204, 121, 167),
    RGBColor(90, 90, 90),
];

pub(crate) const INK: RGBColor = RGBColor(60, 60, 60);
/// Colours of frame axes: x, y, z.
const AXES: [RGBColor; 3] = [RGBColor(200, 40, 40), RGBColor(30, 140, 50), RGBColor(40, 90, 220)];
pub(crate) const SHADE: RGBColor = RGBColor(225, 232, 240);

/// Colours of planned or calculated, and of measured data: blue and red, as in the thesis (Larsen
/// 2019, Fig. 22).
pub(crate) const PLANNED: RGBColor = RGBColor(0, 114, 178);
pub(crate) const MEASURED: RGBColor = RGBColor(205, 30, 30);

/// Colours from slow to fast.
const SLOW: RGBColor = RGBColor(68, 1, 84);
const MIDDLE: RGBColor = RGBColor(33, 145, 140);
const FAST: RGBColor = RGBColor(245, 190, 20);

const WIDTH: u32 = 960;
const HEIGHT: u32 = 900;

/// Scale of the canvas: the backend draws in whole units, so the canvas is larger and the picture
/// shows it reduced.
pub(crate) const FINE: u32 = 4;

/// Length of a line in a legend.
pub(crate) const DASH: i32 = 72;

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type DrawResult = Result<(), Box<dyn std::error::Error>>;
pub(crate) type Chart<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws a picture of this size in pixels as SVG.
pub(crate) fn svg(
    [width, height]: [u32; 2],
    draw: impl FnOnce(&Area<'_>) -> DrawResult,
) -> Result<String, PictureError> {
    let mut svg = String::new();
    {
        let root =
            SVGBackend::with_string(&mut svg, (FINE * width, FINE * height)).into_drawing_area();
        root.fill(&WHITE).map_err(to_error)?;
        draw(&root).map_err(|error| to_error(error.to_string()))?;
        root.present().map_err(to_error)?;
    }
    let size = |factor: u32| format!("width=\"{}\" height=\"{}\"", factor * width, factor * height);
    Ok(svg.replacen(&size(FINE), &size(1), 1))
}

fn to_error(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> PictureError {
    PictureError::Drawing(error.into())
}

pub(crate) fn font() -> (&'static str, u32) {
    ("sans-serif", 15 * FINE)
}

/// Starts the axes and grid lines of a chart.
pub(crate) fn mesh<'a, 'b>(
    chart: &'b mut Chart<'a>,
) -> MeshStyle<'a, 'b, RangedCoordf64, RangedCoordf64, SVGBackend<'a>> {
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(WHITE.mix(0.0))
        .bold_line_style(SHADE.stroke_width(FINE))
        .axis_style(INK.stroke_width(FINE))
        .label_style(font());
    mesh
}

/// Returns the colour of a speed relative to its limit: dark for slow, bright for fast.
pub(crate) fn shade(share: f64) -> RGBColor {
    let mix = |from: RGBColor, to: RGBColor, share: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let part = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))) as u8;
        RGBColor(part(from.0, to.0), part(from.1, to.1), part(from.2, to.2))
    };
    let share = share.clamp(0.0, 1.0);
    if share < 0.5 { mix(SLOW, MIDDLE, 2.0 * share) } else { mix(MIDDLE, FAST, 2.0 * share - 1.0) }
}

/// Bounding box of points in mm.
struct Space {
    ranges: [(f64, f64); 3],
}

impl Space {
    fn of(points: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut ranges = [(f64::MAX, f64::MIN); 3];
        for point in points {
            for (range, v) in ranges.iter_mut().zip(point) {
                *range = (range.0.min(v), range.1.max(v));
            }
        }
        Self { ranges }
    }

    fn extent(&self, axis: usize) -> f64 {
        self.ranges[axis].1 - self.ranges[axis].0
    }

    /// Planes (across and up), in descending order of the visible area.
    fn planes(&self) -> [(usize, usize); 3] {
        let mut seen_along = [2, 1, 0];
        seen_along.sort_by(|a, b| self.extent(*a).total_cmp(&self.extent(*b)));
        seen_along.map(|axis| [(1, 2), (0, 2), (0, 1)][axis])
    }

    /// Creates a chart of a plane in mm, with the same scale on both axes.
    fn chart<'a>(
        &self,
        area: &Area<'a>,
        (across, up): (usize, usize),
    ) -> Result<Chart<'a>, Box<dyn std::error::Error>> {
        let (width, height) = area.dim_in_pixel();
        // Margins and labels beside the plot.
        let frame = [2 * 14 + 62, 2 * 14 + 44].map(|pixels| f64::from(FINE * pixels));
        let plot = (f64::from(width) - frame[0], f64::from(height) - frame[1]);
        let scale = (self.extent(across) / plot.0)
            .max(self.extent(up) / plot.1)
            .max(0.05 / f64::from(FINE))
            * 1.1;
        let axis = |axis: usize, pixels: f64| {
            let middle = 0.5 * (self.ranges[axis].0 + self.ranges[axis].1);
            middle - 0.5 * scale * pixels..middle + 0.5 * scale * pixels
        };
        let mut chart = ChartBuilder::on(area)
            .margin(14 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(62 * FINE)
            .build_cartesian_2d(axis(across, plot.0), axis(up, plot.1))?;
        let names = ["x", "y", "z"];
        mesh(&mut chart)
            .light_line_style(WHITE)
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc(format!("{} in mm", names[across]))
            .y_desc(format!("{} in mm", names[up]))
            .draw()?;
        Ok(chart)
    }
}
