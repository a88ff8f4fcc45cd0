//! The nodes of a shell or of a solid, the wall over them, and the points of its surface: what a model is built on.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::edge_support::{
    EdgeSupport, EdgeSupports, Supported, supports_of_control_points, supports_of_facets,
};
use super::element::{
    ElementPoints, LoopBasis, LoopShell, MidEdgeShell, SampledSurface, TaylorHood, ascending,
    fitted_control_points, mid_edge_patches, volume_matched,
};
use super::load::{
    CarriedForce, ChamberPressure, Fan, Follower, FollowerForce, Loaded, MomentEdge, OpenEdge,
};
use super::local::{LocalDerivatives, Term};
use super::material::Material;
use super::part_term::PartTerm;
use super::patch_loads::PatchLoads;
use super::system::Inadmissible;
use super::tie::Ties;
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::{
    BoundaryEdge, Patch, Section, ShellElement, ShellMesh, Side, SolidMesh, Stencil,
};

/// The stored energy of a wall of any element.
#[derive(Clone, Debug)]
pub(super) enum Wall {
    Loop(LoopShell),
    MidEdge(MidEdgeShell),
    Solid(TaylorHood),
}

/// What a model is built on.
pub(super) struct Discretization {
    /// Nodes at rest, mm.
    pub(super) reference: Vec<Vec3>,
    /// Nodes after them whose unknown is a pressure.
    pub(super) pressures: usize,
    pub(super) wall: Wall,
    /// Of each triangle.
    pub(super) points: Vec<ElementPoints>,
    pub(super) surface: SampledSurface,
    pub(super) ties: Ties,
    /// Unknowns that ties and supports hold, `3 node + axis`.
    pub(super) held: Vec<u32>,
    /// Reference area of each triangle, mm^2.
    pub(super) areas: Vec<f64>,
    /// Mean thickness of the wall over each triangle, mm.
    thickness: Vec<f64>,
}

impl Discretization {
    /// Of a closed part.
    ///
    /// # Errors
    /// [`Rejected`] when a fold is tighter than half the wall, or the limit surface cannot follow the mesh.
    pub(super) fn closed(mesh: &ShellMesh, materials: &[Material]) -> Result<Self, Rejected> {
        let triangles = &mesh.surface.triangles;
        let section = &mesh.section;
        let bases = LoopBasis::of_stencils(&mesh.stencils);
        let control = fitted_control_points(mesh, &bases)?;
        let limit = ElementPoints::of_stencils(&mesh.stencils, &bases);
        let (reference, wall, points, areas) = match mesh.element {
            ShellElement::Loop => {
                let wall = LoopShell::new(&mesh.stencils, &bases, &control, section, materials)?;
                let areas = loop_areas(&mesh.stencils, &bases, &control);
                (control, Wall::Loop(wall), limit, areas)
            }
            ShellElement::MidEdge => {
                // Of a part with sharp edges the limit surface is another one.
                let reference = if mesh.sharp_edges.is_empty() {
                    let smooth = ChamberPressure::new(&limit).volume(&control);
                    volume_matched(&mesh.surface, smooth)?
                } else {
                    mesh.surface.positions.clone()
                };
                let patches = mid_edge_patches(triangles, &BTreeMap::new());
                let sharp = &mesh.sharp_edges;
                let wall = MidEdgeShell::new(&patches, sharp, &reference, section, materials)?;
                let areas = facet_areas(triangles, &reference);
                (reference, Wall::MidEdge(wall), facet_points(triangles), areas)
            }
        };
        let surface =
            SampledSurface::new(triangles, &points, mesh.surface.positions.len(), section);
        let (ties, held) = (Ties::default(), Vec::new());
        let thickness = mean_thickness(section, triangles);
        Ok(Self { reference, pressures: 0, wall, points, surface, ties, held, areas, thickness })
    }

