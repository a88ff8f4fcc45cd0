//! Union and find: what belongs together, told pair by pair.

/// Disjoint sets of the numbers from 0 on, at first each in one of its own.
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    /// So many sets of one number.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The least number of the set of `member`.
    #[inline]
    pub fn root(&mut self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            let grandparent = self.parents[self.parents[member as usize] as usize];
            self.parents[member as usize] = grandparent;
            member = grandparent;
        }
        member
    }

    /// Makes one of the sets of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The set of each of `members`, the sets numbered from 0 in the order of their first members.
    pub fn numbers(mut self, members: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut numbers = vec![None; self.parents.len()];
        let mut count = 0;
        let number = |member| {
            *numbers[self.root(member) as usize].get_or_insert_with(|| {
                count += 1;
                count - 1
            })
        };
        members.map(number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_make_sets() {
        let mut sets = DisjointSets::new(7);
        for [a, b] in [[5, 1], [2, 6], [6, 1], [3, 3]] {
            sets.join(a, b);
        }
        assert_eq!(sets.root(6), 1);
        assert_eq!(sets.clone().numbers(0..7), [0, 1, 1, 2, 3, 1, 1]);
        assert_eq!(sets.numbers([4, 6, 2].into_iter()), [0, 1, 1]);
    }
}
