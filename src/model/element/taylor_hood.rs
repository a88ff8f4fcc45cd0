//! Quadratic tetrahedra for rubber: displacements on ten nodes, a continuous pressure on the four corners (Taylor & Hood).
//!
//! ```text
//! L(x, p) = sum_q dV_q [ psi_iso(F) + p (J - 1) - p^2 / (2 kappa) ]        F = sum_i x_i (x) G_i,   J = det F
//! R_i  = dV (P_iso + p cof F) G_i                          cof F = J F^-T
//! R_a  = dV L_a (J - 1 - p / kappa)
//! K_ij = dV [ G_i . A . G_j + [p F (G_j x G_i)]x ]           [v]x w = v x w
//! K_ai = dV L_a (cof F G_i)^T        K_ab = -dV L_a L_b / kappa
//! ```
//!
//! At a solution `L` is the stored energy, and it is a saddle: least in the displacements, largest in the pressures. So a stable
//! state has one negative pivot for each pressure. Nothing locks, up to the incompressible limit: there `1 / kappa` is 0 in the
//! residual, and a little in the tangent, which so can be factorised without pivoting; Newton's method does not notice.
//!
//! The unknown of a corner is a length: `p = pressure_unit * q`, so that all residuals are forces.
//! Cells with curved edges are isoparametric. Quadrature is exact to degree 5, by 14 points inside the cell.
//!
//! Source: Taylor & Hood (1973); Sussman & Bathe (1987), the energy. Rule: Walkington (2000), also Grundmann & Moeller (1978).

use nalgebra::Matrix3;

use crate::math::{Reason, Rejected, Room, Vec3, cofactor};
use crate::mesh::{SolidMesh, TET_EDGES, quadratic_shapes, quadratic_slopes};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::material::SolidLaw;
use crate::model::system::Inadmissible;

/// The stored energy of a body of quadratic tetrahedra.
#[derive(Clone, Debug)]
pub struct TaylorHood {
    /// Of each cell its ten nodes and then its four pressures, both ascending.
    stencils: Vec<Vec<u32>>,
    cells: Vec<Cell>,
    /// Nodes at rest, mm.
    reference: Vec<Vec3>,
    laws: Vec<SolidLaw>,
    /// The place of each cell's law; empty where all have the first.
    materials: Vec<u16>,
    /// MPa for each mm of an unknown.
    pressure_unit: f64,
}

/// Which shape function each member of a stencil has.
#[derive(Clone, Copy, Debug)]
struct Cell {
    nodes: [u8; NODES],
    corners: [u8; CORNERS],
}

impl TaylorHood {
    /// The cells of `mesh`, whose materials are places in `laws`, and whose pressures are the nodes after those of the mesh; `size` is about theirs, mm.
    ///
    /// # Errors
    /// [`Rejected`] when a cell is inverted at rest.
    pub fn new(mesh: &SolidMesh, laws: &[SolidLaw], size: f64) -> Result<Self, Rejected> {
        let first_pressure = mesh.positions.len() as u32;
        let (stencils, cells) = mesh.tetrahedra.iter().map(|t| stencil(t, first_pressure)).unzip();
        let stiffest = laws.iter().map(SolidLaw::shear_modulus).fold(0.0, f64::max);
        let pressure_unit = stiffest / size;
        let reference = mesh.positions.clone();
        let (laws, materials) = (laws.to_vec(), mesh.materials.clone());
        let body = Self { stencils, cells, reference, laws, materials, pressure_unit };
        for (s, nodes) in mesh.tetrahedra.iter().enumerate() {
            if body.shapes(s).any(|point| point.is_none()) {
                let at = body.reference[nodes[0] as usize];
                let detail =
                    format!("cell {s} at ({:.3}, {:.3}, {:.3}) mm is inverted", at.x, at.y, at.z);
                return Err(Rejected::new(Room::Model, Reason::InvertedCell, detail, 1.0));
            }
        }
        Ok(body)
    }

