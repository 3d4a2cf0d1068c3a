use super::*;

#[test]
fn every_default_of_the_table_is_the_default() {
    for method in Method::ALL {
        for key in method.keys() {
            let mut options = Options::default();
            options
                .set(method, &format!("{}={}", key.name, key.default))
                .unwrap();
            assert_eq!(options, Options::default(), "{}", key.name);
        }
    }
}

#[test]
fn what_is_written_is_what_was_set() {
    let mut options = Options::default();
    for text in [
        "mutation=uniform:0.05",
        "mis=off",
        "target=luminance",
        "plarge=0.5",
        "builder=simple",
        "heuristic=maximum",
    ] {
        options.set(Method::Pssmlt, text).unwrap();
    }
    let mut again = Options::default();
    for (key, value) in options.entries(Method::Pssmlt) {
        again
            .set(Method::Pssmlt, &format!("{key}={value}"))
            .unwrap();
    }
    assert_eq!(again, options);
}

#[test]
fn what_is_written_of_replicas_is_what_was_set() {
    let mut options = Options::default();
    for text in [
        "replicas=uniform;1,0,1,1,1,1;0.5,0,0,1,1,1",
        "beta=1.5",
        "exchange=pair",
        "even=5",
        "steps=adapted",
        "particles=2000",
        "delta=0.1",
        "normaliser=exchange",
    ] {
        options.set(Method::Relt, text).unwrap();
    }
    assert_eq!(options.replica_set().count(), 3);
    let mut again = Options::default();
    for (key, value) in options.entries(Method::Relt) {
        again.set(Method::Relt, &format!("{key}={value}")).unwrap();
    }
    assert_eq!(again, options);
    for wrong in [
        "replicas=uniform;1,0,0,0,0,0;0,1,0,0,0,0",
        "beta=0.5",
        "delta=0",
        "exchange=some",
        "even=257",
        "even=some",
        "particles=9",
    ] {
        assert!(again.set(Method::Relt, wrong).is_err(), "{wrong}");
    }
    assert_eq!(again, options);
}

/// What code writes into fields is held against the same ranges, whichever method may read it.
#[test]
fn fields_out_of_range_are_refused() {
    type Change = fn(&mut Options);
    let wrong: [(&str, Change); 13] = [
        ("ladders", |o| o.ladders = 65_537),
        ("pilot", |o| o.pilot = 0),
        ("start", |o| o.start = StartShare::Halved(100)),
        ("beta", |o| o.beta = 0.5),
        ("delta", |o| o.delta = f64::NAN),
        ("even", |o| o.even = EvenSamples::Count(257)),
        ("particles", |o| o.particles = 0),
        ("mutation", |o| o.small_step = SmallStep::Uniform(2.0)),
        ("jitter", |o| o.jitter = Jitter::Between([2.0, 1.0])),
        ("acceptance", |o| o.photon.acceptance = 1.0),
        ("pace", |o| o.photon.pace = crate::Pace::Periods([0; 4])),
        ("photons", |o| o.photon.photons = Some(0)),
        ("floor", |o| o.stages.floor = 0.0),
    ];
    for method in Method::ALL {
        assert!(Options::default().check(method).is_ok(), "{method}");
        for (key, change) in wrong {
            let mut options = Options::default();
            change(&mut options);
            let error = options.check(method).expect_err(key).to_string();
            assert!(error.contains(key), "{method}: {error}");
        }
    }
}

/// A word that another method's key of the same name knows.
#[test]
fn words_of_other_methods_are_refused() {
    let mut options = Options {
        normaliser: Normaliser::Exchange,
        ..Options::default()
    };
    assert!(options.check(Method::Relt).is_ok());
    assert!(options.check(Method::Pssmlt).is_err());
    options.normaliser = Normaliser::Running;
    options.direct = Direct::Apart;
    assert!(options.check(Method::Mlt).is_ok());
    assert!(options.check(Method::MltMultistage).is_err());
}

#[test]
fn delta_is_of_the_standard_replicas() {
    for (replicas, delta, fits) in [
        ("standard", "0.1", true),
        ("paper", "0.05", true),
        ("paper", "0.1", false),
        ("uniform;1,0,0,0,0,0", "0.1", false),
    ] {
        for method in [Method::Relt, Method::Annealing] {
            let mut options = Options::default();
            options.set(method, &format!("delta={delta}")).unwrap();
            options
                .set(method, &format!("replicas={replicas}"))
                .unwrap();
            assert_eq!(options.check(method).is_ok(), fits, "{replicas} {delta}");
            // a method without replicas does not ask
            assert!(options.check(Method::Path).is_ok());
        }
    }
}

#[test]
fn what_is_written_of_mutations_is_what_was_set() {
    let mut options = Options::default();
    for text in [
        "mutations=lens,bidirectional",
        "jitter=0.5:20",
        "angles=0.001:0.5",
    ] {
        options.set(Method::Mlt, text).unwrap();
    }
    let mut again = Options::default();
    for (key, value) in options.entries(Method::Mlt) {
        again.set(Method::Mlt, &format!("{key}={value}")).unwrap();
    }
    assert_eq!(again, options);
    for wrong in [
        "mutations=",
        "mutations=lens,small",
        "jitter=3:1",
        "angles=0.1:4",
        "angles=1",
    ] {
        assert!(again.set(Method::Mlt, wrong).is_err(), "{wrong}");
    }
    assert_eq!(again, options);
}

#[test]
fn what_is_written_of_chains_from_samples_and_in_stages_is_what_was_set() {
    let erpt = [
        "length=7",
        "chains=0.5",
        "consecutive=20",
        "proposed=2.5",
        "seeds=bidirectional",
        "energy=passes",
        "perturbations=lens",
        "deposit=printed",
        "caustic=printed",
        "jitter=veach",
        "direct=apart",
    ];
    let stages = ["budget=5", "stages=two", "floor=0.25"];
    for (method, texts) in [
        (Method::Erpt, &erpt[..]),
        (Method::MltMultistage, &stages[..]),
    ] {
        let mut options = Options::default();
        for text in texts {
            options.set(method, text).unwrap();
            let entries = options.entries(method);
            let written = |(key, value): &(&str, String)| *text == format!("{key}={value}");
            assert!(entries.iter().any(written), "{text}: {entries:?}");
        }
        let mut again = Options::default();
        for (key, value) in options.entries(method) {
            again.set(method, &format!("{key}={value}")).unwrap();
        }
        assert_eq!(again, options);
    }
}

#[test]
fn wrong_words_are_refused_with_what_was_expected() {
    let mut options = Options::default();
    let message = |text: &str, options: &mut Options| {
        options.set(Method::Pssmlt, text).unwrap_err().to_string()
    };
    assert!(message("plarge=0", &mut options).contains("0 < p <= 1"));
    assert!(message("plarge=nan", &mut options).contains("plarge"));
    assert!(message("mutation=uniform", &mut options).contains("uniform:FRACTION"));
    assert!(message("colour=red", &mut options).contains("ladders"));
    assert!(message("plarge", &mut options).contains("key=value"));
    assert_eq!(options, Options::default());
    let error = options.set(Method::Path, "plarge=0.5").unwrap_err();
    assert!(matches!(error, OptionError::Key { .. }));
}
