//! Memory layouts of the wide tree.

use crate::Aabb;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;
/// Triangles of a block.
pub(crate) const BLOCK: usize = 8;

/// A wide tree. Indices in it are in range by construction.
#[derive(Default)]
pub(crate) struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
    /// None of an empty tree.
    pub(crate) root: Option<Child>,
    /// So small that it stays in the nearest caches, and asking for its parts ahead of time is in vain.
    pub(crate) is_near: bool,
}

/// Bytes of a tree that is near.
pub(crate) const NEAR: usize = 1 << 17;

/// Boxes of up to eight children: for each axis the least and the greatest. Unused ones are inside out.
#[repr(C, align(64))]
#[derive(Clone)]
pub(crate) struct Node {
    pub(crate) planes: [[[f32; WIDTH]; 2]; 3],
    pub(crate) children: [Child; WIDTH],
}

/// Triangles side by side: corner, axis, lane.
#[repr(C, align(64))]
#[derive(Clone)]
pub(crate) struct Block {
    pub(crate) corners: [[[f32; BLOCK]; 3]; 3],
    /// The largest extent of each along an axis.
    pub(crate) sizes: [f32; BLOCK],
    pub(crate) instances: [u32; BLOCK],
    pub(crate) primitives: [u32; BLOCK],
}

/// What a slot of a node leads to, in one word: two bits of kind, three of the number of triangles less one, an index.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Child(u32);

/// A [`Child`], unpacked.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    Node { index: usize },
    Block { index: usize, count: u32 },
    Instance { index: u32 },
}

/// Room for an index: at most so many nodes, blocks or instances less one.
pub(crate) const LIMIT: usize = 1 << 27;
const INDEX: u32 = LIMIT as u32 - 1;

impl Child {
    pub(crate) fn node(index: usize) -> Child {
        Child(index as u32)
    }

    /// `count` from 1 to [`BLOCK`].
    pub(crate) fn block(index: usize, count: usize) -> Child {
        Child(1 << 30 | (count as u32 - 1) << 27 | index as u32)
    }

    pub(crate) fn instance(index: usize) -> Child {
        Child(1 << 31 | index as u32)
    }

    #[inline(always)]
    pub(crate) fn is_node(self) -> bool {
        self.0 >> 30 == 0
    }

    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        (self.0 & INDEX) as usize
    }

    #[inline(always)]
    pub(crate) fn kind(self) -> Kind {
        let index = self.0 & INDEX;
        if self.is_node() {
            Kind::Node {
                index: index as usize,
            }
        } else if self.0 >> 31 == 0 {
            Kind::Block {
                index: index as usize,
                count: (self.0 >> 27 & 7) + 1,
            }
        } else {
            Kind::Instance { index }
        }
    }

    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub(crate) fn from_bits(bits: u32) -> Child {
        Child(bits)
    }
}

impl Node {
    pub(crate) const EMPTY: Node = Node {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Child(0); WIDTH],
    };

    pub(crate) fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][slot] = bounds.min[axis];
            self.planes[axis][1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }

    /// The boxes of the slots in use.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = Aabb> {
        (0..WIDTH)
            .map(|slot| Aabb {
                min: glam::Vec3::from_array(std::array::from_fn(|a| self.planes[a][0][slot])),
                max: glam::Vec3::from_array(std::array::from_fn(|a| self.planes[a][1][slot])),
            })
            .filter(|b| !b.is_empty())
    }
}

impl Block {
    pub(crate) const EMPTY: Block = Block {
        corners: [[[0.0; BLOCK]; 3]; 3],
        sizes: [0.0; BLOCK],
        instances: [0; BLOCK],
        primitives: [0; BLOCK],
    };

    /// The triangle in a lane.
    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [glam::Vec3; 3] {
        let [a, b, c] = &self.corners;
        [
            glam::Vec3::new(a[0][lane], a[1][lane], a[2][lane]),
            glam::Vec3::new(b[0][lane], b[1][lane], b[2][lane]),
            glam::Vec3::new(c[0][lane], c[1][lane], c[2][lane]),
        ]
    }

    pub(crate) fn set(
        &mut self,
        lane: usize,
        corners: [glam::Vec3; 3],
        instance: u32,
        primitive: u32,
    ) {
        for (rows, corner) in self.corners.iter_mut().zip(corners) {
            for axis in 0..3 {
                rows[axis][lane] = corner[axis];
            }
        }
        self.sizes[lane] = Aabb::from_points(corners).extent().max_element();
        self.instances[lane] = instance;
        self.primitives[lane] = primitive;
    }
}

impl Bvh {
    /// Bytes that it takes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}