    /// The volume at rest, mm^3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        (0..self.cells.len()).flat_map(|s| self.shapes(s)).flatten().map(|shape| shape.dv).sum()
    }

    /// The volume at rest that belongs to each node, `int N_i dV`, mm^3.
    #[must_use]
    pub fn node_volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.reference.len()];
        for (s, (stencil, cell)) in self.stencils.iter().zip(&self.cells).enumerate() {
            for Shapes { corners, dv, .. } in self.shapes(s).flatten() {
                let mut barycentric = [0.0; CORNERS];
                for (&local, l) in cell.corners.iter().zip(corners) {
                    barycentric[local as usize] = l;
                }
                let shapes = quadratic_shapes(&barycentric);
                for (&node, &local) in stencil.iter().zip(&cell.nodes) {
                    volumes[node as usize] += shapes[local as usize] * dv;
                }
            }
        }
        volumes
    }

    /// Of each of `pressures`, about `-B A^-1 B^T + C` on the diagonal, sign changed: `(1 / mu + 1 / kappa) unit^2 int L_a^2 dV`,
    /// N/mm. Source: Silvester & Wathen (1994), for the Stokes equations.
    #[must_use]
    pub fn pressure_complements(&self, pressures: usize) -> Vec<f64> {
        let first = self.reference.len();
        let mut sums = vec![0.0; pressures];
        for (s, stencil) in self.stencils.iter().enumerate() {
            let compliance = self.law(s).shear_modulus().recip() + self.compliance(s);
            let scale = compliance * self.pressure_unit * self.pressure_unit;
            for Shapes { corners, dv, .. } in self.shapes(s).flatten() {
                for (&node, l) in stencil[NODES..].iter().zip(corners) {
                    sums[node as usize - first] += scale * dv * l * l;
                }
            }
        }
        // A corner of no cell has a held pressure.
        sums.into_iter().map(|sum| if sum > 0.0 { sum } else { 1.0 }).collect()
    }

    /// The ten nodes of each cell, in the order of [`SolidMesh`].
    pub(super) fn tetrahedra(&self) -> impl Iterator<Item = [u32; NODES]> {
        self.stencils.iter().zip(&self.cells).map(|(stencil, cell)| {
            let mut nodes = [0; NODES];
            for (&node, local) in stencil.iter().zip(cell.nodes) {
                nodes[local as usize] = node;
            }
            nodes
        })
    }

    /// MPa for each mm of the unknown of a corner.
    pub(super) fn pressure_unit(&self) -> f64 {
        self.pressure_unit
    }

    /// Of the points of cell `s` the volume (mm^3), the deformation gradient, and Cauchy's stress (MPa), with its nodes at `x` and the
    /// unknowns `q` of its corners, both in the order of its stencil.
    pub(super) fn states_at_points(
        &self,
        s: usize,
        x: &[Vec3],
        q: &[Vec3],
    ) -> impl Iterator<Item = (f64, Matrix3<f64>, Matrix3<f64>)> {
        self.shapes(s).flatten().map(move |shapes| {
            let f = shapes.deformation_gradient(x);
            let p = self.pressure(&shapes, q);
            let nominal = self.law(s).response(&f, false).stress + p * cofactor(&f);
            (shapes.dv, f, nominal * f.transpose() / f.determinant())
        })
    }

    /// What the shape functions are at the points of quadrature of cell `s`; none where the cell is inverted at rest.
    fn shapes(&self, s: usize) -> impl Iterator<Item = Option<Shapes>> {
        let Cell { nodes, corners } = self.cells[s];
        let stencil = &self.stencils[s];
        RULE.points().map(move |Point { slopes, corners: values, weight }| {
            let mut to_place = Matrix3::zeros();
            for (&node, &local) in stencil.iter().zip(&nodes) {
                to_place += self.reference[node as usize] * slopes[local as usize].transpose();
            }
            let volume = to_place.determinant();
            if volume <= 0.0 || volume.is_nan() {
                return None;
            }
            let inverse = to_place.try_inverse()?.transpose();
            Some(Shapes {
                gradients: nodes.map(|local| inverse * slopes[local as usize]),
                corners: corners.map(|local| values[local as usize]),
                dv: weight * volume,
            })
        })
    }

    /// `p` at a point with the unknowns `q`, MPa.
    fn pressure(&self, shapes: &Shapes, q: &[Vec3]) -> f64 {
        let sum: f64 = shapes.corners.iter().zip(q).map(|(l, q)| l * q.x).sum();
        self.pressure_unit * sum
    }

    /// The place of the law of cell `s`.
    pub(super) fn material(&self, s: usize) -> u16 {
        self.materials.get(s).copied().unwrap_or(0)
    }

    fn law(&self, s: usize) -> &SolidLaw {
        &self.laws[usize::from(self.material(s))]
    }

    /// `1 / kappa` of cell `s`, 1/MPa.
    fn compliance(&self, s: usize) -> f64 {
        self.law(s).bulk_modulus().map_or(0.0, f64::recip)
    }

    /// `1 / kappa` as the tangent has it.
    fn tangent_compliance(&self, s: usize) -> f64 {
        self.compliance(s).max(LEAST_COMPLIANCE / self.law(s).shear_modulus())
    }
}

