//! Collapses a binary tree into nodes of up to eight children and leaves of up to four triangles, with the least
//! expected cost, by the dynamic program of Ylitie, Karras and Laine 2017.

use obvhs::{aabb::Aabb, bvh2::Bvh2};

/// Cost of a visit to a leaf, as a multiple of that to a node: anything from 0.6 to 2.5 is as good.
const LEAF_COST: f32 = 1.0;

/// The largest number of triangles of a leaf.
const MAX_TRIANGLES: usize = 4;

/// The largest number of children of a node.
const WIDTH: usize = 8;

/// A binary tree with one triangle in each of its leaves.
pub(super) struct Wide {
    tree: Bvh2,
    /// For each node, the triangles below it, or one more than [`MAX_TRIANGLES`].
    counts: Vec<u8>,
    /// For each node, its least cost as up to 1, 2, ... children of a wide node.
    costs: Vec<[f32; WIDTH - 1]>,
}

impl Wide {
    pub fn new(tree: Bvh2) -> Wide {
        let mut downwards = vec![0];
        let mut next = 0;
        while let Some(node) = downwards.get(next).map(|k: &usize| &tree.nodes[*k]) {
            if !node.is_leaf() {
                downwards.extend(halves(node.first_index));
            }
            next += 1;
        }
        let size = tree.nodes.len();
        let mut wide = Wide { tree, counts: vec![1; size], costs: vec![[0.0; WIDTH - 1]; size] };
        downwards.into_iter().rev().for_each(|node| wide.find_costs(node));
        wide
    }

    /// Finds the costs of a node after those of the nodes below it.
    fn find_costs(&mut self, node: usize) {
        let as_leaf = self.cost_as_leaf(node);
        let Some([left, right]) = self.halves(node) else {
            self.costs[node] = [as_leaf; WIDTH - 1];
            return;
        };
        self.counts[node] = (self.counts[left] + self.counts[right]).min(MAX_TRIANGLES as u8 + 1);
        let divided = |slots: usize| {
            let cost = |n: usize| self.cost_divided([left, right], slots, n);
            (1..slots).map(cost).fold(f32::INFINITY, f32::min)
        };
        let as_node = divided(WIDTH) + self.bounds(node).half_area();
        let mut costs = [as_node; WIDTH - 1];
        if usize::from(self.counts[node]) <= MAX_TRIANGLES {
            costs[0] = as_leaf.min(as_node);
        }
        for slots in 2..WIDTH {
            costs[slots - 1] = costs[slots - 2].min(divided(slots));
        }
        self.costs[node] = costs;
    }

    /// Cost of the two halves as up to `slots` children of one node, of which the left half takes `n`.
    fn cost_divided(&self, [left, right]: [usize; 2], slots: usize, n: usize) -> f32 {
        self.costs[left][n - 1] + self.costs[right][slots - n - 1]
    }

    fn cost_as_leaf(&self, node: usize) -> f32 {
        self.bounds(node).half_area() * LEAF_COST
    }

    fn halves(&self, node: usize) -> Option<[usize; 2]> {
        let node = &self.tree.nodes[node];
        (!node.is_leaf()).then(|| halves(node.first_index))
    }

    pub fn bounds(&self, node: usize) -> &Aabb {
        self.tree.nodes[node].aabb()
    }

    /// The children of the wide root.
    pub fn root(&self) -> Vec<usize> {
        if self.is_leaf(0) { vec![0] } else { self.children(0) }
    }

    /// The children of the wide node that an inner node becomes.
    pub fn children(&self, node: usize) -> Vec<usize> {
        let mut children = Vec::with_capacity(WIDTH);
        self.divide(node, WIDTH, &mut children);
        children
    }

    fn divide(&self, node: usize, slots: usize, children: &mut Vec<usize>) {
        let halves = self.halves(node).expect("what is divided is no leaf");
        let cost = |n: usize| self.cost_divided(halves, slots, n);
        let left = (1..slots).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).expect("two slots or more");
        self.put(halves[0], left, children);
        self.put(halves[1], slots - left, children);
    }

    /// Makes a node up to `slots` children, fewer if that costs no more.
    fn put(&self, node: usize, slots: usize, children: &mut Vec<usize>) {
        let costs = &self.costs[node];
        let slots = (1..=slots).find(|n| costs[n - 1] <= costs[slots - 1]).expect("at the latest the last");
        if slots == 1 { children.push(node) } else { self.divide(node, slots, children) }
    }

    fn is_leaf(&self, node: usize) -> bool {
        usize::from(self.counts[node]) <= MAX_TRIANGLES && self.costs[node][0] == self.cost_as_leaf(node)
    }

    /// The triangles of a node, if it becomes a leaf.
    pub fn leaf(&self, node: usize) -> Option<Vec<u32>> {
        self.is_leaf(node).then(|| {
            let mut triangles = Vec::with_capacity(MAX_TRIANGLES);
            self.collect(node, &mut triangles);
            triangles
        })
    }

    fn collect(&self, node: usize, triangles: &mut Vec<u32>) {
        match self.halves(node) {
            Some(halves) => halves.iter().for_each(|half| self.collect(*half, triangles)),
            None => triangles.push(self.tree.primitive_indices[self.tree.nodes[node].first_index as usize]),
        }
    }
}

fn halves(first: u32) -> [usize; 2] {
    [first as usize, first as usize + 1]
}
