//! Map of the cycle times at robot base positions.

use plotters::{
    prelude::{
        ChartBuilder, Circle, Color, EmptyElement, IntoFont, RGBColor, Rectangle, Text, WHITE,
    },
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{
    Area, DrawResult, FINE, HEIGHT, INK, SHADE, WIDTH, font,
    key::{LegendSign, title_and_legend},
    mesh, shade, svg,
};
use crate::{PictureError, PlaceReport, search::PlaceRow, signed::rounded};

/// Largest number of places along an axis with which cycle times are written into the map.
const MOST_WRITTEN: usize = 12;

/// Difference of cycle times from which on they have different colours, in s.
const LEAST_S: f64 = 1e-3;

/// Colour of places at which the arm is too near to an obstacle or to itself.
const NEAR: RGBColor = RGBColor(240, 160, 150);

/// Radius of the marks of places.
const MARK: u32 = 7 * FINE;

/// Distance of the middle of a cycle time below its place: marks do not cover it.
const BELOW: i32 = 64;

/// Draws the cycle times of a program at places along x and y as SVG: those with the z and the yaw
/// of the fastest place on the grid.
///
/// # Errors
///
/// [`PictureError::Drawing`].
pub fn draw(report: &PlaceReport) -> Result<String, PictureError> {
    svg([WIDTH, HEIGHT], |root| draw_map(root, report))
}

fn draw_map(root: &Area<'_>, report: &PlaceReport) -> DrawResult {
    let Some(layer) = report.layer() else { return Ok(()) };
    let times = layer.iter().filter_map(PlaceRow::accepted_time_s);
    let (fastest_s, slowest_s) = times
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), time| {
            (low.min(time), high.max(time))
        });
    let colour = |time_s: f64| {
        let range_s = slowest_s - fastest_s;
        shade(if range_s >= LEAST_S { (slowest_s - time_s) / range_s } else { 1.0 })
    };
    let mut legend = Vec::new();
    let mut times = vec![fastest_s];
    if slowest_s - fastest_s >= LEAST_S {
        times.extend([f64::midpoint(fastest_s, slowest_s), slowest_s]);
    }
    legend.extend(times.into_iter().filter(|time_s| time_s.is_finite()).map(|time_s| {
        (LegendSign::Line, colour(time_s).stroke_width(12 * FINE), format!("{time_s:.3} s"))
    }));
    if layer.iter().any(|place| place.cycle_time_s.is_none()) {
        legend.push((LegendSign::Line, SHADE.stroke_width(12 * FINE), "out of reach".to_owned()));
    }
    if layer.iter().any(PlaceRow::is_too_near) {
        legend.push((LegendSign::Line, NEAR.stroke_width(12 * FINE), "too near".to_owned()));
    }
    let [x, y] = &report.axes_mm;
    let edges = [edges(x, y), edges(y, x)];
    let [across, up] = edges.each_ref().map(|edges| edges[0]..edges[edges.len() - 1]);
    let PlaceRow { z_mm, yaw_deg, .. } = layer[0];
    let is_present = across.contains(&0.0) && up.contains(&0.0) && z_mm == 0.0 && yaw_deg == 0.0;
    if is_present {
        legend.push((LegendSign::Circle, INK.stroke_width(FINE), "present place".to_owned()));
    }
    if let Some(best) = &report.best {
        let name = if [best.z_mm, best.yaw_deg] == [z_mm, yaw_deg] {
            "fastest place".to_owned()
        } else {
            // It was found beside the grid.
            let [z_mm, yaw_deg] = [best.z_mm, best.yaw_deg].map(|value| rounded(value, 1));
            format!("fastest place, at z {z_mm} mm, yaw {yaw_deg} deg")
        };
        legend.push((LegendSign::Circle, INK.filled(), name));
    }
    let title = format!(
        "Cycle time with the robot's base moved by x and y, at z {z_mm} mm, yaw {yaw_deg} deg"
    );
    let area = title_and_legend(root, &title, &legend)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(14 * FINE)
        .x_label_area_size(44 * FINE)
        .y_label_area_size(62 * FINE)
        .build_cartesian_2d(across, up)?;
    mesh(&mut chart)
        .disable_mesh()
        .x_label_formatter(&|v| format!("{v:.0}"))
        .y_label_formatter(&|v| format!("{v:.0}"))
        .x_desc("x in mm")
        .y_desc("y in mm")
        .draw()?;
    let cells = layer.iter().enumerate().map(|(index, place)| {
        let [column, row] = [index % x.len(), index / x.len()];
        let corners = [0, 1].map(|end| (edges[0][column + end], edges[1][row + end]));
        let fill = match place.cycle_time_s {
            Some(_) if place.is_too_near() => NEAR,
            Some(time_s) => colour(time_s),
            None => SHADE,
        };
        Rectangle::new(corners, fill.filled())
    });
    chart.draw_series(cells)?;
    if x.len().max(y.len()) <= MOST_WRITTEN {
        let texts = layer.iter().filter_map(|place| {
            let time_s = place.accepted_time_s()?;
            // On dark colours, white is readable.
            let is_dark = slowest_s - fastest_s >= LEAST_S && slowest_s + fastest_s < 2.0 * time_s;
            let style = font().into_font().color(if is_dark { &WHITE } else { &INK });
            let style = style.pos(Pos::new(HPos::Center, VPos::Center));
            let text = Text::new(format!("{time_s:.3}"), (0, BELOW), style);
            Some(EmptyElement::at((place.x_mm, place.y_mm)) + text)
        });
        chart.draw_series(texts)?;
    }
    if is_present {
        chart.draw_series([Circle::new((0.0, 0.0), MARK, INK.stroke_width(FINE))])?;
    }
    if let Some(PlaceRow { x_mm, y_mm, .. }) = report.best {
        chart.draw_series([Circle::new((x_mm, y_mm), MARK, INK.filled())])?;
    }
    Ok(())
}

/// Returns the edges of the cells about places along an axis, in mm: half-way between them. A
/// single place has a cell as wide as those of the other axis.
fn edges(places_mm: &[f64], others_mm: &[f64]) -> Vec<f64> {
    let step = |places: &[f64]| (places.len() > 1).then(|| places[1] - places[0]);
    let step_mm = step(places_mm).or_else(|| step(others_mm)).unwrap_or(1.0);
    let first = places_mm.first().map(|place_mm| place_mm - 0.5 * step_mm);
    first.into_iter().chain(places_mm.iter().map(|place_mm| place_mm + 0.5 * step_mm)).collect()
}