/// Shape functions at a point.
struct Shapes {
    /// With respect to places at rest, 1/mm.
    gradients: [Vec3; NODES],
    corners: [f64; CORNERS],
    /// mm^3.
    dv: f64,
}

impl Shapes {
    fn deformation_gradient(&self, x: &[Vec3]) -> Matrix3<f64> {
        let mut f = Matrix3::zeros();
        for (x, gradient) in x.iter().zip(&self.gradients) {
            f += x * gradient.transpose();
        }
        f
    }
}

/// The cell's sorted stencil, and what its members are in the cell.
fn stencil(nodes: &[u32; NODES], first_pressure: u32) -> (Vec<u32>, Cell) {
    let mut order: [u8; NODES] = std::array::from_fn(|k| k as u8);
    order.sort_by_key(|&k| nodes[k as usize]);
    let mut corners: [u8; CORNERS] = std::array::from_fn(|k| k as u8);
    corners.sort_by_key(|&k| nodes[k as usize]);
    let places = order.iter().map(|&k| nodes[k as usize]);
    let pressures = corners.iter().map(|&k| first_pressure + nodes[k as usize]);
    (places.chain(pressures).collect(), Cell { nodes: order, corners })
}

fn admissible(f: &Matrix3<f64>) -> Result<f64, Inadmissible> {
    let j = f.determinant();
    if j > 0.0 { Ok(j) } else { Err(Inadmissible("a cell is turned inside out")) }
}

impl Term for TaylorHood {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let (x, q) = x.split_at(NODES);
        let (compliance, law) = (self.compliance(s), self.law(s));
        let mut energy = 0.0;
        for shapes in self.shapes(s).flatten() {
            let f = shapes.deformation_gradient(x);
            let j = admissible(&f)?;
            let p = self.pressure(&shapes, q);
            energy += shapes.dv * (law.energy(&f) + p * (j - 1.0) - 0.5 * compliance * p * p);
        }
        Ok(energy)
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let (x, q) = x.split_at(NODES);
        let (compliance, unit, law) = (self.compliance(s), self.pressure_unit, self.law(s));
        let mut energy = 0.0;
        for shapes in self.shapes(s).flatten() {
            let Shapes { gradients, corners, dv } = &shapes;
            let f = shapes.deformation_gradient(x);
            let j = admissible(&f)?;
            let p = self.pressure(&shapes, q);
            let cofactor = cofactor(&f);
            let response = law.response(&f, local.with_hessian());
            energy += dv * (response.energy + p * (j - 1.0) - 0.5 * compliance * p * p);
            let stress = *dv * (response.stress + p * cofactor);
            let (by_place, by_pressure) = local.gradient_mut().split_at_mut(NODES);
            for (sum, gradient) in by_place.iter_mut().zip(gradients) {
                *sum += stress * gradient;
            }
            let dilation = dv * unit * (j - 1.0 - compliance * p);
            for (sum, l) in by_pressure.iter_mut().zip(corners) {
                sum.x += l * dilation;
            }
            if !local.with_hessian() {
                continue;
            }
            let between = -dv * unit * unit * self.tangent_compliance(s);
            for (b, lb) in corners.iter().enumerate() {
                for (a, la) in corners.iter().enumerate().skip(b) {
                    local.block_mut(NODES + a, NODES + b)[(0, 0)] += between * la * lb;
                }
            }
            for (k, gradient) in gradients.iter().enumerate() {
                let scaled = gradient * *dv;
                let stiffness =
                    response.moduli.map(|[x, y, z]| x * scaled.x + y * scaled.y + z * scaled.z);
                let force = dv * unit * cofactor * gradient;
                let (below, pressures) = local.column_mut(k).split_at_mut(NODES - k);
                for (block, other) in below.iter_mut().zip(&gradients[k..]) {
                    let [x, y, z] = &stiffness;
                    *block += x * other.x + y * other.y + z * other.z;
                    let [x, y, z] = (dv * p * (f * gradient.cross(other))).into();
                    block.add_cross([x, y, z, 0.0]);
                }
                for (block, l) in pressures.iter_mut().zip(corners) {
                    for axis in 0..3 {
                        block[(0, axis)] += l * force[axis];
                    }
                }
            }
        }
        Ok(energy)
    }
}

