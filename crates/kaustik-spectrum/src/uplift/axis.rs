//! The uneven nodes of one side of the table.

/// N nodes from 0 to 1, dense at both ends, where reflectances bend most.
#[derive(Debug)]
pub(super) struct Axis<const N: usize> {
    nodes: [f32; N],
    inverse_widths: [f32; N],
    guide: [u8; GUIDES],
}

const GUIDES: usize = 256;

impl<const N: usize> Axis<N> {
    pub(super) const fn new() -> Self {
        let mut nodes = [0.0; N];
        let mut inverse_widths = [0.0; N];
        let mut i = 0;
        while i < N {
            nodes[i] = Self::node(i) as f32;
            if i > 0 {
                inverse_widths[i - 1] = 1.0 / (nodes[i] - nodes[i - 1]);
            }
            i += 1;
        }
        let mut guide = [0; GUIDES];
        let (mut g, mut i) = (0, 0);
        while g < GUIDES {
            while i + 2 < N && nodes[i + 1] <= g as f32 / GUIDES as f32 {
                i += 1;
            }
            guide[g] = i as u8;
            g += 1;
        }
        Self {
            nodes,
            inverse_widths,
            guide,
        }
    }

    /// Node i: half-way between smoothstep and smoothstep of smoothstep. The first, used twice, is
    /// the paper's choice; it leaves the middle too thin.
    pub(super) const fn node(i: usize) -> f64 {
        let once = smoothstep(i as f64 / (N - 1) as f64);
        0.5 * (once + smoothstep(once))
    }

    /// The cell of a value in [0, 1], and where in it, 0 to 1.
    #[inline]
    pub(super) fn find(&self, value: f32) -> (usize, f32) {
        let mut i = usize::from(self.guide[((value * GUIDES as f32) as usize).min(GUIDES - 1)]);
        while i + 2 < N && self.nodes[i + 1] <= value {
            i += 1;
        }
        (i, (value - self.nodes[i]) * self.inverse_widths[i])
    }
}

const fn smoothstep(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}
