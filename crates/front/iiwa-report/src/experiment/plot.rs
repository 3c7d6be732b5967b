//! Plots of points, lines and bands.

use std::ops::Range;

use plotters::prelude::{
    ChartBuilder, Circle, Color, PathElement, Polygon, RGBColor, SeriesLabelPosition, Text, WHITE,
};

use crate::picture::{Area, Chart, DASH, DrawResult, FINE, SHADE, font, mesh, svg};

use super::error::ExperimentError;

/// Radius of a circle.
const DOT: i32 = 20;

pub(crate) type PlotPoint = (f64, f64);

/// Plot: axes and its layers, in drawing order.
pub(crate) struct Plot {
    caption: String,
    axes: [String; 2],
    ranges: Option<[Range<f64>; 2]>,
    /// `true` for the same scale on both axes.
    equal: bool,
    legend_at: SeriesLabelPosition,
    layers: Vec<Layer>,
    notes: Vec<(PlotPoint, String)>,
}

struct Layer {
    kind: Mark,
    colour: RGBColor,
    /// Parts, drawn without connecting lines.
    parts: Vec<Vec<PlotPoint>>,
    label: Option<String>,
}

#[derive(Clone, Copy)]
enum Mark {
    /// Line of this width in pixels.
    Line(f64),
    Dots,
    Circles,
    /// Area between a lower and an upper line: forward along one, back along the other.
    Band,
}

