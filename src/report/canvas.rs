//! What the figures share: colours, lettering, marks, axis ranges, and the way from SVG to PNG.
//!
//! Marks and labels are placed in pixels, so that a mark looks the same in a panel and in the legend.

use std::ops::Range;
use std::sync::Arc;

use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::{tiny_skia, usvg};

/// A drawing area of the SVG being made.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Drawing into a string meets no device; the error type is `plotters`' all the same.
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

pub(super) const INK: RGBColor = RGBColor(34, 40, 49);
pub(super) const FAINT_INK: RGBColor = RGBColor(96, 104, 115);
pub(super) const GRID: RGBColor = RGBColor(226, 229, 233);
pub(super) const OURS: RGBColor = RGBColor(200, 32, 47);
pub(super) const SMITH: RGBColor = RGBColor(62, 106, 158);
pub(super) const OTHERS: RGBColor = RGBColor(158, 165, 174);

/// The SVG that `draw` makes on a white canvas of `size` pixels.
pub(super) fn svg(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Drawn) -> String {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        area.fill(&WHITE)
            .and_then(|()| draw(&area))
            .and_then(|()| area.present())
            .expect("drawing into a string cannot fail");
    }
    text
}

/// The PNG image of an SVG figure, `scale` times as many pixels a side; lettered in DejaVu Sans on every machine.
///
/// # Panics
/// When `svg` is not an SVG, or the scaled image has no pixels or more than memory holds.
#[must_use]
pub fn png(svg: &str, scale: f32) -> Vec<u8> {
    pixmap(svg, scale).encode_png().expect("a pixel map has a PNG form")
}

/// The pixels of an SVG, as [`png`] has them.
pub(super) fn pixmap(svg: &str, scale: f32) -> tiny_skia::Pixmap {
    let tree = tree(svg);
    let size = tree.size().to_int_size().scale_by(scale).expect("the image has pixels");
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).expect("memory for it");
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels
}

/// The PDF of an SVG figure, lettered in DejaVu Sans on every machine.
///
/// # Panics
/// When `svg` is not an SVG.
#[must_use]
pub fn pdf(svg: &str) -> Vec<u8> {
    let conversion = svg2pdf::ConversionOptions::default();
    let page = svg2pdf::PageOptions::default();
    svg2pdf::to_pdf(&tree(svg), conversion, page).expect("the font is part of the program")
}

fn tree(svg: &str) -> usvg::Tree {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
    usvg::Tree::from_str(svg, &options).expect("the figure is an SVG")
}

/// Lettering `height` pixels high.
pub(super) fn letters(height: f64, color: RGBColor) -> TextStyle<'static> {
    lettering(height, color, FontStyle::Normal)
}

/// The same in bold.
pub(super) fn bold(height: f64, color: RGBColor) -> TextStyle<'static> {
    lettering(height, color, FontStyle::Bold)
}

fn lettering(height: f64, color: RGBColor, style: FontStyle) -> TextStyle<'static> {
    // The SVG backend divides the size by 1.24.
    let font = FontDesc::new(FontFamily::SansSerif, 1.24 * height, style);
    TextStyle { font, color: color.to_backend_color(), pos: Pos::default() }
}

/// A panel under its `title`, with the margins that all panels share.
pub(super) fn panel<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
) -> Result<ChartBuilder<'a, 'b, SVGBackend<'b>>, DrawingAreaErrorKind<std::io::Error>> {
    area.draw(&Text::new(title.to_owned(), (76, 14), bold(14.5, INK)))?;
    let mut panel = ChartBuilder::on(area);
    panel.margin_top(40).margin_left(14).margin_right(26);
    panel.x_label_area_size(52).y_label_area_size(62);
    Ok(panel)
}

/// Draws grid, axes, ticks and the axes' names, each with its unit.
pub(super) fn draw_axes<'b, X, Y>(
    chart: &mut ChartContext<'_, SVGBackend<'b>, Cartesian2d<X, Y>>,
    x_name: &str,
    y_name: &str,
) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .x_labels(7)
        .y_labels(7)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(FAINT_INK)
        .label_style(letters(12.0, FAINT_INK))
        .axis_desc_style(letters(13.5, INK))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .x_desc(x_name)
        .y_desc(y_name)
        .draw()
}

/// The shortest form of a tick's value, without the noise of its last digits.
fn tick(x: &f64) -> String {
    // Adding zero makes the two zeros one.
    let rounded = format!("{x:.6e}").parse().unwrap_or(*x) + 0.0;
    format!("{rounded}")
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Disk,
    Ring,
    Square,
    HollowSquare,
    Triangle,
    Diamond,
}

/// A mark: what stands for one point of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub shape: Shape,
    pub color: RGBColor,
    /// Half the width, pixels.
    pub radius: i32,
}

