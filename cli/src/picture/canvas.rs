//! What pictures have in common: size, colours, letters.

use plotters::{
    chart::ChartContext,
    coord::{Shift, cartesian::Cartesian2d, types::RangedCoordf64},
    prelude::{
        Color, DrawingArea, IntoDrawingArea, RGBColor, SVGBackend, SeriesLabelPosition, WHITE,
    },
};

use crate::failure::Failure;

/// Colours that the colour-blind can tell apart (Okabe and Ito), one a joint.
pub(crate) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(204, 121, 167),
    RGBColor(90, 90, 90),
];

/// From slow to fast.
const SLOW: RGBColor = RGBColor(68, 1, 84);
const MIDDLE: RGBColor = RGBColor(33, 145, 140);
const FAST: RGBColor = RGBColor(245, 190, 20);

pub(crate) const INK: RGBColor = RGBColor(60, 60, 60);
pub(crate) const SHADE: RGBColor = RGBColor(225, 232, 240);

/// The backend draws in whole units: it gets a larger canvas, which the picture then shows small.
pub(crate) const FINE: u32 = 4;

/// Radius of a circle at a blend's end, and length of a line in a legend.
pub(crate) const DOT: i32 = 20;
pub(crate) const DASH: i32 = 72;

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type Drawn = Result<(), Box<dyn std::error::Error>>;
pub(crate) type Chart<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A picture of so many pixels as SVG.
pub(crate) fn svg(
    width: u32,
    height: u32,
    draw: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root =
            SVGBackend::with_string(&mut svg, (FINE * width, FINE * height)).into_drawing_area();
        let failed = |error: &dyn std::error::Error| Failure::run("cannot draw the picture", error);
        root.fill(&WHITE).map_err(|error| failed(&error))?;
        draw(&root).map_err(|error| failed(&*error))?;
        root.present().map_err(|error| failed(&error))?;
    }
    let size = |factor: u32| format!("width=\"{}\" height=\"{}\"", factor * width, factor * height);
    Ok(svg.replacen(&size(FINE), &size(1), 1))
}

pub(crate) fn font() -> (&'static str, u32) {
    ("sans-serif", 15 * FINE)
}

pub(crate) fn legend(chart: &mut Chart<'_>, position: SeriesLabelPosition) -> Drawn {
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

/// The colour of a share of the speed limit.
pub(crate) fn shade(share: f64) -> RGBColor {
    let mix = |from: RGBColor, to: RGBColor, share: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let part = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))) as u8;
        RGBColor(part(from.0, to.0), part(from.1, to.1), part(from.2, to.2))
    };
    let share = share.clamp(0.0, 1.0);
    if share < 0.5 { mix(SLOW, MIDDLE, 2.0 * share) } else { mix(MIDDLE, FAST, 2.0 * share - 1.0) }
}
