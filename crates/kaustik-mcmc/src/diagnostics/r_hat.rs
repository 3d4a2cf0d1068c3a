use std::cmp::Ordering;

use super::Halves;
use crate::Mean;
use crate::normal::quantile;

/// The potential scale reduction of sequences that should have the same law (Gelman and
/// Rubin 1992; Gelman et al. 2013, section 11.4).
///
/// With W the mean variance within the sequences, B/n the variance of their means:
/// sqrt(((n - 1) / n W + B/n) / W). Near 1 if all have seen the same; above 1.01 they should
/// not be trusted (Vehtari et al. 2021). n is the least length; lengths should be equal.
/// `None` for fewer than two sequences, sequences of fewer than two numbers, or if nothing
/// varies. Infinite if each sequence is constant but they differ.
pub fn r_hat(sequences: &[Mean]) -> Option<f64> {
    let n = sequences.iter().map(Mean::count).min()?;
    if sequences.len() < 2 || n < 2 {
        return None;
    }
    let within: Mean = sequences.iter().map(Mean::variance).collect();
    let between: Mean = sequences.iter().map(Mean::mean).collect();
    let (within, between) = (within.mean(), between.variance());
    if within + between > 0.0 {
        let n = n as f64;
        Some((((n - 1.0) / n * within + between) / within).sqrt())
    } else {
        None
    }
}

/// Split R-hat over chains: [`r_hat`] of all their halves, so that a single chain that still
/// drifts is found as well (Gelman et al. 2013).
///
/// `None` as for [`r_hat`], and if a chain has no halves yet.
pub fn split_r_hat(chains: &[Halves]) -> Option<f64> {
    let halves: Option<Vec<[Mean; 2]>> = chains.iter().map(Halves::halves).collect();
    r_hat(halves?.as_flattened())
}

/// Rank-normalised split R-hat of stored numbers, one series a chain: the larger of bulk and
/// folded (Vehtari, Gelman, Simpson, Carpenter and Burkner 2021, section 4).
///
/// Numbers are replaced by the normal quantiles of their ranks among all ((r - 3/8) / (S +
/// 1/4), ties share a mean rank), which makes sense of functionals without variance, such as
/// weights of heavy tails; folding (the distance from the median) finds chains that differ
/// in spread. Only the first numbers up to the shortest series' even length are used. Needs
/// all numbers, sorted: for thinned series, at the end of a run. NaN counts as largest.
pub fn rank_split_r_hat<S: AsRef<[f64]>>(chains: &[S]) -> Option<f64> {
    let n = chains.iter().map(|chain| chain.as_ref().len()).min()? / 2;
    let halves: Vec<f64> = chains
        .iter()
        .flat_map(|chain| &chain.as_ref()[..2 * n])
        .copied()
        .collect();
    let bulk = of_ranks(&halves, n)?;
    let middle = median(&halves);
    let folded: Vec<f64> = halves.iter().map(|x| (x - middle).abs()).collect();
    Some(of_ranks(&folded, n).map_or(bulk, |tail| bulk.max(tail)))
}

/// R-hat of the normal scores of successive sequences of `n` numbers.
fn of_ranks(numbers: &[f64], n: usize) -> Option<f64> {
    if n < 2 {
        return None;
    }
    let scores = normal_scores(numbers);
    let sequences: Vec<Mean> = scores
        .chunks_exact(n)
        .map(|s| s.iter().copied().collect())
        .collect();
    r_hat(&sequences)
}

fn normal_scores(numbers: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    order.sort_by(|&i, &j| compare(&numbers[i], &numbers[j]));
    let mut scores = vec![0.0; numbers.len()];
    let mut begin = 0;
    while begin < order.len() {
        let first = numbers[order[begin]];
        let ties = order[begin..]
            .iter()
            .take_while(|&&i| compare(&numbers[i], &first).is_eq())
            .count();
        let rank = begin as f64 + 0.5 * (ties + 1) as f64; // the mean of theirs, from 1
        let score = quantile((rank - 0.375) / (numbers.len() as f64 + 0.25));
        for &i in &order[begin..begin + ties] {
            scores[i] = score;
        }
        begin += ties;
    }
    scores
}

/// By size; whatever is no number, of either sign, is largest.
fn compare(a: &f64, b: &f64) -> Ordering {
    match (a.is_nan(), b.is_nan()) {
        (false, false) => a.total_cmp(b),
        (a, b) => a.cmp(&b),
    }
}

