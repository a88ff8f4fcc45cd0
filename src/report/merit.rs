//! What geometry alone sets: figure of merit times force, which the stiffness of the material does not change.
//!
//! ```text
//! wall s times as stiff, same geometry and pressure range scaled:   figure of merit / s,   force * s,   product unchanged
//! ```
//!
//! The pressures that bend a wall and the stresses in it are proportional to its stiffness.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FAINT_INK, GRID, INK, Mark, OTHERS, OURS, SMITH, Shape, bold, letters};
use super::front::FrontPoint;
use super::literature::{Published, Set, Technique, best_stiffness, dominated, published};

/// The products of a `front`, of its `solids` and of the literature, a line for each group, as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn merit_svg(front: &[FrontPoint], solids: &[FrontPoint]) -> String {
    let groups = groups(front, solids);
    let bottom = TOP + ROW * groups.len() as i32;
    let centered = Pos { h_pos: HPos::Center, v_pos: VPos::Top };
    let beside = Pos { h_pos: HPos::Right, v_pos: VPos::Center };
    canvas::svg((WIDTH as u32, bottom as u32 + 60), |area| {
        let title =
            "Figure of merit times largest force: what geometry sets and stiffness does not";
        area.draw(&Text::new(title, (20, 14), bold(14.5, INK)))?;
        for power in DECADES[0]..=DECADES[1] {
            let x = x_of(10_f64.powi(power));
            area.draw(&PathElement::new([(x, TOP), (x, bottom)], GRID.stroke_width(1)))?;
            let label = letters(12.0, FAINT_INK).pos(centered);
            area.draw(&Text::new(10_f64.powi(power).to_string(), (x, bottom + 6), label))?;
        }
        for ((name, mark, products), row) in groups.iter().zip(0..) {
            let y = TOP + ROW * row + ROW / 2;
            let label = letters(12.0, INK).pos(beside);
            area.draw(&Text::new((*name).to_owned(), (LEFT - 14, y), label))?;
            for product in products {
                mark.draw(area, (x_of(*product), y))?;
            }
        }
        let label = letters(13.5, INK).pos(centered);
        area.draw(&Text::new("deg N/(kPa m)", ((LEFT + WIDTH) / 2, bottom + 30), label))
    })
}

/// One sentence for a person: which of the `points` is better than the most published works, as it is and of the best material.
///
/// # Panics
/// Never: as [`published`].
#[must_use]
pub fn standing(points: &[FrontPoint]) -> Option<String> {
    let as_it_is = |point: &&FrontPoint| dominated(point.figure_of_merit, point.max_force, 1.0).0;
    let scaled = |point: &FrontPoint| {
        let stiffness = best_stiffness(point.figure_of_merit, point.max_force);
        (dominated(point.figure_of_merit, point.max_force, stiffness).0, stiffness)
    };
    let best = points.iter().max_by_key(as_it_is)?;
    let adapted = points.iter().max_by_key(|point| scaled(point).0)?;
    let (count, of) = dominated(best.figure_of_merit, best.max_force, 1.0);
    let (more, stiffness) = scaled(adapted);
    let now = match count {
        0 => format!("no design both bends and pushes better than any of {of} published works"),
        _ => format!("{} bends and pushes better than {count} of {of} published works", best.id),
    };
    let material = format!("were its material {stiffness:.2} times as stiff");
    Some(match (count, more) {
        (0, 0) => format!("{now}, whatever the stiffness of its material"),
        (0, _) => format!("{now}; {}, {material}, would be better than {more}", adapted.id),
        _ if more > count => format!("{now}; {}, {material}, than {more}", adapted.id),
        _ => now,
    })
}

type Group<'a> = (&'a str, Mark, Vec<f64>);

fn groups<'a>(front: &[FrontPoint], solids: &[FrontPoint]) -> Vec<Group<'a>> {
    let ours = |points: &[FrontPoint]| -> Vec<f64> {
        points.iter().map(|point| point.figure_of_merit * point.max_force).collect()
    };
    let all = published();
    let of = |wanted: &dyn Fn(&Published) -> bool| -> Vec<f64> {
        let wanted = all.iter().filter(|point| wanted(point));
        wanted.map(|point| point.figure_of_merit * point.max_force).collect()
    };
    let printed = |point: &Published| {
        matches!(point.technique, Technique::FilamentPrinted | Technique::ResinOrSiliconePrinted)
    };
    let mark = |shape, color| Mark { shape, color, radius: 4 };
    let mut groups = vec![
        ("front of this run", mark(Shape::Disk, OURS), ours(front)),
        ("the same as solids", mark(Shape::Square, INK), ours(solids)),
        (
            "Smith 2022, shell front",
            mark(Shape::HollowSquare, SMITH),
            of(&|p| p.set == Set::SmithShellFront),
        ),
        (
            "Smith 2022, front as solids",
            mark(Shape::Square, SMITH),
            of(&|p| p.set == Set::SmithSolidFront),
        ),
        ("Smith 2022, printed", mark(Shape::Triangle, SMITH), of(&|p| p.set == Set::SmithPrinted)),
        (
            "literature, printed",
            mark(Shape::Diamond, OTHERS),
            of(&|p| p.set == Set::Literature2022 && printed(p)),
        ),
        (
            "literature, others",
            mark(Shape::Disk, OTHERS),
            of(&|p| p.set == Set::Literature2022 && !printed(p)),
        ),
    ];
    for (_, _, products) in &mut groups {
        // A product of nothing stands at the end of the axis.
        products.retain(|product| *product >= 0.0 && product.is_finite());
    }
    groups.retain(|(_, _, products)| !products.is_empty());
    groups
}

fn x_of(product: f64) -> i32 {
    let [low, high] = DECADES.map(f64::from);
    let share = (product.log10().clamp(low, high) - low) / (high - low);
    LEFT + (share * f64::from(WIDTH - LEFT - 40)).round() as i32
}

/// Powers of ten at both ends of the axis; what lies beyond stands at its end.
const DECADES: [i32; 2] = [-1, 4];
/// Pixels.
const WIDTH: i32 = 900;
const LEFT: i32 = 240;
const TOP: i32 = 44;
const ROW: i32 = 30;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_design_stands_where_its_product_is() {
        let point = |figure_of_merit, max_force| FrontPoint {
            figure_of_merit,
            max_force,
            ..FrontPoint::of([0.0; 2])
        };
        // The same geometry of a material ten times as stiff, and one without force.
        let front = [point(10.0, 1.0), point(1.0, 10.0), point(1.0, 0.0)];
        let svg = merit_svg(&front, &[]);
        let disks: Vec<&str> = svg
            .lines()
            .filter(|line| line.starts_with("<circle") && line.contains("C8202F"))
            .collect();
        assert_eq!(disks.len(), 3);
        assert_eq!(disks[0], disks[1]);
        assert!(disks[2].contains(&format!("cx=\"{LEFT}\"")), "{disks:?}");
        assert!(disks[0].contains(&format!("cx=\"{}\"", x_of(10.0))), "{disks:?}");
        assert!(!svg.contains("the same as solids") && !svg.contains("NaN"));
        assert_eq!(merit_svg(&[], &[]).matches("this run").count(), 0);
        assert_eq!(standing(&[]), None);
        let said = standing(&front).unwrap();
        assert!(said.contains("of 24 published works"), "{said}");
        // Where nothing is beaten, nothing is claimed.
        let said = standing(&[point(1.0, 0.0), point(0.0, 3.0)]).unwrap();
        assert_eq!(
            said,
            "no design both bends and pushes better than any of 24 published works, whatever the stiffness of its material"
        );
    }
}
