//! A node of the tree: the boxes of its children.

use super::ray::BoxRay;
use glam::Vec3;

/// The boxes of up to eight children, in full float32: smaller codes cost more to unpack than they save.
#[repr(align(64))]
pub(super) struct Node {
    /// The planes of the boxes, by axis, then low and high, then child.
    planes: [[[f32; 8]; 2]; 3],
    /// A code for each child, see [`Node::leaf`] and [`Node::leaf_of`].
    pub children: [u32; 8],
}

/// Set in the code of a child that is a leaf; the other bits are its index, or that of a node.
const LEAF: u32 = 1 << 31;

impl Node {
    /// Boxes that contain nothing.
    pub const EMPTY: Node = Node { planes: [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3], children: [0; 8] };

    pub fn set(&mut self, slot: usize, low: Vec3, high: Vec3, child: u32) {
        for axis in 0..3 {
            self.planes[axis][0][slot] = low[axis];
            self.planes[axis][1][slot] = high[axis];
        }
        self.children[slot] = child;
    }

    /// The code of a leaf among the children; that of a node is its index.
    pub fn leaf(index: usize) -> u32 {
        LEAF | index as u32
    }

    /// The index of the leaf that a code means; none if it means a node.
    #[inline(always)]
    pub fn leaf_of(code: u32) -> Option<u32> {
        (code & LEAF != 0).then_some(code & !LEAF)
    }

    /// The planes across an axis: first those that the ray meets first, then the others.
    #[inline(always)]
    pub fn planes(&self, axis: usize, ray: &BoxRay) -> [&[f32; 8]; 2] {
        let first = ray.first[axis] & 1;
        [&self.planes[axis][first], &self.planes[axis][1 - first]]
    }
}
