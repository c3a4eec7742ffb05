//! Which of many things hang together: a disjoint-set forest.

/// Sets of indices, joined pair by pair.
pub(crate) struct Sheets {
    parent: Vec<usize>,
}

impl Sheets {
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count).collect(),
        }
    }

    /// The representative of the set that holds `index`.
    pub fn root(&mut self, index: usize) -> usize {
        let mut at = index;
        while self.parent[at] != at {
            self.parent[at] = self.parent[self.parent[at]];
            at = self.parent[at];
        }
        at
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// Number of the set of each index, counted in the order in which sets first appear.
    pub fn numbers(mut self) -> Vec<usize> {
        let mut of_root = vec![usize::MAX; self.parent.len()];
        let mut count = 0;
        (0..self.parent.len())
            .map(|index| {
                let root = self.root(index);
                if of_root[root] == usize::MAX {
                    of_root[root] = count;
                    count += 1;
                }
                of_root[root]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_pairs_share_a_number() {
        let mut sheets = Sheets::new(7);
        for (a, b) in [(5, 1), (2, 6), (6, 5), (0, 4)] {
            sheets.join(a, b);
        }
        assert_eq!(sheets.numbers(), [0, 1, 1, 2, 0, 1, 1]);
    }
}
