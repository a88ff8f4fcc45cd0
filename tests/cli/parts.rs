//! Parts that several tests simulate.

use std::collections::BTreeMap;
use std::fmt::Write;

/// A scene of the published seed in triangles of `edge` (mm), of neo-Hookean rubber; at 0.012 MPa it bends by some 10 mm.
pub(crate) fn bent(edge: f64, pressure: f64, steps: usize) -> String {
    format!(
        "[part]\nnetwork = \"network.toml\"\n[mesh]\nedge = {edge:?}\n[material]\nlaw = \"neo-hookean\"\nmu = 1.0\n\
         [load]\npressure = {pressure:?}\n[load.path]\nsteps = {steps}\n[solver]\nbackend = \"native\"\n"
    )
}

/// A strip of 20 x 4 mm of neo-Hookean rubber, clamped at x = 0; its wall and what loads it are still wanted.
pub(crate) const STRIP: &str = r#"
[part.patch]
s = [0, 20]
t = [0, 4]
cells = [10, 2]
x = "s"
y = "t"
z = "0"

[material]
law = "neo-hookean"
mu = 1.0

[solver]
backend = "native"

[[edge]]
side = "s0"
clamped = true
"#;

/// A cell by its place in each direction, from 0.
pub(crate) type Cell = [usize; 3];

/// Cubes of six tetrahedra each, from the origin on, but for some.
pub(crate) struct Body {
    /// Of a cube, mm.
    edge: f64,
    cells: Cell,
    tetrahedra: Vec<([u32; 4], Cell)>,
}

/// A face's group, or none.
pub(crate) type GroupOf<'a> = &'a dyn Fn([f64; 3], bool) -> i64;

impl Body {
    /// So many cubes in each direction but those left out, with an `edge` of so many mm.
    pub(crate) fn without(edge: f64, cells: Cell, left_out: &[Cell]) -> Self {
        let mut tetrahedra = Vec::new();
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                for k in (0..cells[2]).filter(|&k| !left_out.contains(&[i, j, k])) {
                    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]
                    {
                        let mut at = [i, j, k];
                        let mut corners = [Self::vertex(cells, at); 4];
                        for (corner, axis) in corners[1..].iter_mut().zip(order) {
                            at[axis] += 1;
                            *corner = Self::vertex(cells, at);
                        }
                        tetrahedra.push((corners, [i, j, k]));
                    }
                }
            }
        }
        Self { edge, cells, tetrahedra }
    }

    fn vertex(cells: Cell, [i, j, k]: Cell) -> u32 {
        ((i * (cells[1] + 1) + j) * (cells[2] + 1) + k) as u32
    }

    fn place(&self, v: u32) -> [f64; 3] {
        let [ny, nz] = [self.cells[1] + 1, self.cells[2] + 1];
        let v = v as usize;
        [v / (ny * nz), v / nz % ny, v % nz].map(|n| self.edge * n as f64)
    }

    /// The faces of the boundary, each with its middle and whether it lies on the block's outside.
    fn faces(&self) -> Vec<([u32; 3], [f64; 3], bool)> {
        let mut count: BTreeMap<[u32; 3], usize> = BTreeMap::new();
        for ([a, b, c, d], _) in &self.tetrahedra {
            for mut face in [[*a, *b, *c], [*a, *b, *d], [*a, *c, *d], [*b, *c, *d]] {
                face.sort_unstable();
                *count.entry(face).or_default() += 1;
            }
        }
        let alone = count.into_iter().filter(|(_, count)| *count == 1);
        alone
            .map(|(face, _)| {
                let corners = face.map(|v| self.place(v));
                let is_outer = (0..3).any(|axis| {
                    let end = self.edge * self.cells[axis] as f64;
                    [0.0, end].iter().any(|end| corners.iter().all(|x| x[axis] == *end))
                });
                let middle = [0, 1, 2].map(|k| corners.iter().map(|x| x[k]).sum::<f64>() / 3.0);
                (face, middle, is_outer)
            })
            .collect()
    }

    /// A file of version 2.2 without groups of faces, its cells in one group.
    pub(crate) fn plain_text(&self) -> String {
        self.text(&[], &|_, _| 0, &|_| 1)
    }

    /// A file of version 2.2 with the groups of faces (0 is none) and of cells, and their names.
    pub(crate) fn text(
        &self,
        names: &[&str],
        group_of: GroupOf<'_>,
        volume_of: &dyn Fn(Cell) -> i64,
    ) -> String {
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned();
        if !names.is_empty() {
            let names = format!("{}\n{}", names.len(), names.join("\n"));
            writeln!(text, "$PhysicalNames\n{names}\n$EndPhysicalNames").unwrap();
        }
        let nodes = self.cells.iter().map(|n| n + 1).product::<usize>() as u32;
        writeln!(text, "$Nodes\n{nodes}").unwrap();
        for v in 0..nodes {
            let [x, y, z] = self.place(v);
            writeln!(text, "{} {x} {y} {z}", v + 1).unwrap();
        }
        let mut elements = Vec::new();
        for (face, middle, is_outer) in self.faces() {
            let group = group_of(middle, is_outer);
            if group != 0 {
                let [a, b, c] = face.map(|v| v + 1);
                elements.push(format!("2 2 {group} {group} {a} {b} {c}"));
            }
        }
        for (corners, cell) in &self.tetrahedra {
            let ([a, b, c, d], group) = (corners.map(|v| v + 1), volume_of(*cell));
            elements.push(format!("4 2 {group} {group} {a} {b} {c} {d}"));
        }
        writeln!(text, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
        for (number, element) in elements.iter().enumerate() {
            writeln!(text, "{} {element}", number + 1).unwrap();
        }
        text + "$EndElements\n"
    }
}
