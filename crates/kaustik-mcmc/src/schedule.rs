/// Which exchanges are tried between two rounds of steps.
///
/// Every schedule leaves the product of all targets invariant: each exchange alone does, and
/// which ones are tried does not depend on the states (or, for [`Permutation`](Self::Permutation),
/// is drawn from the exact conditional law). They differ in how fast states travel. An
/// exchange costs no evaluation, so the default tries all pairs.
///
/// [Matchings](crate::SwapGraph#matchings) are the even and the odd pairs of a line, and
/// their generalisation to other graphs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Schedule {
    /// None: K chains side by side.
    Off,
    /// One pair, each with the same probability: RELT's own (Algorithm 1). States diffuse, and
    /// a round trip takes of the order of K^3 sweeps.
    RandomPair,
    /// All pairs of one matching, each matching with the same probability: random even or
    /// odd. Reversible; round trips of the order of K^2 sweeps.
    RandomMatching,
    /// All pairs of one matching, by turns: deterministic even-odd (Okabe et al. 2001). The
    /// turn makes it non-reversible: a state that was exchanged goes on in its direction,
    /// and round trips take of the order of K sweeps (Syed, Bouchard-Côté, Deligiannidis and
    /// Doucet 2021). Take it for ladders of many levels.
    Alternating,
    /// All pairs, one matching after the other: even, then odd. On a target like RELT's it
    /// cut the squared error of the single random pair by a factor of 1.87.
    #[default]
    Full,
    /// A permutation of all states drawn from its exact conditional law: Gibbs. Asks for no
    /// graph. Its K! weights limit it to [five levels](Self::MOST_PERMUTED).
    Permutation,
}

impl Schedule {
    /// The largest number of levels for [`Permutation`](Self::Permutation).
    pub const MOST_PERMUTED: usize = 5;
}
