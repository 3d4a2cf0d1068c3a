//! What holds to rounding error, or else.

use super::TransitionMatrix;
use super::enumerator::Enumerator;

/// How far detailed balance may be off by rounding: flows are products of a few numbers.
const BALANCE: f64 = 1e-14;

/// How far a sum over all states may be off by rounding.
const SUM: f64 = 1e-12;

/// Asserts that a kernel is reversible with respect to the unnormalised law `pi`: the flow
/// from x to y is that from y to x, for all pairs, to 1e-14 of the whole mass.
///
/// For *elementary* kernels: a proposal with its acceptance, or a choice between such that
/// does not depend on the state. It implies stationarity and finds more: a wrong ratio
/// that another fault makes good on the average. A sequence of kernels keeps the law but
/// not the balance: see [`assert_stationary`].
///
/// # Panics
///
/// If it does not hold, with the worst pair and both flows. If `pi` has not as many
/// entries as there are states, or one that is negative or not finite, or no positive one.
#[track_caller]
pub fn assert_detailed_balance(kernel: &TransitionMatrix, pi: &[f64]) {
    assert_detailed_balance_within(kernel, pi, BALANCE);
}

/// As [`assert_detailed_balance`], to a given part of the whole mass.
///
/// # Panics
///
/// As there.
#[track_caller]
pub fn assert_detailed_balance_within(kernel: &TransitionMatrix, pi: &[f64], tolerance: f64) {
    assert_law(kernel, pi);
    let worst = kernel.worst_pair(pi);
    assert!(
        worst.defect() <= tolerance,
        "no detailed balance within {tolerance:e}: {worst}"
    );
}

/// Asserts that a kernel keeps the unnormalised law `pi`: |pi P - pi|_1 <= 1e-12 of the
/// whole mass.
///
/// This is what every kernel owes, *composites* too. A scan that does one thing and then
/// another keeps the law if each part does, but runs backwards differently: it is correct
/// and not reversible. Measured on two single-site updates, one after the other:
///
/// ```
/// use kaustik_mcmc::testing::{Grid, GridStep, TransitionMatrix, assert_stationary};
/// use kaustik_mcmc::testing::assert_detailed_balance;
/// use kaustik_mcmc::{Draws, acceptance, decide};
///
/// // a law on a 3 x 3 grid; one step moves the row or the column of a state
/// let pi = [0.3, 0.1, 0.0, 0.05, 0.2, 0.1, 0.05, 0.15, 0.05];
/// let update = |row: bool| {
///     TransitionMatrix::of(9, 1, |from, draws| {
///         let by = 1 + draws.index(&[1.0, 1.0]);
///         let (x, y) = (from % 3, from / 3);
///         let to = if row { (x + by) % 3 + 3 * y } else { x + 3 * ((y + by) % 3) };
///         if decide(acceptance(pi[from], pi[to], 1.0), draws) { to } else { from }
///     })
/// };
/// let (rows, columns) = (update(true), update(false));
/// for elementary in [&rows, &columns] {
///     assert_detailed_balance(elementary, &pi);
/// }
/// let scan = rows.then(&columns);
/// assert_stationary(&scan, &pi);
/// assert!(scan.stationarity_defect(&pi) < 1e-15);
/// assert!(scan.balance_defect(&pi) > 1e-2); // though both parts are reversible
/// // chosen at random, they are reversible again
/// assert_detailed_balance(&TransitionMatrix::mixture(&[(0.5, &rows), (0.5, &columns)]), &pi);
/// ```
///
/// # Panics
///
/// If it does not hold, with the state whose mass changes most; if `pi` is no law on the
/// states.
#[track_caller]
pub fn assert_stationary(kernel: &TransitionMatrix, pi: &[f64]) {
    assert_stationary_within(kernel, pi, SUM);
}

/// As [`assert_stationary`], to a given part of the whole mass.
///
/// # Panics
///
/// As there.
#[track_caller]
pub fn assert_stationary_within(kernel: &TransitionMatrix, pi: &[f64], tolerance: f64) {
    assert_law(kernel, pi);
    let defect = kernel.stationarity_defect(pi);
    assert!(
        defect <= tolerance,
        "not stationary within {tolerance:e}: |pi P - pi|_1 = {defect:.3e}; {}",
        kernel.worst_state(pi)
    );
}

