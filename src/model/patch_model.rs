//! The model of an open patch: its supports, its loads.

use super::discretization::Discretization;
use super::edge_support::{EdgeSupport, EdgeSupports};
use super::load::{DeadLoad, EdgeMoment, FollowerForce, FollowerLoads, Loaded};
use super::material::Material;
use super::shell_model::ShellModel;
use super::system::LoadedSystem;
use crate::math::{Rejected, Room, Vec3};
use crate::mesh::{BoundaryEdge, Patch, ShellElement, Side};

/// How a patch is held and loaded; the load factor multiplies all loads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchLoads {
    /// How each side is held, in the order of [`Side::ALL`].
    pub supports: EdgeSupports,
    /// Single components of the displacement (vertex, axis) held at 0, against rigid motions that the sides leave.
    pub pins: Vec<(u32, usize)>,
    /// Pressure on the side from which the normal `x,s cross x,t` points away, following the wall, MPa.
    pub pressure: f64,
    /// Loads that keep their direction.
    pub dead: Vec<DeadLoad>,
    /// Forces that keep their angle to the wall.
    pub followers: Vec<FollowerForce>,
    /// Moments per length (N mm / mm) along sides; the vector is the axis, to which the side is parallel and stays so.
    pub moments: Vec<(Side, Vec3)>,
}