impl Plot {
    pub(crate) fn new(caption: impl Into<String>, across: &str, up: &str) -> Self {
        Self {
            caption: caption.into(),
            axes: [across, up].map(str::to_owned),
            ranges: None,
            equal: false,
            legend_at: SeriesLabelPosition::UpperRight,
            layers: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Restricts the plot to these ranges.
    pub(crate) fn within(mut self, across: Range<f64>, up: Range<f64>) -> Self {
        self.ranges = Some([across, up]);
        self
    }

    pub(crate) fn equal_scale(mut self) -> Self {
        self.equal = true;
        self
    }

    pub(crate) fn legend_at(mut self, position: SeriesLabelPosition) -> Self {
        self.legend_at = position;
        self
    }

    pub(crate) fn lines(
        self,
        parts: Vec<Vec<PlotPoint>>,
        colour: RGBColor,
        width: f64,
        label: &str,
    ) -> Self {
        self.layer(Mark::Line(width), parts, colour, label)
    }

    pub(crate) fn line(
        self,
        points: Vec<PlotPoint>,
        colour: RGBColor,
        width: f64,
        label: &str,
    ) -> Self {
        self.lines(vec![points], colour, width, label)
    }

    pub(crate) fn dots(self, points: Vec<PlotPoint>, colour: RGBColor, label: &str) -> Self {
        self.layer(Mark::Dots, vec![points], colour, label)
    }

    pub(crate) fn circles(self, points: Vec<PlotPoint>, colour: RGBColor, label: &str) -> Self {
        self.layer(Mark::Circles, vec![points], colour, label)
    }

    pub(crate) fn band(
        self,
        lower: &[PlotPoint],
        upper: &[PlotPoint],
        colour: RGBColor,
        label: &str,
    ) -> Self {
        let around = lower.iter().chain(upper.iter().rev()).copied().collect();
        self.layer(Mark::Band, vec![around], colour, label)
    }

    /// Adds a text beside a point.
    pub(crate) fn note(mut self, position: PlotPoint, text: impl Into<String>) -> Self {
        self.notes.push((position, text.into()));
        self
    }

    fn layer(
        mut self,
        kind: Mark,
        parts: Vec<Vec<PlotPoint>>,
        colour: RGBColor,
        label: &str,
    ) -> Self {
        let label = (!label.is_empty()).then(|| label.to_owned());
        self.layers.push(Layer { kind, colour, parts, label });
        self
    }

    /// Ranges of the axes, before their scales are equalised.
    fn ranges(&self) -> [Range<f64>; 2] {
        if let Some(ranges) = &self.ranges {
            return ranges.clone();
        }
        let points = || self.layers.iter().flat_map(|layer| layer.parts.iter().flatten());
        let range = |coordinate: fn(&PlotPoint) -> f64| {
            let low = points().map(coordinate).fold(f64::INFINITY, f64::min);
            let high = points().map(coordinate).fold(f64::NEG_INFINITY, f64::max);
            let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
            let margin = (0.05 * (high - low)).max(1e-9 * high.abs()).max(1e-9);
            low - margin..high + margin
        };
        [range(|point| point.0), range(|point| point.1)]
    }

    fn draw(&self, area: &Area<'_>) -> DrawResult {
        let (width, height) = area.dim_in_pixel();
        let frame = (f64::from(FINE) * 100.0, f64::from(FINE) * 92.0);
        let (width, height) = (f64::from(width) - frame.0, f64::from(height) - frame.1);
        let mut ranges = self.ranges();
        let unit = |range: &Range<f64>, pixels: f64| (range.end - range.start) / pixels;
        if self.equal {
            let scale = unit(&ranges[0], width).max(unit(&ranges[1], height));
            for (range, pixels) in ranges.iter_mut().zip([width, height]) {
                let middle = 0.5 * (range.start + range.end);
                *range = middle - 0.5 * scale * pixels..middle + 0.5 * scale * pixels;
            }
        }
        let [across, up] = ranges;
        // Size of a pixel, in units of the axes.
        let pixel = [unit(&across, width), unit(&up, height)].map(|size| size * f64::from(FINE));
        let mut chart = ChartBuilder::on(area)
            .caption(&self.caption, font())
            .margin(14 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(66 * FINE)
            .build_cartesian_2d(across.clone(), up.clone())?;
        let labels = [decimals(&across), decimals(&up)];
        mesh(&mut chart)
            .x_labels(8)
            .y_labels(8)
            .x_label_formatter(&|v| number(*v, labels[0]))
            .y_label_formatter(&|v| number(*v, labels[1]))
            .x_desc(&self.axes[0])
            .y_desc(&self.axes[1])
            .draw()?;
        let inside = |point: &PlotPoint| {
            (across.start..=across.end).contains(&point.0) && (up.start..=up.end).contains(&point.1)
        };
        for layer in &self.layers {
            let colour = layer.colour;
            let stroke = match layer.kind {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small"
                )]
                Mark::Line(width) => colour.stroke_width((width * f64::from(FINE)) as u32),
                _ => colour.stroke_width(FINE + FINE / 2),
            };
            for part in &layer.parts {
                match layer.kind {
                    Mark::Line(_) => {
                        // The backend would distort lines that leave the picture.
                        for run in part.split(|point| !inside(point)).filter(|run| run.len() > 1) {
                            chart.draw_series([PathElement::new(thinned(run, pixel), stroke)])?;
                        }
                    }
                    Mark::Dots => {
                        let dots = part.iter().filter(|point| inside(point));
                        chart.draw_series(
                            dots.map(|center| Circle::new(*center, DOT * 3 / 5, colour.filled())),
                        )?;
                    }
                    Mark::Circles => {
                        let circles = part.iter().filter(|point| inside(point));
                        chart
                            .draw_series(circles.map(|center| Circle::new(*center, DOT, stroke)))?;
                    }
                    Mark::Band => {
                        chart
                            .draw_series([Polygon::new(thinned(part, pixel), colour.mix(0.25))])?;
                    }
                }
            }
            let Some(label) = &layer.label else { continue };
            let entry =
                chart.draw_series(std::iter::empty::<Circle<PlotPoint, i32>>())?.label(label);
            match layer.kind {
                Mark::Line(_) => {
                    entry.legend(move |(x, y)| PathElement::new([(x, y), (x + DASH, y)], stroke))
                }
                Mark::Dots => entry.legend(move |(x, y)| {
                    Circle::new((x + DASH / 2, y), DOT * 3 / 5, colour.filled())
                }),
                Mark::Circles => {
                    entry.legend(move |(x, y)| Circle::new((x + DASH / 2, y), DOT, stroke))
                }
                Mark::Band => entry.legend(move |(x, y)| {
                    let (top, bottom) = (y - DOT, y + DOT);
                    let corners = [(x, top), (x + DASH, top), (x + DASH, bottom), (x, bottom)];
                    Polygon::new(corners, colour.mix(0.25))
                }),
            };
        }
        chart.draw_series(
            self.notes.iter().map(|(position, text)| Text::new(text.clone(), *position, font())),
        )?;
        if self.layers.iter().any(|layer| layer.label.is_some()) {
            legend(&mut chart, self.legend_at.clone())?;
        }
        Ok(())
    }
}

/// Draws plots in rows, in a picture of this size in pixels.
pub(crate) fn draw(
    plots: &[Plot],
    columns: usize,
    width: u32,
    height: u32,
) -> Result<String, ExperimentError> {
    let rows = plots.len().div_ceil(columns.max(1));
    let drawn = svg([width, height], |root| {
        for (area, plot) in root.split_evenly((rows, columns)).iter().zip(plots) {
            plot.draw(area)?;
        }
        Ok(())
    });
    Ok(drawn?)
}

fn legend(chart: &mut Chart<'_>, position: SeriesLabelPosition) -> DrawResult {
    chart
        .configure_series_labels()
        .position(position)
        .legend_area_size(30 * FINE)
        .margin(8 * FINE)
        .background_style(WHITE.mix(0.85))
        .border_style(SHADE.stroke_width(FINE))
        .label_font(font())
        .draw()?;
    Ok(())
}

/// Returns the number of decimals that distinguish the numbers along an axis.
fn decimals(range: &Range<f64>) -> usize {
    let step = (range.end - range.start) / 8.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 6")]
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    decimals
}

fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // No minus sign before zero.
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        return text.trim_start_matches('-').to_owned();
    }
    text
}

