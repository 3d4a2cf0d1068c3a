//! Error curves as SVG: both axes logarithmic, a line a method, a band between its quartiles.

use plotters::coord::CoordTranslate;
use plotters::prelude::*;
use plotters::style::{FontFamily, RGBAColor};

use crate::{Curve, Group, Results, StudyError};

/// What a curve runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Median seconds by the study's clock.
    Seconds,
    /// Median of samples a pixel.
    Samples,
}

/// Columns and rows.
const SIZE: (u32, u32) = (560, 400);

/// Okabe and Ito's colours, which most people can tell apart, and darker ones of them.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
    RGBColor(120, 60, 0),
    RGBColor(0, 80, 60),
    RGBColor(110, 40, 90),
];

/// A point of a curve: x, then lower quartile, median, upper quartile, all > 0.
type Point = (f64, [f64; 3]);

/// The curves of a scene; `None` if nothing can be drawn on logarithmic axes (errors of 0, times of 0).
///
/// # Errors
/// If the drawing fails.
pub fn chart(
    results: &Results,
    scene: usize,
    shown: impl Into<Curve>,
    axis: Axis,
) -> Result<Option<String>, StudyError> {
    let shown = shown.into();
    let curves: Vec<Vec<Point>> = (0..results.study.methods.len())
        .map(|method| curve(&results.scenes[scene].groups, method, shown, axis))
        .collect();
    let points = || curves.iter().flatten();
    if points().next().is_none() {
        return Ok(None);
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
        (low / 1.25)..(high * 1.25)
    };
    let x = range(&mut points().map(|p| p.0));
    let y = range(&mut points().flat_map(|p| p.1));
    let name = match axis {
        Axis::Seconds if results.study.budgets.unit.is_time() => results.study.budgets.unit.name(),
        Axis::Seconds => "seconds",
        Axis::Samples => "samples a pixel",
    };
    let mut svg = String::new();
    let labels: Vec<&str> = results
        .study
        .methods
        .iter()
        .map(|m| m.name.as_str())
        .collect();
    draw(&mut svg, &curves, &labels, (x, y), (name, shown.name()))
        .map_err(|message| StudyError::page("chart", message))?;
    Ok(Some(svg))
}

fn curve(groups: &[Group], method: usize, shown: Curve, axis: Axis) -> Vec<Point> {
    let groups = groups.iter().filter(|group| group.method == method);
    groups
        .filter_map(|group| {
            let q = group.point(shown)?;
            let x = match axis {
                Axis::Seconds => group.seconds(),
                Axis::Samples => group.per_pixel(),
            };
            // an estimate with halves may come out at or below zero: no place on this axis
            let drawn = [q.lower.max(1e-3 * q.median), q.median, q.upper];
            let sound = x > 0.0 && x.is_finite() && drawn.iter().all(|v| v.is_finite() && *v > 0.0);
            sound.then_some((x, drawn))
        })
        .collect()
}

type Ranges = (std::ops::Range<f64>, std::ops::Range<f64>);

fn draw(
    svg: &mut String,
    curves: &[Vec<Point>],
    labels: &[&str],
    (x, y): Ranges,
    (x_name, y_name): (&str, &str),
) -> Result<(), String> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(failed)?;
    let font = (FontFamily::SansSerif, 15);
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(68)
        .build_cartesian_2d(
            x.clone().log_scale().with_key_points(ticks(&x)),
            y.clone().log_scale().with_key_points(ticks(&y)),
        )
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(RGBAColor(0, 0, 0, 0.06))
        .bold_line_style(RGBAColor(0, 0, 0, 0.15))
        .label_style(font)
        .axis_desc_style(font)
        .x_desc(x_name)
        .y_desc(y_name)
        .x_label_formatter(&|v| number(*v))
        .y_label_formatter(&|v| number(*v))
        .draw()
        .map_err(failed)?;
    for (index, (points, label)) in curves.iter().zip(labels).enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        draw_curve(&mut chart, points, label, colour)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(RGBAColor(0, 0, 0, 0.2))
        .label_font(font)
        .draw()
        .map_err(failed)?;
    root.present().map_err(failed)
}

/// A line through the medians, with a dot at each, over a band between the quartiles.
fn draw_curve<'a, C: CoordTranslate<From = (f64, f64)>>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, C>,
    points: &[Point],
    label: &str,
    colour: RGBColor,
) -> Result<(), String> {
    let upper = points.iter().map(|p| (p.0, p.1[2]));
    let lower = points.iter().rev().map(|p| (p.0, p.1[0]));
    let band: Vec<(f64, f64)> = upper.chain(lower).collect();
    if points.len() > 1 {
        let band = Polygon::new(band, colour.mix(0.15));
        chart.draw_series([band]).map_err(failed)?;
    }
    let line: Vec<(f64, f64)> = points.iter().map(|p| (p.0, p.1[1])).collect();
    let dots = line.iter().map(|&at| Circle::new(at, 3, colour.filled()));
    chart.draw_series(dots).map_err(failed)?;
    let line = PathElement::new(line, colour.stroke_width(2));
    chart
        .draw_series([line])
        .map_err(failed)?
        .label(label)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    Ok(())
}

fn failed(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Where a logarithmic axis has labels: at powers of ten, or more often if that gives fewer than three.
fn ticks(range: &std::ops::Range<f64>) -> Vec<f64> {
    const STEPS: [&[f64]; 3] = [
        &[1.0],
        &[1.0, 2.0, 5.0],
        &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
    ];
    let (low, high) = (
        range.start.log10().floor() as i32,
        range.end.log10().ceil() as i32,
    );
    let mut ticks = Vec::new();
    for steps in STEPS {
        let decade = |power: i32| steps.iter().map(move |step| step * 10f64.powi(power));
        ticks = (low..=high)
            .flat_map(decade)
            .filter(|v| range.contains(v))
            .collect();
        if ticks.len() >= 3 {
            break;
        }
    }
    ticks
}

/// Short: `0.01`, `25`, `1e-5`.
pub(crate) fn number(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}").replace(".0e", "e");
    }
    let digits = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.01, "0.01"),
            (25.0, "25"),
            (1e-5, "1e-5"),
            (0.0, "0"),
            (1.25, "1.25"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(number(123_456.0), "1.2e5");
        assert_eq!(number(-0.5), "-0.5");
    }

    #[test]
    fn axes_have_labels() {
        assert_eq!(ticks(&(0.5..2000.0)), [1.0, 10.0, 100.0, 1000.0]);
        assert_eq!(ticks(&(0.9..11.0)), [1.0, 2.0, 5.0, 10.0]);
        assert_eq!(ticks(&(1.2..3.5)), [1.5, 2.0, 3.0]);
        for low in [1.3e-7, 0.11, 8.0, 4.2e6] {
            assert!(ticks(&(low..2.6 * low)).len() >= 2, "{low}");
        }
    }

    #[test]
    fn names_of_strangers_are_escaped() {
        let mut svg = String::new();
        let curves = [vec![(1.0, [1.0, 2.0, 3.0]), (2.0, [0.5, 1.0, 1.5])]];
        let ranges = (0.5..4.0, 0.1..5.0);
        draw(&mut svg, &curves, &["<script>&\"'"], ranges, ("x", "y")).unwrap();
        assert!(
            !svg.contains("<script>") && svg.contains("&lt;script&gt;"),
            "{svg}"
        );
        assert!(svg.contains("<polygon") && svg.contains("<circle"));
        assert!(
            svg.contains("\n1\n") && svg.contains("\n0.2\n"),
            "labels of both axes: {svg}"
        );
    }
}
