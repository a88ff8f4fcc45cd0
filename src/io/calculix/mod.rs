//! CalculiX: the input deck of a load case, and what its solver `ccx` answers.
//!
//! ```text
//! C3D10        corners 1 2 3 4, midpoints 1-2 2-3 3-1 1-4 2-4 3-4: our order
//! faces        1: 1-2-3   2: 1-4-2   3: 2-4-3   4: 3-4-1
//! P1 .. P4     pressure on that face, positive into the cell, per deformed area and along the deformed normal
//! ```
//!
//! Its cells have displacements alone, at four points of quadrature; ours have pressures of their own. Both have the same energy:
//! `U = sum_i (J - 1)^(2i) / D_i` with `D_1 = 2 / kappa`. The higher terms, which ours has not, are given coefficients at which they
//! vanish: a coefficient of 0 would be replaced by `(0.1 / mu)^i`.
//!
//! So its cells lock where the material hardly changes its volume ([`locking`]), and it has none that do not: of its tetrahedra C3D10T
//! differs in thermal strains alone, and C3D20R and C3D8I, which hardly lock, are bricks. What helps is a smaller Poisson's ratio in
//! both programs, or more cells through the wall.
//!
//! Each sample of the pressure is a step of its own, over which the pressure rises from the step before.
//!
//! Source: Dhondt, CalculiX CrunchiX user's manual 2.20, "Ten-node tetrahedral element", "*HYPERELASTIC", "*DLOAD", "*CONTROLS".

mod answer;

use std::fmt::Write;

pub use answer::{NodalAnswer, TipAnswer, is_closed, read_nodes, read_tip};

use super::solid_case::{LawWithCard, SolidCase, list, number};

/// A law of Ogden's with more terms than CalculiX has coefficients for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("CalculiX knows Ogden's law with up to {MOST_TERMS} terms, not with {0}")]
pub struct TooManyTerms(pub usize);

const MOST_TERMS: usize = 3;
/// Of the higher powers of a change of volume: their share is lost in rounding.
const VANISHING: f64 = 1e20;
/// In an MPa. The deck is in mm, mN and kPa, because CalculiX takes residuals below 1e-6 of its unit for none, and that ends an increment
/// of a soft part while its corrections are still large: in mm, N and MPa tips of evolved designs were left 0.3 to 9 % away.
const KPA: f64 = 1e3;
/// Items in a line of a set.
const IN_LINE: usize = 8;
/// An increment is done when the largest residual is below this share of the mean force, and the largest correction below this share of
/// the increment; what is open then is some ten times as much. The correction decides: the program's tangent lacks the pressure's part,
/// so that an iteration leaves up to nine tenths of the error; and stresses of its Ogden law lose digits where stretches are nearly
/// equal, which leaves residuals of some per cent near rest.
const TOLERANCES: [f64; 2] = [1e-1, 2e-4];
/// Hence iterations are many, and no reason to cut an increment but where residuals still grow after 20, or it breaks down;
/// increments are doubled after two that took less than 60.
const PATIENCE: &str = "20, 100, 100, 200, 100, 60, , 10\n0.25, 0.5, 0.75, 0.85, , , 2.,";
/// Poisson's ratios, and the shares of [`locking`].
const LOCKING: [(f64, [f64; 2]); 3] =
    [(0.3, [0.005, 0.014]), (0.45, [0.02, 0.025]), (0.49, [0.035, 0.14])];
/// The smallest increment, as a share of the whole pressure.
const LEAST_INCREMENT: f64 = 1e-6;

/// By how much its tip is known to move less than that of cells with pressures of their own, from the least that was met to the most,
/// as shares.
///
/// Between these Poisson's ratios by straight lines. Met, at small pressures: `basic_bend` in cells of 4 mm, one and two through the
/// wall, 1.2 % at 0.3, 2.5 and 2.0 % at 0.45, 4.5 and 3.6 % at 0.49; boxes of 2 and 1 mm 1.4 and 0.5 % at 0.3; long cells, one
/// through the wall, 9 and 14 % at 0.49.
#[must_use]
pub fn locking(poisson_ratio: f64) -> [f64; 2] {
    let after = LOCKING.iter().position(|row| row.0 > poisson_ratio).unwrap_or(LOCKING.len());
    let [low, high] = [after.saturating_sub(1), after.min(LOCKING.len() - 1)].map(|k| LOCKING[k]);
    let share = if high.0 > low.0 { (poisson_ratio - low.0) / (high.0 - low.0) } else { 0.0 };
    std::array::from_fn(|k| low.1[k] + share * (high.1[k] - low.1[k]))
}