    /// Of a solid wall about `thickness` (mm) thick.
    ///
    /// # Errors
    /// [`Rejected`] when a cell is inverted at rest, or the material has no law for solids.
    pub(super) fn solid(
        mesh: &SolidMesh,
        thickness: f64,
        materials: &[Material],
    ) -> Result<Self, Rejected> {
        let law = |material: &Material| {
            material.solid().ok_or_else(|| {
                let detail = "the material is one of shells alone".to_owned();
                Rejected::new(Room::Model, Reason::NoSolidLaw, detail, 1.0)
            })
        };
        let laws = materials.iter().map(law).collect::<Result<Vec<_>, _>>()?;
        let (boundary, nodes) = mesh.boundary();
        let areas = facet_areas(&boundary.triangles, &boundary.positions);
        let size = (areas.iter().sum::<f64>() / areas.len() as f64).sqrt();
        let wall = Wall::Solid(TaylorHood::new(mesh, &laws, size)?);
        let points: Vec<_> = mesh.faces().map(ElementPoints::of_quadratic).collect();
        let surface = SampledSurface::new(
            &boundary.triangles,
            &points,
            nodes.len(),
            &Section::uniform(thickness),
        );
        Ok(Self {
            reference: mesh.positions.clone(),
            pressures: mesh.corners,
            wall,
            points,
            surface,
            ties: Ties::default(),
            held: Vec::new(),
            thickness: vec![thickness; areas.len()],
            areas,
        })
    }

    /// Of an open patch.
    ///
    /// # Errors
    /// [`Rejected`] when a fold is tighter than half the wall, or a support does not fit the patch.
    pub(super) fn of_patch(
        patch: &Patch,
        element: ShellElement,
        loads: &PatchLoads,
        materials: &[Material],
    ) -> Result<Self, Rejected> {
        let PatchLoads { supports, pins, .. } = loads;
        let triangles = &patch.surface.triangles;
        let section = &patch.section;
        let (supported, reference, wall, points, areas) = match element {
            ShellElement::Loop => {
                let bases = patch_bases(patch);
                let reference = patch.control_points();
                let stencils = &patch.stencils;
                let wall = LoopShell::new(stencils, &bases, &reference, section, materials)?;
                let areas = loop_areas(stencils, &bases, &reference);
                let points = ElementPoints::of_stencils(stencils, &bases);
                let supported = supports_of_control_points(patch, supports, pins)?;
                (supported, reference, Wall::Loop(wall), points, areas)
            }
            ShellElement::MidEdge => {
                let (supported, reference) = supports_of_facets(patch, supports, pins)?;
                let beyond =
                    patch.boundary_edges().into_iter().map(|edge| (edge.ends, edge.beyond));
                let patches = mid_edge_patches(triangles, &beyond.collect());
                let sharp = &BTreeSet::new();
                let wall = MidEdgeShell::new(&patches, sharp, &reference, section, materials)?;
                let areas = facet_areas(triangles, &reference);
                (supported, reference, Wall::MidEdge(wall), facet_points(triangles), areas)
            }
        };
        let Supported { ties, held } = supported;
        let surface = SampledSurface::new(triangles, &points, patch.vertices(), section);
        let thickness = mean_thickness(section, triangles);
        Ok(Self { reference, pressures: 0, wall, points, surface, ties, held, areas, thickness })
    }

    /// The volume of the wall at rest that belongs to each node, `int N_i dV`, mm^3.
    pub(super) fn node_volumes(&self) -> Vec<f64> {
        if let Wall::Solid(body) = &self.wall {
            return body.node_volumes();
        }
        let mut volumes = vec![0.0; self.reference.len()];
        for ((points, area), thickness) in self.points.iter().zip(&self.areas).zip(&self.thickness)
        {
            for (&node, weights) in points.nodes.iter().zip(&points.weights) {
                // The three edge midpoints integrate quadratics.
                let mean = (weights[3] + weights[4] + weights[5]) / 3.0;
                volumes[node as usize] += mean * area * thickness;
            }
        }
        volumes
    }

