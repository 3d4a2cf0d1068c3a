use std::fmt;
use std::marker::PhantomData;

use kaustik_pss::Coordinates;

/// What is dear: from a point of the unit cube to everything there is to know about it.
///
/// An evaluation reads as many coordinates as it needs (the dimension may differ from
/// point to point) and writes a *value*: for light, the path's contributions to the
/// picture. All densities, of all replicas, are then read off this one value by a cheap
/// [`Family`](crate::Family), so that nothing is evaluated twice.
///
/// The value must be a function of the coordinates alone.
///
/// ```
/// use kaustik_mcmc::{Exponential, Metropolis, Target, generator};
/// use kaustik_pss::{Coordinates, Stream};
///
/// /// What one path brings to which pixels; the buffer is reused.
/// #[derive(Default)]
/// struct Splats(Vec<(usize, [f64; 3])>);
///
/// struct Renderer {
///     width: usize,
/// }
///
/// impl Target for Renderer {
///     type Value = Splats;
///
///     fn evaluate(&self, u: &mut dyn Coordinates, splats: &mut Splats) {
///         splats.0.clear(); // an older path is still in it
///         let x = u.get(Stream::Camera, 0); // your renderer traces a path here
///         let y = u.get(Stream::Camera, 1);
///         splats.0.push(((x * self.width as f64) as usize, [1.0, 0.5, y]));
///     }
/// }
///
/// // the density that the chain follows: all that a path brings
/// let brought = |splats: &Splats| [splats.0.iter().flat_map(|(_, rgb)| rgb).sum::<f64>()];
/// let renderer = Renderer { width: 8 };
/// let mut rng = generator(1, 0);
/// let chain = Metropolis::start(&renderer, &brought, 0, Exponential::default(), &mut rng);
/// assert_eq!(chain.value().0.len(), 1);
/// assert!(chain.density() >= 1.5);
/// ```
pub trait Target {
    /// What an evaluation yields. `Default` makes the empty buffers; they are reused.
    type Value: Default;

    /// Evaluates the point `u` into `value`, which holds an older evaluation and is
    /// overwritten completely.
    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Self::Value);
}

impl<T: Target + ?Sized> Target for &T {
    type Value = T::Value;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Self::Value) {
        (**self).evaluate(u, value);
    }
}

impl<T: Target + ?Sized> Target for Box<T> {
    type Value = T::Value;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Self::Value) {
        (**self).evaluate(u, value);
    }
}

/// A target from a closure that returns its value.
///
/// For values that are cheap to make; a target with buffers to reuse implements
/// [`Target`] itself.
pub fn target<V, F>(function: F) -> FnTarget<V, F>
where
    V: Default,
    F: Fn(&mut dyn Coordinates) -> V,
{
    FnTarget {
        function,
        value: PhantomData,
    }
}

/// The target that [`target`] makes.
pub struct FnTarget<V, F> {
    function: F,
    value: PhantomData<fn() -> V>,
}

// By hand: what a target returns need not be `Clone`.
impl<V, F: Clone> Clone for FnTarget<V, F> {
    fn clone(&self) -> Self {
        Self {
            function: self.function.clone(),
            value: PhantomData,
        }
    }
}

impl<V, F: Copy> Copy for FnTarget<V, F> {}

impl<V, F> fmt::Debug for FnTarget<V, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FnTarget").finish_non_exhaustive()
    }
}

impl<V, F> Target for FnTarget<V, F>
where
    V: Default,
    F: Fn(&mut dyn Coordinates) -> V,
{
    type Value = V;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut V) {
        *value = (self.function)(u);
    }
}
