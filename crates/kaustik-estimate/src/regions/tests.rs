use kaustik_mcmc::{Draws, generator};

use super::*;

/// Points of a room's floor and of a lump in its corner.
fn scattered(count: usize) -> Vec<RegionPoint> {
    let mut draws = generator(3, 0);
    let mut u = || draws.uniform() as f32;
    (0..count)
        .map(|index| match index % 3 {
            0 => [0.1 * u(), 0.1 * u(), 0.1 * u(), 0.0, 0.0, 0.0],
            _ => [4.0 * u(), 0.0, 3.0 * u(), 0.0, 0.0, 0.0],
        })
        .collect()
}

/// Every point has one leaf, the one its path from the root ends in, and medians share points evenly.
#[test]
fn a_tree_holds_each_point_once_and_evenly() {
    let points = scattered(9_000);
    let regions = Regions::spatial(&mut points.clone());
    assert!(regions.leaves() > 240, "{}", regions.leaves());
    let mut held = vec![0_usize; regions.leaves()];
    for point in &points {
        held[regions.leaf(*point) as usize] += 1;
    }
    assert_eq!(held.iter().sum::<usize>(), points.len());
    // Halving 9000 nine times leaves 17 or 18; those in a plane of equal coordinates go together.
    let uneven = held.iter().filter(|n| !(17..=18).contains(*n)).count();
    assert!(uneven * 10 < held.len(), "{uneven} of {}", held.len());
    // Far outside of the pilot there are leaves as well.
    assert!((regions.leaf([1e9, -1e9, 1e9, 0.0, 0.0, 0.0]) as usize) < regions.leaves());
}

/// A room before a landscape: two thirds of the points on the wall between them, which is the low end of the
/// longest side.
#[test]
fn a_wall_is_parted_from_what_is_beyond_it() {
    let mut draws = generator(4, 0);
    let mut u = || draws.uniform() as f32;
    let mut points: Vec<RegionPoint> = (0..9_000)
        .map(|index| match index % 3 {
            0 => [4.0 * u(), 2.0 * u(), 11.0 + 69.0 * u(), 0.0, 0.0, 0.0],
            _ => [4.0 * u(), 2.0 * u(), 11.0, 0.0, 0.0, 0.0],
        })
        .collect();
    let regions = Regions::spatial(&mut points);
    let mut held = vec![[0_usize; 2]; regions.leaves()];
    for point in &points {
        held[regions.leaf(*point) as usize][usize::from(point[2] > 11.0)] += 1;
    }
    for [wall, beyond] in held {
        assert!((1..2 * Regions::LEAST_POINTS).contains(&(wall + beyond)));
        assert!(wall == 0 || beyond == 0, "{wall} {beyond}");
    }
    // Points in one place are a leaf.
    let regions = Regions::spatial(&mut [[1.0; 6]; 1_000]);
    assert_eq!(regions.leaves(), 1);
}

/// What leaves are told is what their ancestors know: sums of psi / s against G Eqs. 8 and 10 as printed.
#[test]
fn sums_are_those_of_the_recursion() {
    let mut regions = Regions::spatial(&mut scattered(9_000));
    let leaves = regions.leaves();
    let mut draws = generator(5, 0);
    let (mut kappa, mut last, mut rounds) = (0.0, None, 0.0);
    let areas: Vec<Vec<f64>> = (0..7)
        .map(|round| {
            let empty = round == 3; // a whole iteration without points changes nothing
            let area = |_| if empty { 0.0 } else { draws.uniform() };
            (0..leaves).map(area).collect()
        })
        .collect();
    let mut draws = generator(6, 0);
    for area in &areas {
        regions.set_areas(area);
        let s: f64 = area.iter().sum();
        let tally = |area: &f64| LeafTally {
            psi: [0, 1].map(|_| area * draws.uniform()),
            paths: 1.0,
            ..LeafTally::default()
        };
        let tallies: Vec<LeafTally> = area.iter().map(tally).collect();
        let psi: f64 = tallies.iter().map(|t| t.psi[0] + t.psi[1]).sum();
        if s > 0.0 {
            if let Some(before) = last {
                kappa *= s / before; // G Eq. 8, on the way to this iteration
            }
            kappa += psi;
            last = Some(s);
            rounds += 1.0;
        }
        regions.learn(&tallies, Refinement::Off);
    }
    let printed = kappa / (rounds * last.unwrap()); // G Eq. 10
    let ours = regions.known_density(0);
    assert!((ours / printed - 1.0).abs() < 1e-12, "{ours} {printed}");
    assert_eq!(regions.cut(), 1);
}