    /// The pressure on a patch: of its chamber, closed by its cuts in the planes of symmetry; where a side is open, of the volume
    /// over a point, with what its rim adds for a `pressure` (MPa).
    ///
    /// # Errors
    /// [`Rejected`] where planes of symmetry of a closed chamber face each other along two axes: their cuts meet in no common
    /// point.
    pub(super) fn pressure_of(
        &self,
        patch: &Patch,
        supports: &EdgeSupports,
        pressure: f64,
        points_of: impl Fn(&BoundaryEdge) -> [usize; 3],
    ) -> Result<(ChamberPressure, Carriers), Rejected> {
        let edges = patch.boundary_edges();
        let is_fixed =
            |support| support == EdgeSupport::Clamped || support == EdgeSupport::Held([true; 3]);
        let is_open = edges.iter().any(|edge| {
            let support = supports[edge.side as usize];
            !is_fixed(support) && !matches!(support, EdgeSupport::Symmetry(_))
        });
        if !is_open {
            return Ok((self.cut_chamber(&edges, patch, supports, points_of)?, Carriers::new()));
        }
        let end = |edge: &BoundaryEdge| patch.surface.positions[edge.ends[0] as usize];
        let origin = edges.iter().map(end).sum::<Vec3>() / edges.len() as f64;
        let rim = edges.iter().filter(|edge| !is_fixed(supports[edge.side as usize]));
        let followers = rim.map(|edge| {
            let [a, b, middle] = points_of(edge);
            let points = &self.points[edge.triangle];
            let rows = points.weights.iter().map(|w| [w[a], w[middle], w[b]]).collect();
            let kept = match supports[edge.side as usize] {
                EdgeSupport::Symmetry(axis) => Vec3::from_fn(|k, _| f64::from(k != axis)),
                _ => Vec3::repeat(1.0),
            };
            let open = OpenEdge { rows, pressure, origin, kept };
            (points.nodes.clone(), Follower::OpenEdge(open))
        });
        Ok((ChamberPressure::cut(&self.points, Vec::new(), origin), followers.collect()))
    }

    /// The chamber of a patch whose sides are all fixed or in planes of symmetry.
    fn cut_chamber(
        &self,
        edges: &[BoundaryEdge],
        patch: &Patch,
        supports: &EdgeSupports,
        points_of: impl Fn(&BoundaryEdge) -> [usize; 3],
    ) -> Result<ChamberPressure, Rejected> {
        let end = |edge: &BoundaryEdge| patch.surface.positions[edge.ends[0] as usize];
        // A point that all planes share, but for the second of two that face each other.
        let mut origin = edges.iter().map(end).sum::<Vec3>() / edges.len() as f64;
        let mut planes: [Vec<f64>; 3] = Default::default();
        for edge in edges {
            if let EdgeSupport::Symmetry(axis) = supports[edge.side as usize] {
                let place = end(edge)[axis];
                let size = patch.surface.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
                if planes[axis].iter().all(|plane| (plane - place).abs() > 1e-6 * size) {
                    planes[axis].push(place);
                }
            }
        }
        if planes.iter().filter(|planes| planes.len() > 1).count() > 1 {
            let detail = "pressure cannot be cut by planes of symmetry that face each other along two axes; model a part between fewer planes";
            return Err(Rejected::new(Room::Model, Reason::OpenChamber, detail.to_owned(), 1.0));
        }
        for (origin, planes) in origin.iter_mut().zip(&planes) {
            *origin = planes.first().copied().unwrap_or(*origin);
        }
        let mut fans = Vec::new();
        for edge in edges {
            if let EdgeSupport::Symmetry(axis) = supports[edge.side as usize] {
                let mut apex = origin;
                apex[axis] = end(edge)[axis];
                let [a, b, middle] = points_of(edge);
                let points = self.points[edge.triangle].clone();
                fans.push(Fan { points, along: [a, middle, b], apex });
            }
        }
        Ok(ChamberPressure::cut(&self.points, fans, origin))
    }

