use super::json::Cursor;
use super::{ErrorKind, LoadError};

/// How a primitive's vertices make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// The `mode` of a primitive; `None` for points and lines.
    pub(super) fn read(primitive: &Cursor<'_>) -> Result<Option<Self>, LoadError> {
        match primitive.usize_or("mode", 4)? {
            0..=3 => Ok(None),
            4 => Ok(Some(Self::List)),
            5 => Ok(Some(Self::Strip)),
            6 => Ok(Some(Self::Fan)),
            mode => {
                let expected = "0 to 6 (points, lines, triangles)";
                Err(primitive.error(ErrorKind::Value, format!("mode {mode}"), expected))
            }
        }
    }

    /// How many triangles `corners` vertices make.
    pub(super) fn count(self, corners: usize) -> usize {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// The triangles over a sequence of vertices (glTF 2.0, 3.7.2.1), all wound alike. Strips
    /// and fans repeat vertices to jump; what has no area because of it is left out.
    pub(super) fn triangles(self, corners: usize, vertex: impl Fn(usize) -> u32) -> Vec<[u32; 3]> {
        let triangle = |i: usize| {
            match self {
                Self::List => [3 * i, 3 * i + 1, 3 * i + 2],
                Self::Strip => [i, i + 1 + i % 2, i + 2 - i % 2],
                Self::Fan => [i + 1, i + 2, 0],
            }
            .map(&vertex)
        };
        let all = (0..self.count(corners)).map(triangle);
        // what the caller has counted, and no doubling
        let mut triangles = Vec::with_capacity(self.count(corners));
        match self {
            Self::List => triangles.extend(all),
            _ => triangles.extend(all.filter(|[a, b, c]| a != b && b != c && c != a)),
        }
        triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_topologies_wind_alike() {
        let vertex = |i: usize| i as u32;
        let of = |topology: Topology, corners| topology.triangles(corners, vertex);
        assert_eq!(of(Topology::List, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(of(Topology::Strip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(of(Topology::Fan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            assert_eq!(of(topology, 0), [[0; 3]; 0]);
            assert_eq!(of(topology, 2), [[0; 3]; 0]);
        }
    }

    #[test]
    fn joints_of_strips_vanish() {
        let sequence = [0, 1, 2, 2, 3, 3, 4, 5];
        let triangles = Topology::Strip.triangles(8, |i| sequence[i]);
        assert_eq!(triangles, [[0, 1, 2], [3, 5, 4]]);
    }
}