const NODES: usize = 10;
const CORNERS: usize = 4;
/// The least `mu / kappa` of a tangent: the pivots of pressures are not zero, and Newton's method gains six digits in a step.
const LEAST_COMPLIANCE: f64 = 1e-6;

/// A rule of quadrature over the tetrahedron `r, s, t >= 0, r + s + t <= 1`.
struct Rule {
    /// Of four points each: their weight, and a barycentric coordinate of which they have three.
    vertex_orbits: [[f64; 2]; 2],
    /// Of six points: their weight, and a barycentric coordinate of which they have two.
    edge_orbit: [f64; 2],
}

/// Degree 5, 14 points, all inside and with positive weights.
const RULE: Rule = Rule {
    vertex_orbits: [
        [0.018_781_320_953_002_64, 0.310_885_919_263_300_6],
        [0.012_248_840_519_393_658, 0.092_735_250_310_891_23],
    ],
    edge_orbit: [0.007_091_003_462_846_911, 0.045_503_704_125_649_65],
};

/// A point of quadrature.
struct Point {
    /// `dN/d(r, s, t)` of the ten nodes.
    slopes: [Vec3; NODES],
    /// Shape functions of the corners.
    corners: [f64; CORNERS],
    weight: f64,
}

impl Rule {
    fn points(&self) -> impl Iterator<Item = Point> + use<> {
        let vertex = self.vertex_orbits.into_iter().flat_map(|[weight, a]| {
            (0..4).map(move |k| {
                (weight, std::array::from_fn(|i| if i == k { 1.0 - 3.0 * a } else { a }))
            })
        });
        let [weight, c] = self.edge_orbit;
        let edge = TET_EDGES.map(|edge| {
            (weight, std::array::from_fn(|i| if edge.contains(&i) { c } else { 0.5 - c }))
        });
        vertex.chain(edge).map(|(weight, l)| Point {
            slopes: quadratic_slopes(&l),
            corners: l,
            weight,
        })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::{DVector, Rotation3};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::mesh::TetMesh;
    use crate::model::material::{Compressible, Material, MooneyRivlin, NeoHookean, Rubber};
    use crate::model::test_shells::{difference, random_matrix};

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// `r^i s^j t^k` integrates to `i! j! k! / (i + j + k + 3)!`.
    #[test]
    fn rule_is_exact_to_degree_5() {
        for (i, j, k) in (0..=5)
            .flat_map(|i| (0..=5).map(move |j| (i, j)))
            .flat_map(|(i, j)| (0..=5).map(move |k| (i, j, k)))
        {
            if i + j + k > 5 {
                continue;
            }
            let sum: f64 = RULE
                .points()
                .map(|p| {
                    p.weight * p.corners[1].powi(i) * p.corners[2].powi(j) * p.corners[3].powi(k)
                })
                .sum();
            let exact = factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
            assert_relative_eq!(sum, exact, max_relative = 1e-14);
        }
    }

    /// Five tetrahedra of a cube of 2 mm, their nodes moved about so that edges are curved.
    fn irregular(chance: &mut ChaCha8Rng) -> SolidMesh {
        let positions: Vec<Vec3> = (0..8)
            .map(|k| 2.0 * Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)))
            .collect();
        let tetrahedra = vec![[0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7], [1, 2, 4, 7]];
        let mut mesh =
            SolidMesh::straight(&TetMesh { positions, tetrahedra, ..TetMesh::default() });
        for x in &mut mesh.positions {
            *x += random_matrix(chance, 0.1).column(0);
        }
        mesh
    }

    fn law(compressible: bool) -> SolidLaw {
        let rubber = Rubber::MooneyRivlin(MooneyRivlin { c1: 0.4, c2: 0.2 });
        let material = if compressible {
            Material::Compressible(Compressible { law: rubber, bulk_modulus: 9.0 })
        } else {
            rubber.into()
        };
        material.solid().unwrap()
    }

    /// A body of irregular cells, a stencil of it, and nodes far from rest.
    fn states() -> impl Iterator<Item = (TaylorHood, usize, Vec<Vec3>)> {
        (0..4).map(|seed| {
            let mut chance = ChaCha8Rng::seed_from_u64(seed);
            let mesh = irregular(&mut chance);
            let body = TaylorHood::new(&mesh, &[law(true)], 2.0).unwrap();
            let s = seed as usize;
            let stretch = Matrix3::identity() + random_matrix(&mut chance, 0.25);
            let mut x: Vec<Vec3> = body.stencils[s][..NODES]
                .iter()
                .map(|&v| {
                    stretch * mesh.positions[v as usize]
                        + random_matrix(&mut chance, 0.05).column(0)
                })
                .collect();
            x.extend((0..4).map(|_| Vec3::new(random_matrix(&mut chance, 0.8)[(0, 0)], 0.0, 0.0)));
            (body, s, x)
        })
    }

    fn moved(x: &[Vec3], unknown: usize, step: f64) -> Vec<Vec3> {
        let mut x = x.to_vec();
        x[unknown / 3][unknown % 3] += step;
        x
    }

    fn gradient(body: &TaylorHood, s: usize, x: &[Vec3]) -> DVector<f64> {
        let mut local = LocalDerivatives::with_capacity(x.len());
        local.reset(x.len(), false);
        body.derivatives(s, x, &mut local).unwrap();
        DVector::from_iterator(3 * x.len(), local.gradient().iter().flatten().copied())
    }

    /// The unknowns of a stencil in the order of [`gradient`].
    fn unknowns() -> impl Iterator<Item = usize> {
        (0..3 * NODES).chain((NODES..NODES + CORNERS).map(|node| 3 * node))
    }

    #[test]
    fn derivatives_are_differences() {
        for (body, s, x) in states() {
            let exact = gradient(&body, s, &x);
            let mut local = LocalDerivatives::with_capacity(x.len());
            local.reset(x.len(), true);
            let energy = body.derivatives(s, &x, &mut local).unwrap();
            assert_relative_eq!(energy, body.energy(s, &x).unwrap(), max_relative = 1e-13);
            for unknown in unknowns() {
                // States vary over some 0.5 mm: (step / length)^4 = 1e-11, and rounding over the step.
                let slope = difference(1e-3, |h| body.energy(s, &moved(&x, unknown, h)).unwrap());
                assert!((slope - exact[unknown]).abs() < 1e-9 * exact.amax());
                let column = difference(1e-3, |h| gradient(&body, s, &moved(&x, unknown, h)));
                let (j, axis) = (unknown / 3, unknown % 3);
                for other in unknowns().filter(|other| other / 3 >= j) {
                    let entry = local.block(other / 3, j)[(other % 3, axis)];
                    assert!(
                        (column[other] - entry).abs() < 1e-9 * column.amax(),
                        "{other} {unknown}: {} {entry}",
                        column[other]
                    );
                }
            }
        }
    }

    /// An incompressible law's tangent differs from the derivative by the compliance that it lends its pivots, and nowhere else.
    #[test]
    fn incompressible_tangent_has_a_little_compliance() {
        let mut chance = ChaCha8Rng::seed_from_u64(9);
        let mesh = irregular(&mut chance);
        let body = TaylorHood::new(&mesh, &[law(false)], 2.0).unwrap();
        let mut x: Vec<Vec3> =
            body.stencils[0][..NODES].iter().map(|&v| mesh.positions[v as usize]).collect();
        x.extend([Vec3::x(); 4]);
        let mut local = LocalDerivatives::with_capacity(x.len());
        local.reset(x.len(), true);
        body.derivatives(0, &x, &mut local).unwrap();
        let volume: f64 = body.shapes(0).flatten().map(|shapes| shapes.dv).sum();
        let sum: f64 = (0..4)
            .flat_map(|b| (0..4).map(move |a| (a.max(b), a.min(b))))
            .map(|(a, b)| local.block(NODES + a, NODES + b)[(0, 0)])
            .sum();
        // mu = 1.2: unit 0.6 MPa/mm, compliance 1e-6 / 1.2; the shape functions of the corners sum to 1.
        assert_relative_eq!(sum, -volume * 0.36 * 1e-6 / 1.2, max_relative = 1e-12);
        let rows = gradient(&body, 0, &x);
        assert!((NODES..NODES + CORNERS).all(|node| rows[3 * node].abs() < 1e-14));
    }

    #[test]
    fn turning_a_body_turns_its_forces() {
        let turn = Rotation3::from_scaled_axis(Vec3::new(0.4, -1.0, 0.7));
        for (body, s, x) in states() {
            let mut turned = x.clone();
            turned[..NODES].iter_mut().for_each(|x| *x = turn * *x + Vec3::new(3.0, 1.0, -2.0));
            let (before, after) = (gradient(&body, s, &x), gradient(&body, s, &turned));
            assert_relative_eq!(
                body.energy(s, &turned).unwrap(),
                body.energy(s, &x).unwrap(),
                max_relative = 1e-12
            );
            for node in 0..NODES {
                let [before, after]: [Vec3; 2] =
                    [&before, &after].map(|g| g.fixed_rows::<3>(3 * node).into_owned());
                assert!((after - turn * before).norm() < 1e-12 * before.amax().max(1.0));
            }
        }
    }

    /// A uniform deformation has its energy and its volume, whatever the cells.
    #[test]
    fn uniform_deformation_is_exact() {
        let mut chance = ChaCha8Rng::seed_from_u64(3);
        let mesh = irregular(&mut chance);
        let law = Material::NeoHookean(NeoHookean { mu: 1.3 }).solid().unwrap();
        let body = TaylorHood::new(&mesh, &[law], 2.0).unwrap();
        let f = Matrix3::from_diagonal(&Vec3::new(1.25, 0.8, 1.0));
        let energy: f64 = (0..5)
            .map(|s| {
                let places = body.stencils[s][..NODES].iter();
                let mut x: Vec<Vec3> = places.map(|&v| f * mesh.positions[v as usize]).collect();
                x.extend([Vec3::x(); 4]);
                body.energy(s, &x).unwrap()
            })
            .sum();
        let density = 0.65 * (1.25 * 1.25 + 0.64 + 1.0 - 3.0);
        assert_relative_eq!(energy, density * body.volume(), max_relative = 1e-12);
    }

    /// Stretched along axes and then turned, incompressible: `sigma_i = mu (l_i^2 - (l_1^2 + l_2^2 + l_3^2) / 3) + p`, `P_i = sigma_i / l_i`.
    /// Where `p` is large, the largest stress is along the least stretch.
    #[test]
    fn peaks_are_those_along_principal_axes() {
        let mut chance = ChaCha8Rng::seed_from_u64(5);
        let mesh = irregular(&mut chance);
        let law = Material::NeoHookean(NeoHookean { mu: 1.3 }).solid().unwrap();
        let body = TaylorHood::new(&mesh, &[law], 2.0).unwrap();
        let stretches = [1.25, 0.8, 1.0_f64];
        let turn = Rotation3::new(Vec3::new(0.4, -1.1, 0.7)).into_inner();
        let f = turn * Matrix3::from_diagonal(&Vec3::from(stretches));
        for (q, along) in [(0.1, 0), (6.0, 1)] {
            let mut x: Vec<Vec3> = mesh.positions.iter().map(|x| f * x).collect();
            x.extend(vec![q * Vec3::x(); mesh.corners]);
            let mean = stretches.map(|l| l * l).iter().sum::<f64>() / 3.0;
            let l = stretches[along];
            let stress = (1.3 * (l * l - mean) + q * body.pressure_unit) / l;
            let peaks = body.peaks(&x);
            assert_eq!(peaks.len(), 5 * 14);
            for peak in peaks {
                assert_relative_eq!(peak.stretch, 1.25, max_relative = 1e-12);
                assert_relative_eq!(peak.nominal_stress, stress, max_relative = 1e-11);
            }
        }
    }

    #[test]
    fn inverted_cells_are_refused() {
        let mut mesh = irregular(&mut ChaCha8Rng::seed_from_u64(0));
        mesh.tetrahedra[2].swap(0, 1);
        assert_eq!(
            TaylorHood::new(&mesh, &[law(true)], 2.0).unwrap_err().reason,
            Reason::InvertedCell
        );
        for (body, s, mut x) in states().take(1) {
            x[..NODES].iter_mut().for_each(|x| x.z = -x.z);
            assert!(body.energy(s, &x).is_err());
        }
    }
}