    /// Edges of a patch's `side` that carry the moment `per_length` (N mm / mm), with their nodes.
    ///
    /// # Errors
    /// [`Rejected`] when the moment's axis is not along the side.
    pub(super) fn moment_edges(
        &self,
        patch: &Patch,
        side: Side,
        per_length: Vec3,
        length: impl Fn(&BoundaryEdge) -> f64,
    ) -> Result<(Vec<Vec<u32>>, Vec<MomentEdge>), Rejected> {
        let axis = per_length.normalize();
        let along = |edge: &BoundaryEdge| {
            let [a, b] = edge.ends.map(|v| patch.surface.positions[v as usize]);
            (b - a).normalize().cross(&axis).norm() <= 1e-6
        };
        if !patch.boundary_edges().iter().filter(|edge| edge.side == side).all(along) {
            let detail = format!(
                "the moment on side {side:?} wants an axis, other than 0, along the side, which is straight"
            );
            return Err(Rejected::new(Room::Model, Reason::NoAxis, detail, 1.0));
        }
        let edges = patch.boundary_edges().into_iter().filter(|edge| edge.side == side);
        let of_edge = |edge: BoundaryEdge| {
            let triangle = patch.surface.triangles[edge.triangle];
            let share = |corner: u32| if edge.ends.contains(&corner) { 0.5 } else { 0.0 };
            let middle = [triangle[1], triangle[2]].map(share);
            let (nodes, rows) = self.tangent_rows(patch, edge.triangle, middle);
            let moment = per_length.norm() * length(&edge);
            let mut tangents = [Vec3::zeros(); 2];
            for (&node, row) in nodes.iter().zip(&rows) {
                let x = self.reference[node as usize];
                tangents[0] += row[0] * x;
                tangents[1] += row[1] * x;
            }
            let p = tangents[0].cross(&tangents[1]).normalize();
            (nodes, MomentEdge { rows, moment, p, q: axis.cross(&p), settled: 0.0 })
        };
        Ok(edges.map(of_edge).unzip())
    }

    /// What carries the `followers`, with their nodes.
    pub(super) fn carriers(
        &self,
        patch: &Patch,
        followers: &[FollowerForce],
        loaded: &Loaded<'_>,
    ) -> Carriers {
        let mut carriers = Carriers::new();
        for follower in followers {
            match *follower {
                FollowerForce::Point { vertex, force } => {
                    let triangles = &patch.surface.triangles;
                    let of_vertex = |(k, triangle): (usize, &[u32; 3])| {
                        Some((k, triangle.iter().position(|&v| v == vertex)?))
                    };
                    let (triangle, corner) = triangles
                        .iter()
                        .enumerate()
                        .find_map(of_vertex)
                        .expect("every vertex has a triangle");
                    let place = PARAMETERS[corner];
                    let share = |w: &[f64; 6]| w[corner];
                    carriers.push(self.carrier(patch, triangle, place, [1.0, 0.0], share, force));
                }
                FollowerForce::Edge { side, per_length } => {
                    for edge in loaded.edges.iter().filter(|edge| edge.side == side) {
                        let [a, b, middle] = loaded.points_of(edge);
                        let [[va, wa], [vb, wb]] = [PARAMETERS[a], PARAMETERS[b]];
                        let place = [0.5 * (va + vb), 0.5 * (wa + wb)];
                        // Simpson's rule over the edge's ends and middle.
                        let share = |w: &[f64; 6]| (w[a] + 4.0 * w[middle] + w[b]) / 6.0;
                        let force = loaded.length(edge) * per_length;
                        let along = [vb - va, wb - wa];
                        carriers.push(self.carrier(
                            patch,
                            edge.triangle,
                            place,
                            along,
                            share,
                            force,
                        ));
                    }
                }
            }
        }
        carriers
    }

    /// A force on a triangle that keeps its angle to the wall at `place`, where `along` is a tangent of the wall.
    fn carrier(
        &self,
        patch: &Patch,
        triangle: usize,
        place: [f64; 2],
        [v, w]: [f64; 2],
        share: impl Fn(&[f64; 6]) -> f64,
        force: Vec3,
    ) -> (Vec<u32>, Follower) {
        let (nodes, tangents) = self.tangent_rows(patch, triangle, place);
        let x: Vec<Vec3> = nodes.iter().map(|&node| self.reference[node as usize]).collect();
        // The second tangent stands to the left of the first in the parameters.
        let row = |([d1, d2], weights): (&[f64; 2], &[f64; 6])| {
            [share(weights), v * d1 + w * d2, v * d2 - w * d1]
        };
        let rows = tangents.iter().zip(&self.points[triangle].weights).map(row).collect();
        (nodes, Follower::Carried(CarriedForce::new(rows, force, &x)))
    }

