//! A union of nodes that keeps how many turns lie between them: components of a surface, and what a cycle on it adds up to.

/// Sets of nodes, each node with a whole number of turns from its root.
#[derive(Clone, Debug)]
pub(super) struct TurnSets {
    parent: Vec<u32>,
    /// From the parent to the node.
    turns: Vec<i32>,
    /// Of a root: the greatest common divisor of what its cycles add up to, zero where each comes back to where it began.
    holonomy: Vec<u32>,
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

impl TurnSets {
    pub fn new(count: usize) -> TurnSets {
        TurnSets { parent: (0..count as u32).collect(), turns: vec![0; count], holonomy: vec![0; count] }
    }

    pub fn add(&mut self) -> usize {
        self.parent.push(self.parent.len() as u32);
        self.turns.push(0);
        self.holonomy.push(0);
        self.parent.len() - 1
    }

    /// The root of a node, and the turns from it to the node.
    pub fn root(&mut self, node: usize) -> (usize, i32) {
        let (mut root, mut total) = (node, 0);
        while self.parent[root] as usize != root {
            total += self.turns[root];
            root = self.parent[root] as usize;
        }
        // each node on the way is hung below the root
        let (mut at, mut rest) = (node, total);
        while at != root {
            let (next, own) = (self.parent[at] as usize, self.turns[at]);
            self.parent[at] = root as u32;
            self.turns[at] = rest;
            rest -= own;
            at = next;
        }
        (root, total)
    }

    /// Joins two nodes: from the first to the second one turns by so much.
    pub fn join(&mut self, first: usize, second: usize, turns: i32) {
        let ((a, to_first), (b, to_second)) = (self.root(first), self.root(second));
        // from root a to root b
        let between = to_first + turns - to_second;
        if a == b {
            self.holonomy[a] = common_divisor(self.holonomy[a], between.unsigned_abs());
            return;
        }
        self.parent[b] = a as u32;
        self.turns[b] = between;
        self.holonomy[a] = common_divisor(self.holonomy[a], self.holonomy[b]);
    }

    /// What the cycles of a node's set add up to, in turns: the least positive number, or zero.
    pub fn holonomy(&mut self, node: usize) -> u32 {
        let root = self.root(node).0;
        self.holonomy[root]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a triangle that closes, a square that turns by two, and both joined by an edge to one that turns by three.
    #[test]
    fn cycles_add_up() {
        let mut sets = TurnSets::new(9);
        for (a, b, turns) in [(0, 1, 1), (1, 2, -2), (2, 0, 1)] {
            sets.join(a, b, turns);
        }
        assert_eq!(sets.holonomy(1), 0);
        assert_eq!(sets.root(2).1 - sets.root(0).1, -1);
        for (a, b, turns) in [(3, 4, 0), (4, 5, 1), (5, 6, 0), (6, 3, 1)] {
            sets.join(a, b, turns);
        }
        assert_eq!((sets.holonomy(6), sets.holonomy(2)), (2, 0));
        sets.join(2, 5, 7);
        assert_eq!((sets.holonomy(0), sets.holonomy(7)), (2, 0));
        sets.join(7, 8, 1);
        sets.join(7, 8, -2);
        sets.join(8, 3, 0);
        assert_eq!(sets.holonomy(0), 1);
        let eight = sets.root(8);
        assert_eq!(eight.0, sets.root(0).0);
    }
}
