/// What a chain tells about a value it has been at.
///
/// Let u be the current state, v the proposal of a step, a the acceptance probability.
/// Expected-value weighting (Kelemen section 1.2) counts v with a and u with
/// 1 - a, whatever is decided. A chain reports every value *once*, with the sum:
///
/// * a proposal that is rejected, at once, with weight a;
/// * a state when it dies (replaced, or [flushed](crate::Metropolis::flush)), with the a
///   of its own proposal plus 1 - a for each step that began in it.
///
/// The first state of a chain has no proposal of its own. So the weights of all visits sum
/// to the number of steps, up to steps spent at density zero; and sum of weight * h(value)
/// over steps estimates the mean of h under the level's normalised density.
///
/// Only a flush splits a state's report: the weight so far, then the rest later.
#[derive(Debug)]
pub struct Visit<'a, V, const K: usize> {
    /// The level of the chain: its target is `densities[level]`.
    pub level: usize,
    /// The value that was evaluated.
    pub value: &'a V,
    /// All K densities of the value: finite, at least 0. That of the level is positive
    /// whenever `weight` is.
    pub densities: &'a [f64; K],
    /// Expected number of steps that the chain spends here, at least 0.
    pub weight: f64,
    /// How many independent (large-step) proposals had this value: 1 if it was proposed
    /// by one, otherwise 0. Every valid independent proposal is reported exactly once,
    /// accepted or not, unless all its K densities are zero; so sum of
    /// independent * h(value) over the number of independent proposals is a plain Monte
    /// Carlo estimate of the integral of h, for every h that is zero where they are. (With
    /// more than one level the density at the chain's own may be zero here.)
    pub independent: f64,
}

impl<V, const K: usize> Visit<'_, V, K> {
    /// The density of the value at the chain's level.
    pub fn density(&self) -> f64 {
        self.densities[self.level]
    }
}

impl<V, const K: usize> Clone for Visit<'_, V, K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V, const K: usize> Copy for Visit<'_, V, K> {}

/// Takes visits: an estimator, a histogram, a test. Closures `FnMut(Visit<V, K>)` are
/// recorders.
pub trait Recorder<V, const K: usize> {
    /// Takes one visit.
    fn record(&mut self, visit: Visit<'_, V, K>);
}

impl<V, F, const K: usize> Recorder<V, K> for F
where
    F: FnMut(Visit<'_, V, K>),
{
    fn record(&mut self, visit: Visit<'_, V, K>) {
        self(visit);
    }
}

/// Records nothing: for burn-in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ignore;

impl<V, const K: usize> Recorder<V, K> for Ignore {
    fn record(&mut self, _: Visit<'_, V, K>) {}
}

/// Two recorders, told the same, the first one first. More than two: `Both(&mut a, &mut Both(&mut b, &mut c))`.
///
/// ```
/// use kaustik_mcmc::{Both, Recorder, Visit};
///
/// let (mut steps, mut sum) = (0.0, 0.0);
/// let mut count = |visit: Visit<'_, f64, 1>| steps += visit.weight;
/// let mut add = |visit: Visit<'_, f64, 1>| sum += visit.weight * *visit.value;
/// Both(&mut count, &mut add).record(Visit {
///     level: 0,
///     value: &3.0,
///     densities: &[1.0],
///     weight: 2.0,
///     independent: 0.0,
/// });
/// assert_eq!((steps, sum), (2.0, 6.0));
/// ```
#[derive(Debug)]
pub struct Both<'a, A: ?Sized, B: ?Sized>(pub &'a mut A, pub &'a mut B);

impl<V, A, B, const K: usize> Recorder<V, K> for Both<'_, A, B>
where
    A: Recorder<V, K> + ?Sized,
    B: Recorder<V, K> + ?Sized,
{
    #[inline]
    fn record(&mut self, visit: Visit<'_, V, K>) {
        self.0.record(visit);
        self.1.record(visit);
    }
}
