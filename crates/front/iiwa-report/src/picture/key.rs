//! Titles and legends above charts, where they cover no curve.

use plotters::{
    prelude::{Circle, IntoTextStyle, PathElement, Text},
    style::ShapeStyle,
};

use super::{Area, DASH, FINE, font};

/// Radius of a circle.
const DOT: i32 = 20;

/// Margin above the title.
const TOP: u32 = 10 * FINE;

/// Gap between a mark and its text, and half the gap between entries.
const GAP: i32 = 32;

/// Sign of a curve in a legend.
#[derive(Clone, Copy)]
pub(super) enum LegendSign {
    Line,
    Circle,
}

/// Legend entry: sign, style and text.
pub(super) type LegendEntry = (LegendSign, ShapeStyle, String);

/// Draws a title and, below it, the legend in one row; returns the area that remains for the chart.
pub(super) fn title_and_legend<'a>(
    area: &Area<'a>,
    title: &str,
    entries: &[LegendEntry],
) -> Result<Area<'a>, Box<dyn std::error::Error>> {
    let area = area.margin(TOP, 0, 0, 0).titled(title, font())?;
    if entries.is_empty() {
        return Ok(area);
    }
    let (row, rest) = area.split_vertically(26 * FINE);
    let style = font().into_text_style(&row);
    let sizes = entries.iter().map(|(_, _, text)| row.estimate_text_size(text, &style));
    let widths = sizes.collect::<Result<Vec<_>, _>>()?;
    let widths = widths.into_iter().map(|(width, _)| i32::try_from(width).unwrap_or(0));
    let widths: Vec<i32> = widths.map(|width| DASH + 3 * GAP + width).collect();
    let (full, height) = row.dim_in_pixel();
    let middle = i32::try_from(height / 2)?;
    let mut x = (i32::try_from(full)? - widths.iter().sum::<i32>()) / 2;
    for ((sign, style_of_sign, text), width) in std::iter::zip(entries, widths) {
        match sign {
            LegendSign::Line => {
                let line = vec![(x, middle), (x + DASH, middle)];
                row.draw(&PathElement::new(line, *style_of_sign))?;
            }
            LegendSign::Circle => {
                row.draw(&Circle::new((x + DASH / 2, middle), DOT, *style_of_sign))?;
            }
        }
        let text_top = middle - i32::try_from(15 * FINE / 2)?;
        row.draw(&Text::new(text.clone(), (x + DASH + GAP, text_top), font()))?;
        x += width;
    }
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use plotters::prelude::Color;

    use super::*;
    use crate::picture::{COLOURS, svg};

    #[test]
    fn legends_are_above_their_charts() {
        let entries =
            COLOURS.map(|colour| (LegendSign::Line, colour.stroke_width(FINE), "A1".to_owned()));
        let mut top = 0;
        let drawn = svg([960, 540], |root| {
            let rest = title_and_legend(root, "Title", &entries)?;
            top = rest.get_pixel_range().1.start;
            assert!(rest.dim_in_pixel().1 > 450 * FINE, "{:?}", rest.dim_in_pixel());
            Ok(())
        });
        let drawn = drawn.unwrap();
        let lines: Vec<&str> = drawn.split("points=\"").skip(1).collect();
        assert_eq!(lines.len(), COLOURS.len());
        for line in lines {
            for point in line.split('"').next().unwrap().split_whitespace() {
                let (x, y) = point.split_once(',').unwrap();
                let [x, y] = [x, y].map(|value| value.parse::<f64>().unwrap());
                assert!(x > 0.0 && x < f64::from(960 * FINE), "{point}");
                assert!(y > 0.0 && y < f64::from(top), "{point}: the chart begins at {top}");
            }
        }
    }
}