fn median(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(compare);
    match sorted.len() {
        0 => 0.0,
        n => 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Draws, generator};

    /// A series around `place` with `spread`, drifting by `drift` over its length.
    fn series(n: usize, seed: u64, place: f64, spread: f64, drift: f64) -> Vec<f64> {
        let mut rng = generator(72, seed);
        let at = |i: usize| place + drift * i as f64 / n as f64;
        (0..n)
            .map(|i| at(i) + spread * quantile(rng.uniform().max(1e-16)))
            .collect()
    }

    fn halves(series: &[f64]) -> Halves {
        let mut halves = Halves::new();
        series.iter().for_each(|x| halves.push(*x));
        halves
    }

    fn both(chains: &[Vec<f64>]) -> (f64, f64) {
        let online: Vec<Halves> = chains.iter().map(|c| halves(c)).collect();
        (
            split_r_hat(&online).unwrap(),
            rank_split_r_hat(chains).unwrap(),
        )
    }

    #[test]
    fn r_hat_and_normal_scores_are_those_worked_out_by_hand() {
        // W = 1, means 2 and 3: B/n = 1/2
        let sequences = [[1.0, 2.0, 3.0], [2.0, 3.0, 4.0]].map(|s| s.into_iter().collect());
        let expected = (2.0f64 / 3.0 + 0.5).sqrt();
        assert!((r_hat(&sequences).unwrap() - expected).abs() < 1e-15);
        assert_eq!(r_hat(&sequences[..1]), None);
        let constant = [[1.0; 3], [1.0; 3]].map(|s| s.into_iter().collect());
        assert_eq!(r_hat(&constant), None);
        let apart = [[1.0; 3], [2.0; 3]].map(|s| s.into_iter().collect());
        assert_eq!(r_hat(&apart), Some(f64::INFINITY));
        // ranks 1, 2.5, 2.5, 4 of 4
        let scores = normal_scores(&[5.0, 7.0, 7.0, 9.0]);
        assert!((scores[0] - quantile(0.625 / 4.25)).abs() < 1e-15);
        assert!(scores[1].abs() < 1e-15 && scores[2].abs() < 1e-15);
        assert!((scores[3] + scores[0]).abs() < 1e-15);
    }

    #[test]
    fn agreement_is_near_one_and_each_disagreement_is_found() {
        const N: usize = 4000;
        let chains = |change: &dyn Fn(u64) -> [f64; 3]| -> Vec<Vec<f64>> {
            let all = (0..4).map(|i| (i, change(i)));
            all.map(|(i, [place, spread, drift])| series(N, i, place, spread, drift))
                .collect()
        };
        let one = |i: u64| f64::from(u8::from(i == 3));
        let (plain, ranks) = both(&chains(&|_| [0.0, 1.0, 0.0]));
        assert!((plain - 1.0).abs() < 2e-3 && (ranks - 1.0).abs() < 2e-3);
        let (plain, ranks) = both(&chains(&|i| [one(i), 1.0, 0.0]));
        assert!(
            plain > 1.05 && ranks > 1.05,
            "another place: {plain} {ranks}"
        );
        let (plain, ranks) = both(&chains(&|_| [0.0, 1.0, 1.0]));
        assert!(plain > 1.02 && ranks > 1.02, "all drift: {plain} {ranks}");
        let (plain, ranks) = both(&chains(&|i| [0.0, 1.0 + 2.0 * one(i), 0.0]));
        assert!(
            plain < 1.01 && ranks > 1.05,
            "another spread: {plain} {ranks}"
        );
    }

    /// The quotient of two zeros has a sign, which differs between machines.
    #[test]
    fn no_number_is_largest_whatever_its_sign() {
        let series = |nan: f64| vec![1.0, 3.0, nan, 2.0, 5.0, nan, 4.0, 0.0];
        let chains = |nan| [series(nan), vec![2.0, 1.0, 0.0, 4.0, 3.0, 6.0, 5.0, 7.0]];
        let of = |nan| rank_split_r_hat(&chains(nan)).map(f64::to_bits);
        assert!(of(f64::NAN).is_some());
        assert_eq!(of(f64::NAN), of(-f64::NAN));
        let scores = normal_scores(&[1.0, -f64::NAN, f64::INFINITY, f64::NAN]);
        assert!(scores[0] < scores[2] && scores[2] < scores[1]);
        assert_eq!(scores[1].to_bits(), scores[3].to_bits());
    }

    #[test]
    fn short_series_have_no_answer() {
        assert_eq!(rank_split_r_hat::<Vec<f64>>(&[]), None);
        assert_eq!(rank_split_r_hat(&[vec![1.0, 2.0, 3.0]]), None);
        assert_eq!(rank_split_r_hat(&[vec![1.0; 8], vec![1.0; 8]]), None);
        assert_eq!(split_r_hat(&[Halves::new()]), None);
    }
}
