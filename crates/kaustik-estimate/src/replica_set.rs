//! Which replicas there are: rows of class weights.

use std::fmt;
use std::str::FromStr;

use kaustik_path::Class;

/// Weights of the six path classes in one replica's density: `d_{k,0}` to `d_{k,5}` (RELT eq. 19).
pub type ClassWeights = [f64; Class::COUNT];

/// The replicas of a run (RELT 4.2.3; spec relt.md 3): the uniform one, then a row of class
/// weights each.
///
/// Supports are nested: a class that one row weighs is weighed by every row before it. The
/// normalisers and the weights of the heuristic need that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplicaSet {
    rows: [ClassWeights; ReplicaSet::MOST],
    count: usize,
}

impl ReplicaSet {
    /// The fewest replicas.
    pub const FEWEST: usize = 2;
    /// The most replicas.
    pub const MOST: usize = 8;
    /// `delta` of the specific replica (spec relt.md 3: the paper gives none).
    pub const DELTA: f64 = 0.05;

    /// The paper's four: uniform, full, indirect, specific. `delta` > 0 is the share of joined paths
    /// in the last, which lets it exchange with the one before.
    pub fn standard(delta: f64) -> Self {
        let mut rows = [[0.0; Class::COUNT]; Self::MOST];
        rows[1] = [1.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        rows[2] = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        rows[3] = [1.0, 0.0, 0.0, 0.0, 0.0, delta];
        Self { rows, count: 4 }
    }

    /// How many replicas there are, the uniform one included.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The class weights by replica; those of the uniform one, which has none, are zero.
    pub fn rows(&self) -> &[ClassWeights] {
        &self.rows[..self.count]
    }

    /// Is the last replica there for implicit specular paths: does it weigh them more than any
    /// other class? Then these go to its film alone (RELT 5.1.4; spec relt.md 6.5).
    pub fn is_specific(&self) -> bool {
        let [specular, rest @ ..] = self.rows[self.count - 1];
        self.count > Self::FEWEST && rest.iter().all(|&weight| weight < specular)
    }
}

impl fmt::Display for ReplicaSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("uniform")?;
        for row in &self.rows()[1..] {
            let words = row.map(|weight| weight.to_string());
            write!(f, ";{}", words.join(","))?;
        }
        Ok(())
    }
}

/// Why a text names no replicas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReplicaSetError {
    /// The first is not `uniform`.
    NotUniform,
    /// Too few or too many.
    Count,
    /// A row that is not six finite numbers >= 0, one of them positive.
    Row,
    /// A row weighs a class that the row before does not.
    Nesting,
}

impl fmt::Display for ReplicaSetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotUniform => "the first replica is to be 'uniform'",
            Self::Count => "there are to be 2 to 8 replicas",
            Self::Row => "a replica is six numbers >= 0, one of them positive",
            Self::Nesting => "a replica weighs a class that the one before does not",
        })
    }
}

impl std::error::Error for ReplicaSetError {}

impl FromStr for ReplicaSet {
    type Err = ReplicaSetError;

    /// `uniform;1,0,1,1,1,1;...`
    fn from_str(text: &str) -> Result<Self, ReplicaSetError> {
        let mut words = text.split(';').map(str::trim);
        if words.next() != Some("uniform") {
            return Err(ReplicaSetError::NotUniform);
        }
        let mut set = Self {
            rows: [[0.0; Class::COUNT]; Self::MOST],
            count: 1,
        };
        for word in words {
            if set.count == Self::MOST {
                return Err(ReplicaSetError::Count);
            }
            let row = row(word).ok_or(ReplicaSetError::Row)?;
            let before = set.rows[set.count - 1];
            let nested = |(&weight, &before): (&f64, &f64)| weight <= 0.0 || before > 0.0;
            if set.count > 1 && !row.iter().zip(&before).all(nested) {
                return Err(ReplicaSetError::Nesting);
            }
            set.rows[set.count] = row;
            set.count += 1;
        }
        if set.count < Self::FEWEST {
            return Err(ReplicaSetError::Count);
        }
        Ok(set)
    }
}

fn row(text: &str) -> Option<ClassWeights> {
    let numbers: Option<Vec<f64>> = (text.split(','))
        .map(|word| word.trim().parse().ok())
        .collect();
    let row: ClassWeights = numbers?.try_into().ok()?;
    let sound = row
        .iter()
        .all(|weight| weight.is_finite() && *weight >= 0.0);
    (sound && row.iter().any(|&weight| weight > 0.0)).then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_set_is_what_it_writes() {
        let set = ReplicaSet::standard(0.05);
        assert_eq!(
            set.to_string(),
            "uniform;1,0,1,1,1,1;1,0,0,1,1,1;1,0,0,0,0,0.05"
        );
        assert_eq!(set.to_string().parse(), Ok(set));
        assert!(set.is_specific() && set.count() == 4);
    }

    #[test]
    fn what_is_no_set_is_refused() {
        use ReplicaSetError as E;
        let refused = |text: &str| text.parse::<ReplicaSet>().unwrap_err();
        assert_eq!(refused("1,0,1,1,1,1"), E::NotUniform);
        assert_eq!(refused("uniform"), E::Count);
        assert_eq!(
            refused(&format!("uniform{}", ";1,1,1,1,1,1".repeat(8))),
            E::Count
        );
        for row in [
            "",
            "1,2,3",
            "0,0,0,0,0,0",
            "1,0,-1,0,0,0",
            "1,0,nan,0,0,0",
            "a,0,0,0,0,1",
        ] {
            assert_eq!(refused(&format!("uniform;{row}")), E::Row, "{row}");
        }
        assert_eq!(refused("uniform;1,0,0,0,0,0;1,1,0,0,0,0"), E::Nesting);
        let plain: ReplicaSet = "uniform; 1,0,1,1,1,1".parse().unwrap();
        assert!(!plain.is_specific() && plain.count() == 2);
    }
}