/// The cut goes where the statistics suffice and nowhere else; densities are those of its regions.
#[test]
fn the_cut_follows_what_is_known() {
    let mut regions = Regions::spatial(&mut scattered(9_000));
    let leaves = regions.leaves();
    let areas = vec![1.0; leaves];
    let with = |paths: f64, halves: [f64; 2]| {
        (0..leaves)
            .map(|leaf| LeafTally {
                psi: halves.map(|half| half * (1.0 + leaf as f64)),
                paths,
                ..LeafTally::default()
            })
            .collect::<Vec<_>>()
    };
    regions.set_areas(&areas);
    regions.learn(&with(20_000.0, [0.5, 0.4]), Refinement::PUBLISHED);
    assert_eq!(regions.cut(), 1, "halves that differ by more than 5 %");
    let mut regions = Regions::spatial(&mut scattered(9_000));
    regions.set_areas(&areas);
    regions.learn(&with(3_000.0, [0.5, 0.5]), Refinement::PUBLISHED);
    let cut = regions.cut();
    assert!(
        cut > 8 && cut < leaves,
        "{cut}: regions of four leaves or more"
    );
    regions.set_areas(&areas);
    regions.learn(&with(20_000.0, [0.5, 0.5]), Refinement::PUBLISHED);
    assert_eq!(regions.cut(), leaves);
    for (leaf, density) in regions.densities().into_iter().enumerate() {
        let wanted = (1.0 + leaf as f64) / leaves as f64;
        assert!((density - wanted).abs() < 1e-12, "{leaf}: {density}");
    }
}

/// A region of which nothing is known goes by the nearest ancestor.
#[test]
fn the_unknown_go_by_their_ancestors() {
    let mut regions = Regions::spatial(&mut scattered(9_000));
    let leaves = regions.leaves();
    assert!(regions.densities().iter().all(|&d| (d - 1.0).abs() < 1e-15));
    let mut tallies = vec![LeafTally::default(); leaves];
    tallies[0].psi = [1.0, 1.0];
    regions.set_areas(&vec![1.0; leaves]);
    regions.learn(&tallies, Refinement::Iterations);
    assert_eq!(regions.cut(), 2);
    let densities = regions.densities();
    let dark = densities.iter().filter(|&&d| d < 0.99).count();
    assert!(dark > leaves / 3 && dark < leaves, "{dark} of {leaves}");
    assert!(densities.iter().all(|&d| d > 0.0));
    // One division further: the lit half's dark half goes by the lit half, the dark half still by the whole.
    regions.learn(&tallies, Refinement::Iterations);
    let values: std::collections::BTreeSet<u64> =
        regions.densities().iter().map(|d| d.to_bits()).collect();
    assert!(values.len() >= 3, "{values:?}");
}

#[test]
fn an_image_is_halved_both_ways() {
    let regions = Regions::image();
    assert_eq!(regions.leaves(), 1 << Regions::MOST_LEVELS);
    let at = |x: f32, y: f32| regions.leaf([x, y, 0.0, 0.0, 0.0, 0.0]);
    assert_ne!(at(0.1, 0.1), at(0.9, 0.1));
    assert_ne!(at(0.1, 0.1), at(0.1, 0.9));
    assert_eq!(at(0.1, 0.1), at(0.1001, 0.1001));
}

#[test]
fn factors_stay_in_their_range() {
    assert!((inverse(0.0) - 1.0).abs() < 1e-15);
    assert!((inverse(1.0) - EPSILON / (1.0 + EPSILON)).abs() < 1e-15);
}

/// Two sheets in one place that face opposite ways have no region in common where regions are small, and
/// share them where normals have no length.
#[test]
fn normals_part_what_places_do_not() {
    let sheets = |length: f32| -> Vec<RegionPoint> {
        let mut points = scattered(6_000);
        for (index, point) in points.iter_mut().enumerate() {
            let side = if index % 2 == 0 { 1.0 } else { -1.0 };
            *point = [point[0], 0.0, point[2], 0.0, side * length, 0.0];
        }
        points
    };
    for (length, apart) in [(1.0, true), (0.0, false)] {
        let points = sheets(length);
        let regions = Regions::spatial(&mut points.clone());
        let mut sides = vec![[0_usize; 2]; regions.leaves()];
        for (index, point) in points.iter().enumerate() {
            sides[regions.leaf(*point) as usize][index % 2] += 1;
        }
        let mixed = sides.iter().filter(|s| s[0] > 0 && s[1] > 0).count();
        assert_eq!(mixed == 0, apart, "{mixed} of {} leaves", sides.len());
    }
}

