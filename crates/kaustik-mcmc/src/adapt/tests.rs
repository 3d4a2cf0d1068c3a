//! Adaptations on targets whose best size is known.

use kaustik_pss::{Coordinates, Stream};

use crate::{
    Acceptance, AcceptanceAdaptation, DiminishingAdaptation, Exponential, Ignore, JumpAdaptation,
    Jumps, Mean, Metropolis, Point, PointKernel, Power, Scalable, Uniform, Visit, WrappedNormal,
    generator, target,
};

/// A normal peak of deviation `width` in four dimensions.
fn peak(
    width: f64,
) -> (
    impl crate::Target<Value = [f64; 4]>,
    impl Fn(&[f64; 4]) -> [f64; 1],
) {
    let toy = target(|u: &mut dyn Coordinates| [0, 1, 2, 3].map(|i| u.get(Stream::Camera, i)));
    let density = move |x: &[f64; 4]| {
        let r2: f64 = x.iter().map(|x| (x - 0.5) * (x - 0.5)).sum();
        [libm::exp(-0.5 * r2 / (width * width)).max(1e-300)]
    };
    (toy, density)
}

/// The acceptance of the last round of `rounds`.
fn adapted<M: Scalable>(width: f64, first: M, target: f64, rounds: u32) -> (f64, M) {
    let (toy, density) = peak(width);
    let mut adaptation = AcceptanceAdaptation::new(first).with_target(target);
    let mut rng = generator(61, 0);
    let mut chain = Metropolis::start(&&toy, &density, 0, adaptation.mutation(), &mut rng);
    let kernel = PointKernel::new(&toy, 0.0);
    let mut last = Acceptance::default();
    for _ in 0..rounds {
        let before = *chain.statistics().small();
        for _ in 0..1000 {
            chain.step(&kernel, &density, &mut rng, &mut Ignore);
        }
        let total = *chain.statistics().small();
        last = total.since(&before);
        chain.set_mutation(adaptation.end_round(&total), &mut rng);
    }
    (last.rate(), adaptation.mutation())
}

/// In ten rounds from steps that go everywhere to those of a narrow peak; acceptances themselves need more.
#[test]
fn logarithms_of_acceptances_come_to_their_target_soon() {
    let rate = |logarithmic: bool| {
        let (toy, density) = peak(0.01);
        let mut adaptation = AcceptanceAdaptation::new(Power::new(1.0));
        if logarithmic {
            adaptation = adaptation.with_gain(1.0, 0.5).in_logarithms();
        }
        let mut rng = generator(62, 0);
        let mut chain = Metropolis::start(&&toy, &density, 0, adaptation.mutation(), &mut rng);
        let kernel = PointKernel::new(&toy, 0.0);
        for _ in 0..10 {
            for _ in 0..1000 {
                chain.step(&kernel, &density, &mut rng, &mut Ignore);
            }
            let total = *chain.statistics().small();
            chain.set_mutation(adaptation.end_round(&total), &mut rng);
        }
        let before = *chain.statistics().small();
        for _ in 0..1000 {
            chain.step(&kernel, &density, &mut rng, &mut Ignore);
        }
        chain.statistics().small().since(&before).rate()
    };
    let (soon, late) = (rate(true), rate(false));
    assert!((soon - 0.234).abs() < 0.06, "{soon}");
    assert!((late - 0.234).abs() > 0.1, "{late}");
}

#[test]
fn acceptance_comes_to_its_target_from_either_side() {
    for (sigma, aim) in [(0.5, 0.234), (1e-5, 0.234), (1e-3, 0.44)] {
        let (rate, mutation) = adapted(0.03, WrappedNormal::new(sigma), aim, 100);
        assert!((rate - aim).abs() < 0.03, "{sigma} {aim}: {rate}");
        if aim < 0.4 {
            // 2.38 / sqrt(4) deviations of the target are optimal and accept about as much
            let relative = mutation.sigma() / 0.03;
            assert!((0.9..1.9).contains(&relative), "{sigma}: {relative}");
        }
    }
    let (rate, mutation) = adapted(0.03, Exponential::default(), 0.3, 100);
    assert!((rate - 0.3).abs() < 0.03, "{rate}");
    let (s1, s2) = mutation.sizes();
    assert!((s2 / s1 - 16.0).abs() < 1e-9, "sizes keep their proportion");
}