impl ShellModel {
    /// An open patch under `loads`; its load is the factor that multiplies them all.
    ///
    /// # Errors
    /// [`Rejected`] when a support or a load does not fit the patch.
    pub fn of_patch(
        patch: &Patch,
        element: ShellElement,
        material: &Material,
        loads: &PatchLoads,
    ) -> Result<Self, Rejected> {
        let parts = Discretization::of_patch(patch, element, loads, material)?;
        let edges = patch.boundary_edges();
        let loaded = Loaded {
            reference: &parts.reference,
            points: &parts.points,
            surface: &parts.surface,
            areas: &parts.areas,
            edges: &edges,
            triangles: &patch.surface.triangles,
        };
        let mut forces = loaded.nodal_forces(&loads.dead);
        let mut carriers = parts.carriers(patch, &loads.followers, &loaded);
        let mut chamber = None;
        if loads.pressure != 0.0 {
            let points_of = |edge: &BoundaryEdge| loaded.points_of(edge);
            let (potential, rim) =
                parts.pressure_of(patch, &loads.supports, loads.pressure, points_of)?;
            chamber = Some(potential);
            carriers.extend(rim);
        }
        let (mut stencils, mut moment_edges) = (Vec::new(), Vec::new());
        for &(side, per_length) in &loads.moments {
            if loads.supports[side as usize] != EdgeSupport::Free {
                let detail =
                    format!("the moment is on side {side:?}, which is held and cannot turn");
                return Err(Rejected::new(Room::Model, "no_axis", detail, 1.0));
            }
            let length = |edge: &BoundaryEdge| loaded.length(edge);
            let (nodes, edges) = parts.moment_edges(patch, side, per_length, length)?;
            stencils.extend(nodes);
            moment_edges.extend(edges);
        }
        let moments = (!stencils.is_empty()).then(|| EdgeMoment::new(stencils, moment_edges));
        parts.ties.reduce(&mut forces);
        let mut model = Self::assembled(parts, chamber, moments, Vec::new(), material);
        if model.free_unknowns() == 0 {
            let detail =
                "nothing of the patch can move; it wants more cells between its held sides";
            return Err(Rejected::new(Room::Model, "nothing_moves", detail.to_owned(), 1.0));
        }
        model.pressure = loads.pressure;
        model.forces = forces;
        if !carriers.is_empty() {
            let (stencils, followers) = carriers.into_iter().unzip();
            model.follow_with(FollowerLoads::new(stencils, followers));
        }
        let rest = vec![0.0; model.unknowns()];
        let mut load = rest.clone();
        model.load_direction(&rest, &mut load);
        let largest = load.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
        // A thin wall under bending answers to forces far below its membrane's, down to what rounding leaves: strains of
        // some roundings of size / element at thousands of nodes, 1e-13 in all, of which the tolerance's 1e-9 makes 1e-4.
        if largest > 0.0 {
            let size = patch.surface.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
            let rounding = 1e-4 * material.young_modulus() * patch.thickness * size;
            model.force_scale = model.force_scale.min(largest.max(rounding));
        }
        Ok(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::NeoHookean;
    use crate::model::system::System;

    /// A quarter of a tube between four planes of symmetry, one of which is away from the origin, holds `pi R^2 L / 4`; its
    /// pressure's work and load direction agree.
    #[test]
    fn cut_chamber_is_closed_by_its_planes() {
        let tube = |s: f64, t: f64| Vec3::new(5.0 * s.cos(), 5.0 * s.sin(), t);
        let right = std::f64::consts::FRAC_PI_2;
        let patch = Patch::new([8, 3], [0.0, right], [1.0, 4.0], 0.1, &tube).unwrap();
        let symmetry = [1, 0, 2, 2].map(EdgeSupport::Symmetry);
        let loads = PatchLoads { supports: symmetry, pressure: 0.01, ..Default::default() };
        let material = Material::NeoHookean(NeoHookean { mu: 1.3 });
        for (element, tolerance) in [(ShellElement::Loop, 1e-5), (ShellElement::MidEdge, 1e-2)] {
            let mut model = ShellModel::of_patch(&patch, element, &material, &loads).unwrap();
            let rest = vec![0.0; model.unknowns()];
            let exact = std::f64::consts::PI * 25.0 / 4.0 * 3.0;
            // Chords of a sixteenth of a right angle: of second order for facets, of fourth on the limit surface.
            let error = model.volume(&rest) / exact - 1.0;
            assert!(error.abs() < tolerance, "{error:e}");
            model.set_load(1.0);
            let mut residual = vec![0.0; rest.len()];
            model.residual(&rest, &mut residual).unwrap();
            let mut direction = vec![0.0; rest.len()];
            model.load_direction(&rest, &mut direction);
            let scale = direction.iter().fold(0.0_f64, |largest, d| largest.max(d.abs()));
            // At rest the wall has no stress: what is out of balance is the load.
            for (residual, direction) in residual.iter().zip(&direction) {
                assert!((residual + direction).abs() < 1e-9 * scale, "{residual} {direction}");
            }
        }
    }

    /// Where a part stands makes no difference to its chamber, at rest or deformed.
    #[test]
    fn cut_chamber_does_not_depend_on_its_place() {
        let right = std::f64::consts::FRAC_PI_2;
        let symmetry = [1, 0, 2, 2].map(EdgeSupport::Symmetry);
        let loads = PatchLoads { supports: symmetry, pressure: 0.01, ..Default::default() };
        let material = Material::NeoHookean(NeoHookean { mu: 1.3 });
        let measured = |shift: Vec3| {
            let tube = |s: f64, t: f64| shift + Vec3::new(5.0 * s.cos(), 5.0 * s.sin(), t);
            let patch = Patch::new([8, 3], [0.0, right], [1.0, 4.0], 0.1, &tube).unwrap();
            let model =
                ShellModel::of_patch(&patch, ShellElement::Loop, &material, &loads).unwrap();
            let u: Vec<f64> = (0..model.unknowns()).map(|k| 0.1 * (k as f64).sin()).collect();
            let mut direction = vec![0.0; u.len()];
            model.load_direction(&u, &mut direction);
            (model.volume(&u), direction)
        };
        let (volume, direction) = measured(Vec3::zeros());
        let (moved_volume, moved_direction) = measured(Vec3::new(7.0, -30.0, 2.0));
        // Rounding of coordinates of 30 mm, cubed.
        assert!((moved_volume / volume - 1.0).abs() < 1e-11);
        for (moved, direction) in moved_direction.iter().zip(&direction) {
            assert!((moved - direction).abs() < 1e-11 * volume, "{moved} {direction}");
        }
    }
}
