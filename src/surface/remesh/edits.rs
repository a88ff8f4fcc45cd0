//! The three edits of a triangulation: split, flip, collapse. Each keeps a closed 2-manifold one.

use crate::surface::half_edges::{HalfEdges, NONE, next, previous};

impl HalfEdges {
    /// Whether half-edge `h` is still part of the surface.
    pub(super) fn is_live(&self, h: u32) -> bool {
        self.origin(h) != NONE
    }

    /// The vertex opposite to `h` in its triangle.
    pub(super) fn apex(&self, h: u32) -> u32 {
        self.origin(previous(h))
    }

    /// Cuts the edge of `h` and its two triangles in half at a new vertex, which is returned.
    ///
    /// ```text
    ///      c              c            h0: a -> m  in (a, m, c)
    ///    /   \          / | \          h1: b -> m  in (b, m, d)
    ///   a --- b   ->   a -m- b         e:  m -> b  in (m, b, c)
    ///    \   /          \ | /          g:  m -> a  in (m, a, d)
    ///      d              d
    /// ```
    pub(super) fn split(&mut self, h0: u32) -> u32 {
        let h1 = self.twin(h0);
        let (n0, n1) = (next(h0), next(h1));
        let (a, b) = (self.origin(h0), self.origin(h1));
        let (c, d) = (self.apex(h0), self.apex(h1));
        let m = self.outgoing.len() as u32;
        let e = self.origins.len() as u32;
        let g = e + 3;
        self.origins.extend([m, b, c, m, a, d]);
        self.twins.extend([NONE; 6]);
        self.outgoing.push(e);
        self.join(e + 1, self.twin(n0));
        self.join(g + 1, self.twin(n1));
        self.start(n0, m);
        self.start(n1, m);
        self.outgoing[a as usize] = h0;
        self.outgoing[b as usize] = h1;
        self.join(n0, e + 2);
        self.join(n1, g + 2);
        self.join(h0, g);
        self.join(h1, e);
        m
    }

    /// Whether the other diagonal of the two triangles at `h` may replace its edge: no vertex is left
    /// with fewer than three edges, and the other diagonal is not an edge already.
    pub(super) fn can_flip(&self, h: u32) -> bool {
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        let roomy = |v: u32| self.valence(v) > 3;
        c != d
            && roomy(self.origin(h))
            && roomy(self.destination(h))
            && !self.ring(c).any(|v| v == d)
    }

    /// Turns the edge a -> b of `h` between (a, b, c) and (b, a, d) into the edge d -> c.
    pub(super) fn flip(&mut self, h0: u32) {
        let h1 = self.twin(h0);
        let [n0, p0, n1, p1] = [next(h0), previous(h0), next(h1), previous(h1)];
        let [b, c, a, d] = [n0, p0, n1, p1].map(|h| self.origin(h));
        let [bc, ca, ad, db] = [n0, p0, n1, p1].map(|h| self.twin(h));
        for (h, v) in [(h0, d), (n0, c), (p0, a), (h1, c), (n1, d), (p1, b)] {
            self.start(h, v);
        }
        self.join(n0, ca);
        self.join(p0, ad);
        self.join(n1, db);
        self.join(p1, bc);
    }

    /// Whether the edge of `h` may shrink to a point: its ends share no neighbours but the two apexes
    /// (the link condition), and no vertex is left with fewer than three edges.
    pub(super) fn can_collapse(&self, h: u32) -> bool {
        let (a, b) = (self.origin(h), self.destination(h));
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        let roomy = |v: u32| self.valence(v) > 3;
        roomy(c)
            && roomy(d)
            && self.valence(a) + self.valence(b) > 6
            && self.shared_neighbours(h) == 2
    }

    /// Moves every edge at a, the origin of `h`, to its destination b, and drops a with the two
    /// triangles at `h`.
    pub(super) fn collapse(&mut self, h0: u32) {
        let h1 = self.twin(h0);
        let (a, b) = (self.origin(h0), self.destination(h0));
        let (c, d) = (self.apex(h0), self.apex(h1));
        let spokes: Vec<u32> = self.spokes(a).collect();
        for h in spokes {
            self.origins[h as usize] = b;
        }
        let [cb, bc] = [next(h0), previous(h0)].map(|h| self.twin(h));
        let [db, bd] = [next(h1), previous(h1)].map(|h| self.twin(h));
        self.join(cb, bc);
        self.join(db, bd);
        self.outgoing[a as usize] = NONE;
        self.outgoing[b as usize] = bc;
        self.outgoing[c as usize] = cb;
        self.outgoing[d as usize] = db;
        for h in [h0, h1].into_iter().flat_map(|h| [h, next(h), previous(h)]) {
            self.origins[h as usize] = NONE;
        }
    }

    fn join(&mut self, h: u32, g: u32) {
        self.twins[h as usize] = g;
        self.twins[g as usize] = h;
    }

    fn start(&mut self, h: u32, v: u32) {
        self.origins[h as usize] = v;
        self.outgoing[v as usize] = h;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron: every valence is 4.
    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

    /// The adjacency made anew from the live triangles must agree with the edited one.
    fn check(surface: &HalfEdges) {
        let triangles: Vec<[u32; 3]> = surface
            .origins
            .chunks(3)
            .filter(|t| t[0] != NONE)
            .map(|t| [t[0], t[1], t[2]])
            .collect();
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let number = |v: u32| used.binary_search(&v).unwrap() as u32;
        let renumbered: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(number)).collect();
        let anew = HalfEdges::new(used.len(), &renumbered).unwrap();
        for (v, &old) in used.iter().enumerate() {
            let mut ring: Vec<u32> = surface.ring(old).map(number).collect();
            let first = anew.ring(v as u32).next().unwrap();
            let turn = ring.iter().position(|&w| w == first).unwrap();
            ring.rotate_left(turn);
            assert_eq!(ring, anew.ring(v as u32).collect::<Vec<_>>());
        }
    }

    #[test]
    fn edits_keep_the_adjacency() {
        for h in 0..24 {
            let mut surface = HalfEdges::new(6, &OCTAHEDRON).unwrap();
            assert_eq!(surface.split(h), 6);
            check(&surface);
            assert_eq!(surface.valence(6), 4);
            // Splitting an edge and collapsing either half gives the octahedron back.
            let halves: Vec<u32> = surface.spokes(6).collect();
            surface.collapse(halves[0]);
            check(&surface);
            assert_eq!(surface.edges().filter(|&h| surface.is_live(h)).count(), 12);
        }
        for h in 0..24 {
            let mut surface = HalfEdges::new(6, &OCTAHEDRON).unwrap();
            let (c, d) = (surface.apex(h), surface.apex(surface.twin(h)));
            assert!(surface.can_flip(h));
            surface.flip(h);
            check(&surface);
            assert!(surface.ring(c).any(|v| v == d));
        }
    }

    #[test]
    fn edits_that_break_the_manifold_are_refused() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let surface = HalfEdges::new(4, &tetrahedron).unwrap();
        assert!((0..12).all(|h| !surface.can_flip(h) && !surface.can_collapse(h)));
        // Two tetrahedra on a common face: its edges are a belt of three that must not shrink.
        let bipyramid = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
        let surface = HalfEdges::new(5, &bipyramid).unwrap();
        let belt = |h: &u32| surface.origin(*h) < 3 && surface.destination(*h) < 3;
        assert!((0..18).filter(belt).all(|h| !surface.can_collapse(h)));
    }
}