/// [`locking`] in %.
#[must_use]
pub fn locking_in_percent(poisson_ratio: f64) -> String {
    let [least, most] = locking(poisson_ratio).map(|share| 100.0 * share);
    let more = if poisson_ratio > LOCKING[LOCKING.len() - 1].0 + 1e-3 { " or more" } else { "" };
    format!("{least:.1} to {most:.0} %{more}")
}

/// [`locking`] in words, where it matters.
#[must_use]
pub fn locking_in_words(poisson_ratio: f64) -> Option<String> {
    (100.0 * locking(poisson_ratio)[1] > WORTH_SAYING).then(|| {
        format!(
            "CalculiX' tetrahedra lock at a Poisson's ratio of {poisson_ratio:.4}: its tip moves {} less",
            locking_in_percent(poisson_ratio)
        )
    })
}

/// Of the tip's motion, %: what the same cells differ by where nothing locks.
const WORTH_SAYING: f64 = 2.0;

/// The input deck of `case`, for `ccx`.
///
/// # Errors
/// [`TooManyTerms`] where CalculiX has Ogden's law with fewer.
pub fn deck(case: &SolidCase<'_>) -> Result<String, TooManyTerms> {
    let SolidCase { title, mesh, clamp, tip, pressure, .. } = *case;
    let locking = locking_in_words(case.poisson_ratio)
        .map_or_else(String::new, |words| format!("** {words}\n"));
    let mut text = format!(
        "** {title}\n** mm, mN, kPa; run with: ccx solid\n{locking}*HEADING\n{title}\n*NODE, NSET=NALL\n"
    );
    let mut line = |words: String| writeln!(text, "{words}").expect("a text grows");
    for (x, node) in mesh.positions.iter().zip(1..) {
        line(format!("{node},{},{},{}", number(x.x), number(x.y), number(x.z)));
    }
    line("*ELEMENT, TYPE=C3D10, ELSET=WALL".to_owned());
    for (nodes, cell) in mesh.tetrahedra.iter().zip(1..) {
        line(format!("{cell},{}", list(nodes)));
    }
    for (name, nodes) in [("CLAMP", clamp), ("TIP", tip)] {
        line(format!("*NSET, NSET={name}"));
        nodes.chunks(IN_LINE).for_each(|nodes| line(list(nodes)));
    }
    let cells = case.chamber_cells();
    let faces = || (1..).zip(&cells).filter(|(_, cells)| !cells.is_empty());
    for (face, cells) in faces() {
        line(format!("*ELSET, ELSET=CHAMBER_{face}"));
        cells.chunks(IN_LINE).for_each(|cells| line(list(cells)));
    }
    line("*SURFACE, NAME=CHAMBER, TYPE=ELEMENT".to_owned());
    faces().for_each(|(face, _)| line(format!("CHAMBER_{face}, S{face}")));
    line("*BOUNDARY\nCLAMP, 1, 3\n*MATERIAL, NAME=RUBBER".to_owned());
    line(hyperelastic(case.law, case.bulk_modulus)?);
    line("*SOLID SECTION, ELSET=WALL, MATERIAL=RUBBER".to_owned());
    let [force, correction] = TOLERANCES;
    let part = number(1.0 / case.samples as f64);
    for (sample, time) in (1..).zip(case.times()) {
        line(format!(
            "*STEP, NLGEOM, INC=100000\n*STATIC\n{part}, {part}, {LEAST_INCREMENT:e}, {part}\n\
             *CONTROLS, PARAMETERS=TIME INCREMENTATION\n{PATIENCE}\n\
             *CONTROLS, PARAMETERS=FIELD\n{force:e}, {correction:e}\n*DLOAD"
        ));
        let now = number(KPA * time * pressure);
        faces().for_each(|(face, _)| line(format!("CHAMBER_{face}, P{face}, {now}")));
        line("*NODE PRINT, NSET=TIP, FREQUENCY=100000\nU".to_owned());
        if sample == case.samples {
            line("*NODE FILE, FREQUENCY=100000\nU".to_owned());
        }
        line("*END STEP".to_owned());
    }
    Ok(text)
}

