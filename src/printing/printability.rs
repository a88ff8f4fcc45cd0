//! Everything that is said of a part before it is printed.

use serde::Serialize;

use crate::math::Rejected;

use super::inlet::LEAST_WALL;
use super::overhang::overhang;
use super::thickness::thickness;
use super::{AirPaths, BuildDirection, PrintedPart, Voxels, longest_bridge};

/// What the figures are computed with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintSettings {
    /// Edge of the cubes of air and bridges, mm.
    pub voxel: f64,
    /// Of the material, g/cm^3.
    pub density: f64,
}

/// Cubes of a bead of a fine nozzle; thermoplastic polyurethane, of which filaments have 1.19 to 1.25 g/cm^3 (NinjaTek gives 1.19
/// for NinjaFlex).
impl Default for PrintSettings {
    fn default() -> Self {
        Self { voxel: 0.4, density: 1.2 }
    }
}

/// What a printer of filament would say of a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Printability {
    /// Extent along x, y, z, mm.
    pub size_mm: [f64; 3],
    /// Of the material, mm^3.
    pub volume_mm3: f64,
    /// Of the part, g.
    pub mass_g: f64,
    /// With which the mass was computed, g/cm^3.
    pub density_g_cm3: f64,
    /// The least thickness of the material, mm.
    pub least_wall_mm: f64,
    /// Where, mm.
    pub least_wall_at_mm: [f64; 3],
    /// Share of the surface below which the material is thinner than two beads of 0.4 mm.
    pub thin_share: f64,
    /// The six axes as ways up, the best first.
    pub orientations: Vec<Orientation>,
    /// Edge of the cubes with which air and bridges were looked for, mm.
    pub voxel_mm: f64,
    /// Whether air from outside reaches the chamber.
    pub chamber_reached: bool,
    /// Whether the wall keeps air in when the inlet is plugged.
    pub airtight: bool,
    /// Volumes of trapped pockets, largest first, mm^3.
    pub pockets_mm3: Vec<f64>,
    /// What a person should know before printing.
    pub warnings: Vec<String>,
}

/// A way up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Orientation {
    /// `+z` is the part on its base.
    pub up: String,
    /// Share of the surface that overhangs by more than 45 degrees.
    pub overhang_share: f64,
    /// Share of the surface that does so within the chamber, where no support comes out again.
    pub chamber_overhang_share: f64,
    /// Area of the overhangs outside of the chamber, seen from above, mm^2.
    pub support_area_mm2: f64,
    /// The longest bridge, mm.
    pub longest_bridge_mm: f64,
    /// Height of the print, mm.
    pub height_mm: f64,
}

impl Printability {
    /// The figures of `part`.
    ///
    /// # Errors
    /// [`Rejected`] with the reason `defective_surface` when the part's surface is not closed.
    ///
    /// # Panics
    /// When the voxel is not a positive number.
    pub fn of(part: &PrintedPart, settings: &PrintSettings) -> Result<Self, Rejected> {
        let PrintSettings { voxel, density } = *settings;
        let surface = &part.surface;
        let thickness = thickness(surface, LEAST_WALL)?;
        let voxels = Voxels::of(surface, voxel);
        let air = AirPaths::of(&voxels, part.chamber_point, part.bore.as_ref());
        let (lower, upper) = surface.bounding_box().unwrap_or_default();
        let volume = surface.volume();
        let mut printability = Self {
            size_mm: (upper - lower).into(),
            volume_mm3: volume,
            mass_g: volume * density * CM3_PER_MM3,
            density_g_cm3: density,
            least_wall_mm: thickness.least,
            least_wall_at_mm: thickness.place.into(),
            thin_share: thickness.thin_share,
            orientations: orientations(part, &voxels),
            voxel_mm: voxel,
            chamber_reached: air.chamber_reached,
            airtight: air.airtight,
            pockets_mm3: air.pockets,
            warnings: Vec::new(),
        };
        printability.warnings = printability.warnings(part.bore.is_some());
        Ok(printability)
    }

    /// The way up with the least overhang.
    #[must_use]
    pub fn best(&self) -> &Orientation {
        &self.orientations[0]
    }

    fn warnings(&self, has_inlet: bool) -> Vec<String> {
        let best = self.best();
        let [x, y, z] = self.least_wall_at_mm;
        let pockets: f64 = self.pockets_mm3.iter().sum();
        let bridge = best.longest_bridge_mm;
        let voxel = self.voxel_mm;
        let told = [
            (self.least_wall_mm < LEAST_WALL).then(|| {
                format!(
                    "the material is {:.2} mm thick at ({x:.1}, {y:.1}, {z:.1}), less than two beads of 0.4 mm; so is {:.2} % of the surface",
                    self.least_wall_mm,
                    100.0 * self.thin_share
                )
            }),
            (best.chamber_overhang_share > MOST_INSIDE).then(|| {
                format!(
                    "built {} up, {:.1} % of the surface overhangs within the chamber, where no support comes out again",
                    best.up,
                    100.0 * best.chamber_overhang_share
                )
            }),
            (bridge > LONGEST_BRIDGE).then(|| {
                format!("built {} up, the longest bridge is {bridge:.1} mm; soft filament sags beyond {LONGEST_BRIDGE} mm", best.up)
            }),
            (!self.pockets_mm3.is_empty()).then(|| {
                format!("{} pockets of air are trapped, {pockets:.1} mm^3 together", self.pockets_mm3.len())
            }),
            (!self.airtight).then(|| {
                format!("the wall leaks: cubes of {voxel} mm lead from the chamber to the outside")
            }),
            (!self.chamber_reached && !has_inlet)
                .then(|| "the chamber has no inlet: nothing can inflate it".to_owned()),
            (!self.chamber_reached && has_inlet).then(|| {
                format!("air does not reach the chamber through the inlet, to cubes of {voxel} mm")
            }),
        ];
        told.into_iter().flatten().collect()
    }
}

