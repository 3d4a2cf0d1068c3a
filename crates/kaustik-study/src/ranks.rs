//! Whether one sample lies below another, told by ranks.

/// The chance that of two samples of one distribution the first lies as far below the second as `a` below `b`: the exact
/// distribution of Mann and Whitney's U (1947), equal values counted by half; half a pair left over counts against it.
pub(crate) fn chance_to_be_so_low(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
    let above = |(x, y): (&f64, &f64)| match x.total_cmp(y) {
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Equal => 0.5,
        std::cmp::Ordering::Greater => 1.0,
    };
    let above: f64 = pairs.map(above).sum();
    let orders = orders(a.len(), b.len());
    let as_low = orders.iter().take(above.ceil() as usize + 1);
    as_low.sum::<f64>() / orders.iter().sum::<f64>()
}

/// In how many orders of `m` and `n` values so many pairs have the one of the first above that of the second, by that number.
fn orders(m: usize, n: usize) -> Vec<f64> {
    // `rows[j]`: of i and j values, for i as the outer loop has come to.
    let mut rows: Vec<Vec<f64>> = vec![vec![1.0]; n + 1];
    for i in 1..=m {
        rows[0] = vec![1.0];
        for j in 1..=n {
            // The largest is one of the first, above all j of the second, or one of the second.
            let mut counts = vec![0.0; i * j + 1];
            for (u, count) in rows[j].iter().enumerate() {
                counts[u + j] += count;
            }
            for (u, count) in rows[j - 1].iter().enumerate() {
                counts[u] += count;
            }
            rows[j] = counts;
        }
    }
    rows.pop().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_all_there_are() {
        assert_eq!(orders(2, 2), [1.0, 1.0, 2.0, 1.0, 1.0]);
        let all: f64 = orders(5, 5).iter().sum();
        assert!((all - 252.0).abs() < 1e-9);
        assert_eq!(orders(3, 1), [1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn chances_are_those_of_all_orders() {
        let low = [1.0, 2.0, 3.0, 4.0, 5.0];
        let high = [6.0, 7.0, 8.0, 9.0, 10.0];
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(chance_to_be_so_low(&low, &high), 1.0 / 252.0));
        assert!(close(chance_to_be_so_low(&high, &low), 1.0));
        assert!(close(
            chance_to_be_so_low(&[1.0, 3.0], &[2.0, 4.0]),
            2.0 / 6.0
        ));
        // Equal values tell nothing.
        assert!(chance_to_be_so_low(&[1.0; 4], &[1.0; 4]) > 0.5);
    }
}
