//! How designs do over the pressure: their angles when free, their forces when blocked.

use plotters::prelude::*;

use super::canvas::{self, Area, Drawn, INK, Mark, OTHERS, OURS, SMITH, Shape, linear_range};

/// The curves of one design.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignCurves {
    /// Its name.
    pub id: String,
    /// Pressure (MPa) and chord angle (degrees) of the free path.
    pub angle: Vec<[f64; 2]>,
    /// Pressure (MPa) and force on the plane (N) of the blocked path.
    pub force: Vec<[f64; 2]>,
}

/// Of designs, the first, second and so on.
const COLORS: [RGBColor; 6] =
    [OURS, SMITH, RGBColor(46, 139, 87), RGBColor(218, 145, 26), INK, OTHERS];

/// The figure of `designs` as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn curves_svg(designs: &[DesignCurves]) -> String {
    canvas::svg((1240, 460), |area| {
        let (panels, legend) = area.split_vertically(420);
        let (left, right) = panels.split_horizontally(620);
        let angles = designs.iter().map(|design| &design.angle[..]);
        draw_panel(&left, "Free: angle of the tip", "angle, deg", angles.collect())?;
        let forces = designs.iter().map(|design| &design.force[..]);
        draw_panel(&right, "Blocked: force on the plane", "force, N", forces.collect())?;
        let entries = designs.iter().zip(COLORS.iter().cycle());
        let column = |(design, color): (&'_ DesignCurves, &RGBColor)| {
            (Mark { shape: Shape::Disk, color: *color, radius: 4 }, design.id.clone())
        };
        let columns: Vec<(Mark, String)> = entries.map(column).collect();
        let columns: Vec<Vec<(Mark, &str)>> =
            columns.iter().map(|(mark, id)| vec![(*mark, id.as_str())]).collect();
        canvas::draw_legend(&legend.margin(8, 0, 90, 0), &columns, 180)
    })
}

fn draw_panel(panel: &Area<'_>, title: &str, name: &str, curves: Vec<&[[f64; 2]]>) -> Drawn {
    let finite = |curve: &[[f64; 2]]| -> Vec<(f64, f64)> {
        let points = curve.iter().filter(|at| at.iter().all(|value| value.is_finite()));
        points.map(|[x, y]| (*x, *y)).collect()
    };
    let curves: Vec<Vec<(f64, f64)>> = curves.into_iter().map(finite).collect();
    let all = || curves.iter().flatten();
    let x = 0.0..linear_range(all().map(|at| at.0)).end.max(f64::MIN_POSITIVE);
    let y = linear_range(all().map(|at| at.1));
    let y = y.start.min(0.0)..y.end.max(1e-6);
    let mut chart = canvas::panel(panel, title)?.build_cartesian_2d(x, y)?;
    canvas::draw_axes(&mut chart, "pressure, MPa", name)?;
    for (curve, color) in curves.iter().zip(COLORS.iter().cycle()) {
        chart.draw_series(LineSeries::new(curve.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(curve.iter().map(|at| Circle::new(*at, 3, color.filled())))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_design_has_its_curves() {
        let design = |id: &str, most: f64| DesignCurves {
            id: id.to_owned(),
            angle: vec![[0.0, 0.0], [0.1, most]],
            force: vec![[0.0, 0.0], [0.1, f64::NAN]],
        };
        let svg = curves_svg(&[design("g000-001", 30.0), design("g000-002", 60.0)]);
        assert!(svg.contains("g000-001") && svg.contains("g000-002") && !svg.contains("NaN"));
        // A line of each in the left panel alone has two points.
        assert!(svg.matches("<polyline").count() >= 2, "{svg}");
        assert!(!curves_svg(&[]).contains("NaN"));
    }
}
