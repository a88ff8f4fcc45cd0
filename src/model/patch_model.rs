//! The model of an open patch: its supports, its loads.

use super::contact::Samples;
use super::discretization::Discretization;
use super::edge_support::EdgeSupport;
use super::load::{DeadForces, EdgeMoment, FollowerLoads, Loaded};
use super::material::Material;
use super::part_model::{Loads, PartModel};
use super::part_setup::PartSetup;
use super::patch_loads::PatchLoads;
use super::system::LoadedSystem;
use crate::math::{Reason, Rejected, Room};
use crate::mesh::{BoundaryEdge, Patch, ShellElement};

impl PartModel {
    /// An open patch under `loads`, among what `setup` lists, which either face may touch; its load is the factor that multiplies the
    /// loads.
    ///
    /// # Errors
    /// [`Rejected`] when a support or a load does not fit the patch.
    pub fn of_patch(
        patch: &Patch,
        element: ShellElement,
        materials: &(impl AsRef<[Material]> + ?Sized),
        loads: &PatchLoads,
        setup: &PartSetup,
    ) -> Result<Self, Rejected> {
        let materials = materials.as_ref();
        let parts = Discretization::of_patch(patch, element, loads, materials)?;
        let edges = patch.boundary_edges();
        let loaded = Loaded {
            reference: &parts.reference,
            points: &parts.points,
            surface: &parts.surface,
            areas: &parts.areas,
            edges: &edges,
            triangles: &patch.surface.triangles,
        };
        let mut terms = Loads::default();
        if !loads.dead.is_empty() {
            terms.dead = Some(DeadForces::new(loaded.nodal_forces(&loads.dead), &parts.ties));
        }
        let mut carriers = parts.carriers(patch, &loads.followers, &loaded);
        if loads.pressure != 0.0 {
            let points_of = |edge: &BoundaryEdge| loaded.points_of(edge);
            let (potential, rim) =
                parts.pressure_of(patch, &loads.supports, loads.pressure, points_of)?;
            terms.others.push(Box::new(potential.under(loads.pressure)));
            carriers.extend(rim);
        }
        let (mut stencils, mut moment_edges) = (Vec::new(), Vec::new());
        for &(side, per_length) in &loads.moments {
            if loads.supports[side as usize] != EdgeSupport::Free {
                let detail =
                    format!("the moment is on side {side:?}, which is held and cannot turn");
                return Err(Rejected::new(Room::Model, Reason::NoAxis, detail, 1.0));
            }
            let length = |edge: &BoundaryEdge| loaded.length(edge);
            let (nodes, edges) = parts.moment_edges(patch, side, per_length, length)?;
            stencils.extend(nodes);
            moment_edges.extend(edges);
        }
        if !stencils.is_empty() {
            terms.others.push(Box::new(EdgeMoment::new(stencils, moment_edges)));
        }
        if !carriers.is_empty() {
            let (stencils, followers) = carriers.into_iter().unzip();
            terms.others.push(Box::new(FollowerLoads::new(stencils, followers)));
        }
        let mut model =
            Self::assembled(parts, terms, Vec::new(), materials, Samples::InMiddle, setup);
        if model.free_unknowns() == 0 {
            let detail =
                "nothing of the patch can move; it wants more cells between its held sides";
            return Err(Rejected::new(Room::Model, Reason::NothingMoves, detail.to_owned(), 1.0));
        }
        let rest = vec![0.0; model.unknowns()];
        let mut load = rest.clone();
        model.load_direction(&rest, &mut load);
        let weights =
            model.each::<DeadForces>().flat_map(|dead| dead.on_unknowns().iter().flatten());
        let forces = load.iter().chain(weights);
        let largest = forces.fold(0.0_f64, |largest, force| largest.max(force.abs()));
        // A thin wall under bending answers to forces far below its membrane's, down to what rounding leaves: strains of
        // some roundings of size / element at thousands of nodes, 1e-13 in all, of which the tolerance's 1e-9 makes 1e-4.
        if largest > 0.0 {
            let size = patch.surface.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
            let stiffest = Material::stiffest(materials);
            let [_, thickest] = patch.section.thickness_range();
            let rounding = 1e-4 * stiffest.young_modulus() * thickest * size;
            model.force_scale = model.force_scale.min(largest.max(rounding));
        }
        Ok(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::Side;
    use crate::model::FollowerForce;
    use crate::model::material::{NeoHookean, StVenantKirchhoff};
    use crate::model::system::System;
    use crate::model::test_shells::difference;

    const ELEMENTS: [ShellElement; 2] = [ShellElement::Loop, ShellElement::MidEdge];

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
            let mut model =
                PartModel::of_patch(&patch, element, &material, &loads, &PartSetup::default())
                    .unwrap();
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

    /// A free plate twisted by `w = k s t` stores `D (1 - nu) k^2` for each area, whatever the shape of its cells, with both elements
    /// and to its very edges (Timoshenko & Woinowsky-Krieger 1959, section 11).
    #[test]
    fn twisted_plate_has_the_energy_of_its_twist() {
        let law = StVenantKirchhoff { young_modulus: 1000.0, poisson_ratio: 0.3 };
        let material = Material::StVenantKirchhoff(law);
        let (thickness, twist): (f64, f64) = (1.0, 1e-4);
        let stiffness = 1000.0 * thickness.powi(3) / (12.0 * (1.0 - 0.09));
        let exact = stiffness * 0.7 * twist * twist * 6.0 * 2.0;
        for cells in [[2, 8], [4, 4], [12, 1]] {
            let plate = |s: f64, t: f64| Vec3::new(s, t, 0.0);
            let patch = Patch::new(cells, [0.0, 6.0], [0.0, 2.0], thickness, &plate).unwrap();
            for element in ELEMENTS {
                let loads = PatchLoads::default();
                let mut model =
                    PartModel::of_patch(&patch, element, &material, &loads, &PartSetup::default())
                        .unwrap();
                let mut u = vec![0.0; model.unknowns()];
                for (node, &place) in patch.node_places().iter().enumerate() {
                    if element == ShellElement::Loop || node < patch.vertices() {
                        let x = patch.point(place);
                        u[3 * node + 2] = twist * x.x * x.y;
                    }
                }
                let energy = model.energy(&u).unwrap();
                // Strains of the middle, (k s)^2 / 2, are 4e-3 of those at the faces, k h / 2, and enter squared.
                assert!((energy / exact - 1.0).abs() < 1e-4, "{element:?} {cells:?}: {energy:e}");
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
            let model = PartModel::of_patch(
                &patch,
                ShellElement::Loop,
                &material,
                &loads,
                &PartSetup::default(),
            )
            .unwrap();
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

    /// A curved patch with a side of each kind under everything that follows it, away from rest.
    fn followed(element: ShellElement) -> (PartModel, Vec<f64>) {
        let tube = |s: f64, t: f64| Vec3::new(5.0 * s.cos(), 5.0 * s.sin(), t + 0.3 * s);
        let patch = Patch::new([5, 4], [0.2, 1.3], [0.0, 3.0], 0.2, &tube).unwrap();
        let vertex = patch.vertex(0.42, 1.5).unwrap();
        let loads = PatchLoads {
            supports: [
                EdgeSupport::Clamped,
                EdgeSupport::Free,
                EdgeSupport::Held([false, true, false]),
                EdgeSupport::Free,
            ],
            pressure: 0.02,
            followers: vec![
                FollowerForce::Point { vertex, force: Vec3::new(0.1, -0.2, 0.3) },
                FollowerForce::Edge { side: Side::S1, per_length: Vec3::new(-0.2, 0.1, 0.05) },
                FollowerForce::Edge { side: Side::T1, per_length: Vec3::new(0.0, 0.1, -0.1) },
            ],
            ..Default::default()
        };
        let material = Material::NeoHookean(NeoHookean { mu: 1.3 });
        let mut model =
            PartModel::of_patch(&patch, element, &material, &loads, &PartSetup::default()).unwrap();
        model.set_load(0.7);
        let mut u: Vec<f64> =
            (0..model.unknowns()).map(|k| 0.03 * (1.3 * k as f64).sin()).collect();
        // Held unknowns have no part in differences.
        let mut free = vec![0.0; u.len()];
        model.residual(&u, &mut free).unwrap();
        u.iter_mut().zip(&free).for_each(|(u, free)| *u = if *free == 0.0 { 0.0 } else { *u });
        (model, u)
    }

    /// Tangent and circulation are together the derivative of the residual, and the energy has nothing of the followers.
    #[test]
    fn followers_have_their_whole_tangent() {
        for element in ELEMENTS {
            let (mut model, u) = followed(element);
            assert!(!model.is_conservative());
            let v: Vec<f64> =
                u.iter().enumerate().map(|(k, u)| 1e2 * u * (0.7 * k as f64).cos()).collect();
            let residual = |model: &mut PartModel, h: f64| {
                let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + h * v).collect();
                let mut residual = vec![0.0; u.len()];
                model.residual(&moved, &mut residual).unwrap();
                nalgebra::DVector::from_vec(residual)
            };
            let exact = difference(1e-4, |h| residual(&mut model, h));
            let mut entries = vec![0.0; model.pattern().stored()];
            let mut product = vec![0.0; u.len()];
            model.tangent(&u, &mut product, &mut entries).unwrap();
            product.fill(0.0);
            let pattern = model.pattern();
            for column in 0..u.len() {
                let stored = pattern.column_starts[column]..pattern.column_starts[column + 1];
                for entry in stored.map(|entry| entry as usize) {
                    let row = pattern.row_indices[entry] as usize;
                    if row >= column {
                        product[row] += entries[entry] * v[column];
                    }
                    if row > column {
                        product[column] += entries[entry] * v[row];
                    }
                }
            }
            let tangent_alone = product.clone();
            model.add_circulatory_tangent(&u, &v, &mut product);
            let size = exact.amax();
            for (product, exact) in product.iter().zip(&exact) {
                // Fourth order in 1e-4 times displacements of 3, over cells of 0.7 mm; rounding over 1e-4.
                assert!((product - exact).abs() < 1e-7 * size, "{element:?}: {product} {exact}");
            }
            let turned = tangent_alone.iter().zip(&exact).map(|(k, exact)| (k - exact).abs());
            assert!(turned.fold(0.0, f64::max) > 1e-4 * size, "{element:?}");
        }
    }

    /// The forces of a load of 1 are what the residual loses with the load.
    #[test]
    fn direction_of_followers_is_the_difference_over_the_load() {
        for element in ELEMENTS {
            let (mut model, u) = followed(element);
            let residual = |model: &mut PartModel, load: f64| {
                let mut residual = vec![0.0; u.len()];
                model.set_load(load);
                model.residual(&u, &mut residual).unwrap();
                residual
            };
            let (none, whole) = (residual(&mut model, 0.0), residual(&mut model, 1.0));
            let mut direction = vec![0.0; u.len()];
            model.load_direction(&u, &mut direction);
            let size = direction.iter().fold(0.0_f64, |size, d| size.max(d.abs()));
            for (direction, (none, whole)) in direction.iter().zip(none.iter().zip(&whole)) {
                // Rounding of the wall's forces, which are a hundred times as large.
                assert!((direction + whole - none).abs() < 1e-12 * size.max(1.0), "{element:?}");
            }
        }
    }

    /// Away from the side that is open, the pressure is that in a closed chamber, though nothing closes it: between planes of
    /// symmetry too, of which one is away from where volumes are measured.
    #[test]
    fn pressure_does_not_know_of_a_side_far_away() {
        let tube = |s: f64, t: f64| Vec3::new(5.0 * s.cos(), 5.0 * s.sin(), t);
        let patch = Patch::new([12, 4], [0.2, 1.3], [1.0, 4.0], 0.1, &tube).unwrap();
        let symmetry = EdgeSupport::Symmetry(2);
        let material = Material::NeoHookean(NeoHookean { mu: 1.3 });
        for element in ELEMENTS {
            let forces = |last: EdgeSupport| {
                let supports = [EdgeSupport::Clamped, last, symmetry, symmetry];
                let loads = PatchLoads { supports, pressure: 0.01, ..Default::default() };
                let model =
                    PartModel::of_patch(&patch, element, &material, &loads, &PartSetup::default())
                        .unwrap();
                let mut direction = vec![0.0; model.unknowns()];
                let u: Vec<f64> = patch
                    .node_places()
                    .into_iter()
                    .flat_map(|[i, j]| [0.1, 0.2, 0.0].map(|a| a * (a + (i * i + j) as f64).sin()))
                    .collect();
                model.load_direction(&u, &mut direction);
                direction
            };
            let (open, closed) = (forces(EdgeSupport::Free), forces(EdgeSupport::Clamped));
            let mut compared = 0;
            for (node, [i, _]) in patch.node_places().into_iter().enumerate() {
                for unknown in 3 * node..3 * node + 3 {
                    // The last side is in column 12, which a node beyond column 10 follows. Its triangles have
                    // nodes in column 7, of which the one on a side follows column 6.
                    if (4..=5).contains(&i) && closed[unknown] != 0.0 {
                        compared += 1;
                        let miss = (open[unknown] - closed[unknown]).abs();
                        assert!(miss < 1e-14, "{element:?} {i}: {miss:e}");
                    }
                }
            }
            assert!(closed.iter().any(|force| force.abs() > 1e-3));
            assert!(compared > 20, "{compared}");
        }
    }
}