/// Where fluxes are known, a region counts as dense as one of equal fluxes with the same relative variance (G Eq. 3).
#[test]
fn uneven_fluxes_make_a_region_thinner() {
    let mut regions = Regions::spatial(&mut scattered(9_000));
    let leaves = regions.leaves();
    let tallies: Vec<LeafTally> = (0..leaves)
        .map(|leaf| LeafTally {
            psi: [1.0, 1.0],
            // fluxes of 3 everywhere, or of 0 and 6 by turns
            flux: [6.0, if leaf % 2 == 0 { 18.0 } else { 36.0 }],
            paths: 20_000.0,
        })
        .collect();
    regions.set_areas(&vec![1.0; leaves]);
    regions.learn(&tallies, Refinement::EARLY);
    assert_eq!(regions.cut(), leaves);
    for (leaf, density) in regions.densities().into_iter().enumerate() {
        let wanted = if leaf % 2 == 0 { 1.0 } else { 0.5 };
        assert!((density - wanted).abs() < 1e-12, "{leaf}: {density}");
    }
}

/// Leaves of a tree in which those that so many light paths have touched, in the mean, lie side by side: what
/// they tell in one iteration.
fn touched(regions: &Regions, mean: impl Fn(usize) -> f64, seed: u64) -> Vec<LeafTally> {
    let mut draws = generator(seed, 0);
    let tally = |leaf: usize| {
        // Poisson, by the time between two of them
        let (mut count, mut time) = (0.0, 0.0);
        loop {
            time -= (1.0 - draws.uniform()).ln();
            if time > mean(leaf) {
                break;
            }
            count += 1.0;
        }
        LeafTally {
            psi: [0.5 * count; 2],
            paths: count,
            ..LeafTally::default()
        }
    };
    (0..regions.leaves()).map(tally).collect()
}

/// The formula itself, of a root with two leaves.
#[test]
fn what_is_known_of_a_half_is_drawn_towards_the_whole() {
    let mut regions = Regions::spatial(&mut scattered(2 * Regions::LEAST_POINTS));
    assert_eq!(regions.leaves(), 2);
    regions.set_areas(&[1.0, 1.0]);
    let tally = |count: f64| LeafTally {
        psi: [0.5 * count; 2],
        paths: count,
        ..LeafTally::default()
    };
    for (counts, prior) in [([30.0, 10.0], 20), ([8.0, 0.0], 20), ([3.0, 5.0], 0)] {
        let mut regions = regions.clone();
        regions.learn(&counts.map(tally), Refinement::Shrunk { paths: prior });
        assert_eq!(regions.cut(), 2, "what it shows are leaves");
        let (found, prior) = (regions.shrunk_densities(prior), f64::from(prior));
        let expected = 0.5 * (counts[0] + counts[1]);
        let wanted = counts.map(|n| (prior + n) / (prior + expected));
        let most = wanted[0].max(wanted[1]);
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted / most).abs() < 1e-12, "{counts:?}: {found}");
        }
    }
}

/// Where few light paths have come it is nearer to the truth than leaves alone and than the cut; where many
/// have, it is what the leaves say.
#[test]
fn shrunk_densities_are_nearer() {
    let truth = |leaf: usize| [3.0, 1.0, 6.0, 10.0][leaf / 20 % 4];
    let mean = |count: f64| move |leaf: usize| count * truth(leaf);
    let distance = |count: f64, of: fn(&Regions) -> Vec<f64>, refinement| {
        let mut regions = Regions::spatial(&mut scattered(9_000));
        regions.set_areas(&vec![1.0; regions.leaves()]);
        regions.learn(&touched(&regions, mean(count), 9), refinement);
        let known = of(&regions);
        // up to a factor, which no target has
        let logs = |d: &f64, leaf| (d / truth(leaf)).ln();
        let logs: Vec<f64> = known
            .iter()
            .zip(0..)
            .map(|(d, leaf)| logs(d, leaf))
            .collect();
        let middle = logs.iter().sum::<f64>() / logs.len() as f64;
        let square = logs.iter().map(|log| (log - middle).powi(2)).sum::<f64>();
        (square / logs.len() as f64).sqrt()
    };
    let shrunk = |count| {
        let refinement = Refinement::SHRUNK;
        distance(count, |regions| regions.shrunk_densities(20), refinement)
    };
    let few = shrunk(1.0);
    let cut = distance(1.0, Regions::densities, Refinement::EARLY);
    let leaves = distance(1.0, Regions::densities, Refinement::Shrunk { paths: 0 });
    assert!(
        few < 0.7 * cut && few < 0.7 * leaves,
        "{few}, {cut}, {leaves}"
    );
    assert!(shrunk(1000.0) < 0.1, "{}", shrunk(1000.0));
}
