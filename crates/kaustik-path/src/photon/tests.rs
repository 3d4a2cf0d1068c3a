use glam::Vec3;
use kaustik_mcmc::{Draws, generator};

use super::Lookup;

/// Balls of radii over five decades on a wavy sheet: what the grid finds is what holds the point, each once.
#[test]
fn a_lookup_finds_all_and_each_once() {
    let mut draws = generator(7, 0);
    let place = |draws: &mut dyn Draws| {
        let [x, y] = [0, 1].map(|_| 40.0 * draws.uniform() as f32 - 20.0);
        Vec3::new(x, y, (x * 0.3).sin())
    };
    let mut lookup = Lookup::default();
    for count in [0, 1, 3000] {
        let balls: Vec<(Vec3, f32)> = (0..count)
            .map(|_| {
                let center = place(&mut draws);
                (center, 10f32.powf(5.0 * draws.uniform() as f32 - 4.5))
            })
            .collect();
        lookup.rebuild(balls.iter().copied());
        let mut met = 0;
        for query in 0..4000 {
            let point = match balls.get(query) {
                // Within a ball, however small.
                Some((center, radius)) => *center + Vec3::splat(0.5 * radius),
                None => place(&mut draws),
            };
            let mut found = Vec::new();
            lookup.holding(point, |index| found.push(index as usize));
            found.sort_unstable();
            let holds = |(center, radius): &(Vec3, f32)| {
                (point - *center).length_squared() <= radius * radius
            };
            let expected: Vec<usize> = (0..balls.len()).filter(|&i| holds(&balls[i])).collect();
            met += expected.len();
            assert_eq!(found, expected, "query {query} of {count}");
        }
        assert!(met >= count);
    }
}
