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
#[derive(Clone, Copy)]
pub struct FnTarget<V, F> {
    function: F,
    value: PhantomData<fn() -> V>,
}

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