    /// `[,1 ,2]` of the nodes of a triangle, at the parameters `place` of its second and third corner.
    fn tangent_rows(
        &self,
        patch: &Patch,
        triangle: usize,
        [v, w]: [f64; 2],
    ) -> (Vec<u32>, Vec<[f64; 2]>) {
        match &self.wall {
            Wall::MidEdge(_) => {
                let corners = patch.surface.triangles[triangle];
                ascending(&corners, &[[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
            }
            Wall::Loop(_) | Wall::Solid(_) => {
                let rows = LoopBasis::regular(v, w);
                let rows: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
                ascending(&patch.stencils[triangle].nodes, &rows)
            }
        }
    }
}

/// Forces without a potential, with their nodes.
pub(super) type Carriers = Vec<(Vec<u32>, Follower)>;

/// Of a triangle's corners, along its edges from the first.
const PARAMETERS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// One point of quadrature inside, three beside the edges: the nodes beyond an edge belong to few triangles, and one point
/// in each would leave them soft.
fn patch_bases(patch: &Patch) -> Vec<Rc<LoopBasis>> {
    let [one, three] = [LoopBasis::new([6; 3]), LoopBasis::with_three_points()].map(Rc::new);
    let basis = |stencil: &Stencil| {
        let beside_edge = stencil.nodes.iter().any(|&v| v as usize >= patch.vertices());
        if beside_edge { three.clone() } else { one.clone() }
    };
    patch.stencils.iter().map(basis).collect()
}

fn loop_areas(stencils: &[Stencil], bases: &[Rc<LoopBasis>], control: &[Vec3]) -> Vec<f64> {
    let area = |(stencil, basis): (&Stencil, &Rc<LoopBasis>)| {
        let x: Vec<Vec3> = stencil.nodes.iter().map(|&v| control[v as usize]).collect();
        basis.area(&x)
    };
    stencils.iter().zip(bases).map(area).collect()
}

fn mean_thickness(section: &Section, triangles: &[[u32; 3]]) -> Vec<f64> {
    triangles.iter().map(|&corners| section.mean_thickness(corners)).collect()
}

fn facet_areas(triangles: &[[u32; 3]], positions: &[Vec3]) -> Vec<f64> {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        (b - a).cross(&(c - a)).norm() / 2.0
    };
    triangles.iter().map(area).collect()
}

fn facet_points(triangles: &[[u32; 3]]) -> Vec<ElementPoints> {
    triangles.iter().map(|&triangle| ElementPoints::of_facet(triangle)).collect()
}

impl Wall {
    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    pub(super) fn creased_share(&self) -> f64 {
        match self {
            Self::Loop(wall) => wall.creased_share(),
            Self::MidEdge(wall) => wall.creased_share(),
            Self::Solid(_) => 0.0,
        }
    }
}

impl PartTerm for Wall {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }
}

impl Term for Wall {
    fn stencils(&self) -> &[Vec<u32>] {
        match self {
            Self::Loop(wall) => wall.stencils(),
            Self::MidEdge(wall) => wall.stencils(),
            Self::Solid(wall) => wall.stencils(),
        }
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        match self {
            Self::Loop(wall) => wall.energy(s, x),
            Self::MidEdge(wall) => wall.energy(s, x),
            Self::Solid(wall) => wall.energy(s, x),
        }
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        match self {
            Self::Loop(wall) => wall.derivatives(s, x, local),
            Self::MidEdge(wall) => wall.derivatives(s, x, local),
            Self::Solid(wall) => wall.derivatives(s, x, local),
        }
    }
}
