//! Choice among many by one number, in constant time.

/// An alias table (Walker 1974, built by Vose's method): index `i` is chosen with
/// probability `weight[i] / sum`.
#[derive(Clone, Debug, Default)]
pub(crate) struct AliasTable {
    cells: Vec<Cell>,
    probability: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Keep the cell's own index below this share of it.
    threshold: f64,
    alias: u32,
}

impl AliasTable {
    /// From finite weights >= 0. A table whose weights sum to zero is empty.
    pub(crate) fn new(weights: &[f64]) -> Self {
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 || !sum.is_finite() {
            return Self::default();
        }
        let probability: Vec<f64> = weights.iter().map(|w| w / sum).collect();
        let mut scaled: Vec<f64> = probability
            .iter()
            .map(|p| p * weights.len() as f64)
            .collect();
        let mut cells: Vec<Cell> = (0..weights.len())
            .map(|i| Cell {
                threshold: 1.0,
                alias: i as u32,
            })
            .collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) =
            (0..weights.len()).partition(|&i| scaled[i] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            cells[s] = Cell {
                threshold: scaled[s],
                alias: l as u32,
            };
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // What is left over is 1 up to rounding, except entries of weight zero, which must
        // never be chosen: rounding may leave one in `small` without a partner.
        let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
        for s in small {
            if weights[s] == 0.0 {
                cells[s] = Cell {
                    threshold: 0.0,
                    alias: heaviest.unwrap_or(s) as u32,
                };
            }
        }
        Self { cells, probability }
    }

    /// No index to choose?
    pub(crate) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// How many indices there are.
    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    /// The index for `u` in [0, 1), which must not be asked of an empty table.
    pub(crate) fn choose(&self, u: f64) -> usize {
        let scaled = u * self.cells.len() as f64;
        let index = (scaled as usize).min(self.cells.len() - 1);
        let cell = self.cells[index];
        if scaled - (index as f64) < cell.threshold {
            index
        } else {
            cell.alias as usize
        }
    }

    /// Probability of `index`; 0 for an empty table.
    pub(crate) fn probability(&self, index: usize) -> f64 {
        self.probability.get(index).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The measure of u that leads to each index is its probability, exactly up to rounding.
        #[test]
        fn measure_is_probability(weights in prop::collection::vec(0.0..10.0f64, 1..40)) {
            let table = AliasTable::new(&weights);
            prop_assume!(!table.is_empty());
            let n = table.len() as f64;
            let mut measure = vec![0.0; weights.len()];
            for (i, cell) in table.cells.iter().enumerate() {
                measure[i] += cell.threshold.min(1.0) / n;
                measure[cell.alias as usize] += (1.0 - cell.threshold.min(1.0)) / n;
            }
            for (i, m) in measure.iter().enumerate() {
                prop_assert!((m - table.probability(i)).abs() < 1e-12);
            }
        }

        #[test]
        fn zero_weight_is_never_chosen(weights in prop::collection::vec(
            prop_oneof![Just(0.0), 0.0..1.0f64], 1..30), u in 0.0..1.0f64) {
            let table = AliasTable::new(&weights);
            prop_assume!(!table.is_empty());
            prop_assert!(weights[table.choose(u)] > 0.0);
        }
    }
}