#[track_caller]
fn assert_law(kernel: &TransitionMatrix, pi: &[f64]) {
    assert_eq!(pi.len(), kernel.states(), "masses for as many states");
    let sound = pi.iter().all(|mass| mass.is_finite() && *mass >= 0.0);
    assert!(sound && pi.iter().any(|mass| *mass > 0.0), "no law: {pi:?}");
}

/// The exact expectation of what a program deposits in each of `places` places, in each of
/// `C` channels. The program finds zeros and adds to them; `cells` is the grid of
/// [`Enumerator`].
pub fn expected_deposits<const C: usize>(
    cells: usize,
    places: usize,
    mut program: impl FnMut(&mut Enumerator, &mut [[f64; C]]),
) -> Vec<[f64; C]> {
    let mut expected = vec![[0.0; C]; places];
    let mut deposits = expected.clone();
    let mut draws = Enumerator::new(cells);
    loop {
        deposits.fill([0.0; C]);
        program(&mut draws, &mut deposits);
        let found = deposits.iter().flatten();
        for (sum, found) in expected.iter_mut().flatten().zip(found) {
            *sum += draws.probability() * found;
        }
        if !draws.advance() {
            return expected;
        }
    }
}

/// Asserts that a program deposits, in expectation, exactly `wanted[y]` at each place y, in
/// every channel, to 1e-12 of the channel's sum.
///
/// For estimators rather than kernels: weighted visits of a chain, equal-deposition chains
/// (Cline et al. 2005), anything that adds contributions up. Unbiasedness is a statement
/// on the mean of *one* run of the whole program, its random start included; so the
/// program draws its start too.
///
/// ```
/// use kaustik_mcmc::{Draws, acceptance, testing::assert_deposits};
///
/// // f in two channels at three places; the chain sees their sum, and deposits what is
/// // wanted of where it is, over its density
/// let f = [[1.0, 2.0], [0.0, 0.0], [4.0, 1.0]];
/// let sum = |place: usize| f[place][0] + f[place][1];
/// assert_deposits(1, &f, |draws, deposits| {
///     let start = draws.index(&[1.0; 3]);
///     let energy = 3.0 * sum(start); // f over the density 1/3
///     if energy <= 0.0 { return; }
///     let proposal = draws.index(&[1.0; 3]);
///     let a = acceptance(sum(start), sum(proposal), 1.0);
///     for (place, weight) in [(start, 1.0 - a), (proposal, a)] {
///         if weight > 0.0 {
///             for c in 0..2 { deposits[place][c] += weight * energy * f[place][c] / sum(place); }
///         }
///     }
/// });
/// ```
///
/// # Panics
///
/// If it does not hold, with the place and the channel that are worst.
#[track_caller]
pub fn assert_deposits<const C: usize>(
    cells: usize,
    wanted: &[[f64; C]],
    program: impl FnMut(&mut Enumerator, &mut [[f64; C]]),
) {
    let found = expected_deposits(cells, wanted.len(), program);
    let (mut worst, mut at) = (0.0, (0, 0));
    for channel in 0..C {
        let sum = |rows: &[[f64; C]]| rows.iter().map(|r| r[channel].abs()).sum::<f64>();
        let scale = sum(wanted).max(sum(&found)).max(f64::MIN_POSITIVE);
        for (place, (found, wanted)) in found.iter().zip(wanted).enumerate() {
            let defect = (found[channel] - wanted[channel]).abs() / scale;
            if defect > worst || defect.is_nan() {
                (worst, at) = (defect, (place, channel));
            }
        }
    }
    let (place, channel) = at;
    assert!(
        worst <= SUM,
        "place {place}, channel {channel}: expected {:.9e}, deposited in the mean {:.9e}, off \
         by {worst:.3e} of the channel's sum",
        wanted[place][channel],
        found[place][channel]
    );
}