/// The card of a law and its numbers: `2 mu / alpha^2` is Ogden's factor there as here.
fn hyperelastic(law: &LawWithCard, bulk_modulus: f64) -> Result<String, TooManyTerms> {
    let d = 2.0 / (KPA * bulk_modulus);
    let (name, numbers) = match law {
        LawWithCard::NeoHookean(law) => ("NEO HOOKE".to_owned(), vec![KPA * 0.5 * law.mu, d]),
        LawWithCard::MooneyRivlin(law) => {
            ("MOONEY-RIVLIN".to_owned(), vec![KPA * law.c1, KPA * law.c2, d])
        }
        LawWithCard::Yeoh(law) => {
            let [c1, c2, c3] = law.c.map(|c| KPA * c);
            ("YEOH".to_owned(), vec![c1, c2, c3, d, VANISHING, VANISHING])
        }
        LawWithCard::Ogden(law) => {
            let terms: Vec<_> = law.terms().collect();
            if terms.len() > MOST_TERMS {
                return Err(TooManyTerms(terms.len()));
            }
            let shapes = terms.iter().flat_map(|term| [KPA * term.mu, term.alpha]);
            let volumes = [d, VANISHING, VANISHING].into_iter().take(terms.len());
            (format!("OGDEN, N={}", terms.len()), shapes.chain(volumes).collect())
        }
    };
    let lines: Vec<String> = numbers
        .chunks(IN_LINE)
        .map(|numbers| numbers.iter().map(|&value| number(value)).collect::<Vec<_>>().join(","))
        .collect();
    Ok(format!("*HYPERELASTIC, {name}\n{}", lines.join("\n")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{MooneyRivlin, NeoHookean, Ogden, OgdenTerm, Yeoh};

    fn card(law: LawWithCard) -> Vec<String> {
        let card = hyperelastic(&law, 8.0).unwrap();
        card.lines().map(str::to_owned).collect()
    }

    fn numbers(line: &str) -> Vec<f64> {
        // The program reads 20 characters of each.
        assert!(line.split(',').all(|word| word.len() <= 20), "{line}");
        line.split(',').map(|word| word.parse().unwrap()).collect()
    }

    /// The order of coefficients as the manual lists it, in kPa; eight in a line.
    #[test]
    fn laws_have_their_cards() {
        let neo_hookean = card(LawWithCard::NeoHookean(NeoHookean { mu: 3.0 }));
        assert_eq!(neo_hookean[0], "*HYPERELASTIC, NEO HOOKE");
        assert_eq!(numbers(&neo_hookean[1]), [1500.0, 0.25e-3]);
        let mooney_rivlin = card(LawWithCard::MooneyRivlin(MooneyRivlin { c1: 0.5, c2: -0.125 }));
        assert_eq!(numbers(&mooney_rivlin[1]), [500.0, -125.0, 0.25e-3]);
        let yeoh = card(LawWithCard::Yeoh(Yeoh { c: [1.0, -0.5, 0.25] }));
        assert_eq!(numbers(&yeoh[1]), [1000.0, -500.0, 250.0, 0.25e-3, 1e20, 1e20]);
        let terms: Vec<_> =
            (1..=4).map(|k| OgdenTerm { mu: f64::from(k), alpha: -f64::from(k) }).collect();
        let ogden = card(LawWithCard::Ogden(Ogden::new(&terms[..3])));
        assert_eq!((ogden.len(), ogden[0].as_str()), (3, "*HYPERELASTIC, OGDEN, N=3"));
        assert_eq!(numbers(&ogden[1]), [1000.0, -1.0, 2000.0, -2.0, 3000.0, -3.0, 0.25e-3, 1e20]);
        assert_eq!(numbers(&ogden[2]), [1e20]);
        let one = card(LawWithCard::Ogden(Ogden::new(&terms[..1])));
        assert_eq!(numbers(&one[1]), [1000.0, -1.0, 0.25e-3]);
        let four = hyperelastic(&LawWithCard::Ogden(Ogden::new(&terms)), 8.0);
        assert_eq!(four, Err(TooManyTerms(4)));
    }
}