impl Mark {
    pub(super) fn draw(&self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn {
        let Self { shape, color, radius: r } = *self;
        let polygon = |corners: &[(i32, i32)]| {
            let corners: Vec<_> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
            area.draw(&Polygon::new(corners, color))
        };
        match shape {
            Shape::Disk => area.draw(&Circle::new((x, y), r, color.filled())),
            Shape::Ring => area.draw(&Circle::new((x, y), r, color)),
            Shape::Square => polygon(&[(-r, -r), (r, -r), (r, r), (-r, r)]),
            Shape::HollowSquare => {
                let corners = [(x - r, y - r), (x + r, y + r)];
                area.draw(&Rectangle::new(corners, WHITE.filled()))?;
                area.draw(&Rectangle::new(corners, color))
            }
            Shape::Triangle => polygon(&[(-r, r), (0, -r), (r, r)]),
            Shape::Diamond => polygon(&[(-r, 0), (0, -r), (r, 0), (0, r)]),
        }
    }
}

/// A range that holds `values` with some air, on a linear axis.
pub(super) fn linear_range(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return 0.0..1.0;
    }
    let air = if high > low { 0.08 * (high - low) } else { 0.1 * high.abs().max(1.0) };
    low - air..high + air
}

/// A range that holds `values` (positive) with some air, on a logarithmic axis.
pub(super) fn log_range(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let logs = linear_range(values.map(f64::log10));
    10_f64.powf(logs.start)..10_f64.powf(logs.end)
}

/// A rectangle of pixels: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame(pub i32, pub i32, pub i32, pub i32);

impl Frame {
    pub(super) fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self(x - radius, y - radius, x + radius, y + radius)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.0 < other.2 && other.0 < self.2 && self.1 < other.3 && other.1 < self.3
    }

    fn holds(&self, other: &Self) -> bool {
        self.0 <= other.0 && self.1 <= other.1 && self.2 >= other.2 && self.3 >= other.3
    }
}

/// Writes each label beside its point where it covers nothing in `taken`; a label without room is left out.
pub(super) fn draw_labels(
    area: &Area<'_>,
    frame: Frame,
    mut taken: Vec<Frame>,
    labels: &[((i32, i32), &str)],
) -> Drawn {
    const HEIGHT: f64 = 11.0;
    for &((x, y), text) in labels {
        // DejaVu's digits and small letters are about 0.62 em wide.
        let width = (0.62 * HEIGHT * text.chars().count() as f64).ceil() as i32;
        let (gap, half) = (8, HEIGHT as i32 / 2 + 1);
        let right = Frame(x + gap, y - half, x + gap + width, y + half);
        let left = Frame(x - gap - width, y - half, x - gap, y + half);
        let above = Frame(x - width / 2, y - gap - 2 * half, x + width / 2, y - gap);
        let below = Frame(x - width / 2, y + gap, x + width / 2, y + gap + 2 * half);
        let free = |place: &Frame| frame.holds(place) && !taken.iter().any(|t| t.overlaps(place));
        if let Some(place) = [right, left, above, below].into_iter().find(free) {
            let at = (place.0, place.1 + half);
            area.draw(&Text::new(text, at, letters(HEIGHT, INK).pos(LEFT_MIDDLE)))?;
            taken.push(place);
        }
    }
    Ok(())
}

const LEFT_MIDDLE: Pos = Pos { h_pos: HPos::Left, v_pos: VPos::Center };

/// Draws columns of marks with their meaning, from the area's top left corner.
pub(super) fn draw_legend(area: &Area<'_>, columns: &[Vec<(Mark, &str)>], width: i32) -> Drawn {
    for (i, column) in columns.iter().enumerate() {
        for (j, (mark, meaning)) in column.iter().enumerate() {
            let (x, y) = (10 + width * i as i32, 12 + 22 * j as i32);
            mark.draw(area, (x, y))?;
            area.draw(&Text::new(*meaning, (x + 14, y), letters(12.5, INK).pos(LEFT_MIDDLE)))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_their_values_and_never_collapse() {
        assert_eq!(linear_range([].into_iter()), 0.0..1.0);
        assert_eq!(linear_range([3.0].into_iter()), 2.7..3.3);
        let range = log_range([0.1, 10.0].into_iter());
        assert!(range.start < 0.1 && range.start > 0.05 && range.end > 10.0 && range.end < 20.0);
    }

    #[test]
    fn ticks_are_short() {
        let ticks = [0.1 + 0.2, 100.0, -0.0, 1e-4, -2.5];
        assert_eq!(ticks.map(|x| tick(&x)), ["0.3", "100", "0", "0.0001", "-2.5"]);
    }

    #[test]
    fn a_label_never_covers_a_mark_or_another_label() {
        let points =
            [((50, 50), "a"), ((52, 50), "b"), ((51, 52), "c"), ((50, 51), "d"), ((51, 51), "e")];
        let frame = Frame(0, 0, 100, 100);
        let taken: Vec<_> = points.iter().map(|(at, _)| Frame::around(*at, 5)).collect();
        let text = svg((100, 100), |area| draw_labels(area, frame, taken, &points));
        let written = text.matches("<text").count();
        // Four sides around one heap of marks.
        assert!((2..=4).contains(&written), "{written}");
    }

    #[test]
    fn a_png_has_the_scaled_size_and_visible_letters() {
        let figure = |text: &'static str| {
            let svg = svg((60, 30), |area| area.draw(&Text::new(text, (5, 5), letters(12.0, INK))));
            png(&svg, 2.0)
        };
        let lettered = tiny_skia::Pixmap::decode_png(&figure("N/kPa")).unwrap();
        let blank = tiny_skia::Pixmap::decode_png(&figure("")).unwrap();
        assert_eq!((lettered.width(), lettered.height()), (120, 60));
        assert_ne!(lettered, blank);
    }
}
