use crate::Mean;

/// The squared distances between successive states, seen through `N` numbers.
///
/// Push the numbers once a step, moved or not. The mean is the expected squared jump
/// distance of Pasarica and Gelman 2010.
#[doc(alias = "ESJD")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Jumps<const N: usize> {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::optional_array"))]
    last: Option<[f64; N]>,
    circular: bool,
    squares: Mean,
}

impl<const N: usize> Jumps<N> {
    /// On the line.
    pub fn new() -> Self {
        Self {
            last: None,
            circular: false,
            squares: Mean::new(),
        }
    }

    /// On the circle [0, 1), in each number: for coordinates.
    pub fn circular() -> Self {
        Self {
            circular: true,
            ..Self::new()
        }
    }

    /// Takes the numbers of the state after a step. Numbers that are not finite are no jump
    /// and break the series.
    pub fn push(&mut self, numbers: [f64; N]) {
        if !numbers.iter().all(|x| x.is_finite()) {
            self.last = None;
            return;
        }
        if let Some(last) = self.last {
            let pairs = numbers.iter().zip(last);
            let distances = pairs.map(|(x, y)| match (x - y).abs() {
                d if self.circular => d.min(1.0 - d),
                d => d,
            });
            self.squares.push(distances.map(|d| d * d).sum());
        }
        self.last = Some(numbers);
    }

    /// The mean of the squared jumps and how many there were.
    pub fn squares(&self) -> &Mean {
        &self.squares
    }

    /// Gives the jumps so far and begins a new round at the same place.
    pub fn end_round(&mut self) -> Mean {
        std::mem::take(&mut self.squares)
    }

    /// Adds another chain's jumps.
    pub fn merge(&mut self, other: &Self) {
        self.squares.merge(&other.squares);
    }
}

impl<const N: usize> Default for Jumps<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_squared_and_go_round() {
        let mut line = Jumps::new();
        let mut circle = Jumps::circular();
        for x in [0.1, 0.1, 0.9, 0.6] {
            line.push([x, 2.0]);
            circle.push([x, 0.5]);
        }
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(close(line.squares().mean(), (0.64 + 0.09) / 3.0));
        assert!(close(circle.squares().mean(), (0.04 + 0.09) / 3.0));
        // a round ends, the place stays; what is not finite is left out
        assert_eq!(line.end_round().count(), 3);
        line.push([0.6, 5.0]);
        line.push([f64::NAN, 0.0]);
        line.push([0.0, 0.0]);
        assert!(close(line.squares().mean(), 9.0) && line.squares().count() == 1);
        line.merge(&circle);
        assert_eq!(line.squares().count(), 4);
    }
}