/// Reduces a line to its visible points: omitted points are less than a quarter of a pixel from it
/// (Douglas and Peucker 1973).
fn thinned(line: &[PlotPoint], pixel: [f64; 2]) -> Vec<PlotPoint> {
    const BESIDE: f64 = 0.25;
    let place = |point: PlotPoint| (point.0 / pixel[0], point.1 / pixel[1]);
    let mut keep = vec![false; line.len()];
    let mut parts = vec![(0, line.len().saturating_sub(1))];
    while let Some((first, last)) = parts.pop() {
        if let Some(keep) = keep.get_mut(first) {
            *keep = true;
        }
        if last <= first {
            continue;
        }
        keep[last] = true;
        let (a, b) = (place(line[first]), place(line[last]));
        let along = (b.0 - a.0, b.1 - a.1);
        let square = along.0 * along.0 + along.1 * along.1;
        let beside = |i: &usize| {
            let p = place(line[*i]);
            let to = (p.0 - a.0, p.1 - a.1);
            let dot = to.0 * along.0 + to.1 * along.1;
            let share = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
            (to.0 - share * along.0).hypot(to.1 - share * along.1)
        };
        let farthest = (first + 1..last).max_by(|a, b| beside(a).total_cmp(&beside(b)));
        if let Some(i) = farthest.filter(|i| beside(i) > BESIDE) {
            parts.extend([(first, i), (i, last)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_corners() {
        let line: Vec<PlotPoint> = (0..=200)
            .map(|i| f64::from(i) / 100.0)
            .map(|x| (x, if x < 1.0 { 0.0 } else { x - 1.0 }))
            .collect();
        assert_eq!(thinned(&line, [0.01, 0.01]), [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]);
        assert_eq!(thinned(&line[..1], [1.0, 1.0]), line[..1]);
        assert!(thinned(&[], [1.0, 1.0]).is_empty());
    }

    #[test]
    fn numbers_along_axes() {
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-0.5, 1), "-0.5");
        assert_eq!((decimals(&(0.0..100.0)), decimals(&(0.0..0.5))), (0, 2));
    }
}
