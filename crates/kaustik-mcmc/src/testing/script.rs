use crate::Draws;

/// Answers uniform draws with given numbers, in their order: puts a point where a test
/// wants it, or makes a sample again whose numbers were written down.
///
/// # Panics
///
/// A draw panics when no number is left, and when it is a decision that is not certain.
#[derive(Clone, Debug)]
pub struct Script {
    numbers: std::vec::IntoIter<f64>,
}

impl Script {
    /// These numbers, each in [0, 1).
    pub fn new(numbers: impl IntoIterator<Item = f64>) -> Self {
        let numbers: Vec<f64> = numbers.into_iter().collect();
        Self {
            numbers: numbers.into_iter(),
        }
    }
}

impl Draws for Script {
    fn uniform(&mut self) -> f64 {
        self.numbers.next().expect("more draws than the script has")
    }

    fn bernoulli(&mut self, p: f64) -> bool {
        assert!(p <= 0.0 || p >= 1.0, "a script has no decisions");
        p >= 1.0
    }

    fn index(&mut self, _: &[f64]) -> usize {
        panic!("a script has no decisions")
    }
}