/// The six ways up: least overhang first, to a tenth of a percent, then least support, to a square millimetre, then lowest.
fn orientations(part: &PrintedPart, voxels: &Voxels) -> Vec<Orientation> {
    let of = |up: BuildDirection| {
        let overhang = overhang(&part.surface, &part.chamber, up, voxels.size);
        Orientation {
            up: up.name().to_owned(),
            overhang_share: overhang.share,
            chamber_overhang_share: overhang.chamber_share,
            support_area_mm2: overhang.support_area,
            longest_bridge_mm: longest_bridge(voxels, up),
            height_mm: overhang.height,
        }
    };
    let mut orientations: Vec<Orientation> = BuildDirection::ALL.map(of).into();
    let cost = |orientation: &Orientation| {
        let share = (1000.0 * orientation.overhang_share).round();
        [share, orientation.support_area_mm2.round(), orientation.height_mm]
    };
    orientations.sort_by(|a, b| {
        let pairs = cost(a).into_iter().zip(cost(b));
        pairs
            .map(|(a, b)| a.total_cmp(&b))
            .fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    orientations
}

const CM3_PER_MM3: f64 = 1e-3;
/// Share of the surface that may overhang in the chamber unmentioned.
const MOST_INSIDE: f64 = 0.01;
/// A bridge of soft filament, mm; our choice, as no standard has one.
const LONGEST_BRIDGE: f64 = 10.0;

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::math::Vec3;
    use crate::printing::test_shapes::{ball, brick, hollow};

    /// A box of 24 x 34 x 12 mm around a room of 20 x 30 x 8 mm, its walls 2 mm.
    fn room() -> PrintedPart {
        let outer = brick([-2.0; 3], [22.0, 32.0, 10.0]);
        let surface = hollow(&outer, &[brick([0.0; 3], [20.0, 30.0, 8.0])]);
        PrintedPart {
            surface,
            chamber: 12..24,
            chamber_point: Vec3::new(10.0, 15.0, 4.0),
            bore: None,
        }
    }

    #[test]
    fn a_room_is_described() {
        let found = Printability::of(&room(), &PrintSettings::default()).unwrap();
        assert_eq!(found.size_mm, [24.0, 34.0, 12.0]);
        let volume = 24.0 * 34.0 * 12.0 - 20.0 * 30.0 * 8.0;
        assert_relative_eq!(found.volume_mm3, volume, max_relative = 1e-12);
        assert_relative_eq!(found.mass_g, 1.2e-3 * volume, max_relative = 1e-12);
        // The march ends within 1e-3 mm.
        assert!((found.least_wall_mm - 2.0).abs() < 1e-3, "{found:?}");
        assert_eq!((found.chamber_reached, found.airtight), (false, true));
        assert_eq!(found.pockets_mm3, Vec::<f64>::new());
        // The smallest roof, of 20 x 8 mm, is the least overhang: standing on a face of 24 x 12 mm, where the lower roof spans 8 mm.
        let best = found.best();
        assert_eq!((&best.up[1..], best.height_mm, best.longest_bridge_mm), ("y", 34.0, 8.0));
        let area =
            2.0 * (24.0 * 34.0 + 34.0 * 12.0 + 24.0 * 12.0 + 20.0 * 30.0 + 30.0 * 8.0 + 20.0 * 8.0);
        assert_relative_eq!(best.overhang_share, 160.0 / area, max_relative = 1e-12);
        assert_eq!(best.support_area_mm2, 0.0);
        assert_eq!(found.warnings.len(), 2, "{:?}", found.warnings);
        assert!(found.warnings[0].contains("overhangs within the chamber"), "{:?}", found.warnings);
        assert!(found.warnings[1].contains("no inlet"), "{:?}", found.warnings);
    }

    /// Walls of 0.6 mm, a bridge of 20 mm and a pocket: each is told.
    #[test]
    fn what_is_wrong_is_told() {
        let outer = brick([-0.6; 3], [40.0, 40.0, 40.0]);
        let rooms = [brick([0.0; 3], [20.0, 20.0, 20.0]), ball([30.0, 30.0, 30.0], 3.0)];
        let surface = hollow(&outer, &rooms);
        let chamber_point = Vec3::new(10.0, 10.0, 10.0);
        let part = PrintedPart { surface, chamber: 12..24, chamber_point, bore: None };
        let settings = PrintSettings { voxel: 0.5, ..PrintSettings::default() };
        let warnings = Printability::of(&part, &settings).unwrap().warnings.join("\n");
        for words in ["0.60 mm thick at", "bridge is 20.0 mm", "1 pockets of air", "no inlet"] {
            assert!(warnings.contains(words), "{words}: {warnings}");
        }
    }
}