#[test]
fn rounds_take_what_is_new_and_nothing_is_learnt_from_nothing() {
    let mut adaptation = AcceptanceAdaptation::new(Uniform::new(0.1)).with_gain(1.0, 1.0);
    let total = |proposed: u64, expected: f64| Acceptance {
        proposed,
        accepted: 0,
        expected,
    };
    let first = adaptation.end_round(&total(10, 7.34));
    assert!((first.fraction() / 0.1 - libm::exp(0.5)).abs() < 1e-12);
    // the new ten are rejected: log size falls by 0.234 / 2
    let second = adaptation.end_round(&total(20, 7.34));
    assert!((second.fraction() / 0.1 - libm::exp(0.5 - 0.117)).abs() < 1e-12);
    assert_eq!(adaptation.end_round(&total(20, 7.34)), second);
    assert_eq!(adaptation.rounds(), 2);
}

#[test]
fn the_search_finds_the_largest_jump() {
    // log-parabola with its top at 2^-7.3 of the circle
    let jump = |m: &WrappedNormal| {
        let octaves = libm::log2(m.sigma()) + 7.3;
        libm::exp2(-octaves * octaves)
    };
    // under the last nothing moves unless steps are a thousandth of the first ones
    let narrow = |m: &WrappedNormal| if m.sigma() < 2e-3 { jump(m) } else { 0.0 };
    type Law<'a> = &'a dyn Fn(&WrappedNormal) -> f64;
    let jumps: [(f64, Law<'_>); 3] = [(0.5, &jump), (1e-5, &jump), (0.9, &narrow)];
    for (sigma, jump) in jumps {
        let mut adaptation = JumpAdaptation::new(WrappedNormal::new(sigma));
        for _ in 0..150 {
            let now = jump(&adaptation.mutation());
            let _ = adaptation.end_round(now);
        }
        let best = adaptation.best();
        let octaves = libm::log2(best.sigma()) + 7.3;
        // the narrow one's top lies at its edge
        let is_right =
            octaves.abs() < 0.05 || (sigma > 0.8 && (1e-3..2e-3).contains(&best.sigma()));
        assert!(is_right, "{sigma}: off by {octaves} octaves");
    }
    // and on a chain, whose jumps are noisy: Gelman's 2.38 / sqrt(d) deviations
    let (toy, density) = peak(0.03);
    let mut adaptation = JumpAdaptation::new(WrappedNormal::new(1e-3));
    let mut rng = generator(62, 0);
    let mut chain = Metropolis::start(&&toy, &density, 0, adaptation.mutation(), &mut rng);
    let kernel = PointKernel::new(&toy, 0.0);
    let mut jumps = Jumps::circular();
    for _ in 0..60 {
        for _ in 0..2000 {
            chain.step(&kernel, &density, &mut rng, &mut Ignore);
            jumps.push(*chain.value());
        }
        let mutation = adaptation.end_round(jumps.end_round().mean());
        chain.set_mutation(mutation, &mut rng);
    }
    let relative = adaptation.best().sigma() / 0.03;
    assert!((0.7..2.0).contains(&relative), "{relative}");
}

/// m = max(10^-4, m + (A - target) / n), mutation by mutation.
#[test]
fn diminishing_adaptation_is_hachisuka_and_jensens() {
    let mut adaptation = DiminishingAdaptation::new();
    let (mut total, mut size) = (Acceptance::default(), 1.0f64);
    let mut rng = generator(63, 0);
    for i in 1..=1000u32 {
        total.proposed += 1;
        total.accepted += u64::from(crate::Draws::uniform(&mut rng) < 0.1);
        let rate = total.accepted as f64 / f64::from(i);
        size = (size + (rate - 0.234) / f64::from(i)).max(1e-4);
        let mutation = adaptation.end_round(&total);
        assert!((mutation.size() - size).abs() < 1e-15 && (adaptation.size() - size).abs() < 1e-15);
    }
    assert!(size < 0.5);
    // a round without steps changes nothing
    let _ = adaptation.end_round(&total);
    assert!((adaptation.size() - size).abs() < 1e-15);
}

#[test]
fn diminishing_adaptation_reaches_its_target() {
    // theirs: where photons are seen, or not
    let toy = target(|u: &mut dyn Coordinates| [0, 1].map(|i| u.get(Stream::Camera, i)));
    let density = |x: &[f64; 2]| [f64::from(u8::from(x.iter().all(|x| (x - 0.5).abs() < 0.2)))];
    let mut adaptation = DiminishingAdaptation::new();
    let mut rng = generator(64, 0);
    let mut chain = Metropolis::start(&&toy, &density, 0, adaptation.mutation(), &mut rng);
    while chain.density() <= 0.0 {
        chain.restart(&&toy, &density, &mut rng);
    }
    let kernel = PointKernel::new(&toy, 0.0);
    let mut late = Acceptance::default();
    for step in 0..200_000 {
        if step == 150_000 {
            late = *chain.statistics().small();
        }
        chain.step(&kernel, &density, &mut rng, &mut Ignore);
        chain.set_mutation(adaptation.end_round(chain.statistics().small()), &mut rng);
    }
    let rate = chain.statistics().small().since(&late).rate();
    assert!((rate - 0.234).abs() < 0.02, "{rate}");
}

/// Which share of its time a chain spends in the wide half of a target that is narrow in
/// one half and wide in the other, each of weight 1/2, adapting every `length` steps.
fn wide_share(length: u32, gain: f64, decay: f64) -> Mean {
    let toy =
        target(|u: &mut dyn Coordinates| [u.get(Stream::Camera, 0), u.get(Stream::Camera, 1)]);
    // the left half is a comb, 1/8 of it bright
    let density = |x: &[f64; 2]| {
        let bright = (x[1] * 8.0).fract() < 0.125;
        [if x[0] >= 0.5 {
            1.0
        } else {
            f64::from(u8::from(bright)) * 8.0
        }]
    };
    let kernel = PointKernel::new(&toy, 0.0);
    let chain = |ladder: u64| {
        let mut rng = generator(65, ladder);
        let first = Uniform::new(0.5);
        let mut adaptation = AcceptanceAdaptation::new(first)
            .with_target(0.4)
            .with_gain(gain, decay);
        let mut chain: Metropolis<Point<Uniform>, [f64; 2], 1> =
            Metropolis::start(&&toy, &density, 0, first, &mut rng);
        let mut wide = 0.0;
        let mut record = |visit: Visit<'_, [f64; 2], 1>| {
            wide += visit.weight * f64::from(u8::from(visit.value[0] >= 0.5));
        };
        const STEPS: u32 = 60_000;
        for step in 1..=STEPS {
            chain.step(&kernel, &density, &mut rng, &mut record);
            if step % length == 0 {
                chain.set_mutation(adaptation.end_round(chain.statistics().small()), &mut rng);
            }
        }
        chain.flush(&mut record);
        wide / f64::from(STEPS)
    };
    (0..24).map(chain).collect()
}

/// Short rounds with a gain that does not diminish bias the chain, however well settled;
/// long rounds with a falling gain do not, within what can be seen.
#[test]
fn short_rounds_are_biased_and_long_ones_are_not() {
    let short = wide_share(16, 2.0, 0.0);
    let z = (short.mean() - 0.5) / short.standard_error();
    assert!(
        z.abs() > 10.0,
        "{} +- {}",
        short.mean(),
        short.standard_error()
    );
    let long = wide_share(1000, 2.0, 1.0);
    let z = (long.mean() - 0.5) / long.standard_error();
    assert!(
        z.abs() < 3.0,
        "{} +- {}",
        long.mean(),
        long.standard_error()
    );
}

#[test]
fn scaled_steps_keep_their_kind() {
    assert_eq!(Uniform::new(0.2).scaled(3.0), Uniform::new(0.2 * 3.0));
    assert_eq!(Power::new(0.2).scaled(0.5), Power::new(0.1));
    // against the end of the circle the proportion is kept, not the size
    let (s1, s2) = Exponential::new(0.01, 0.16).scaled(100.0).sizes();
    assert!((s2 - 0.5).abs() < 1e-15 && (s2 / s1 - 16.0).abs() < 1e-12);
}
