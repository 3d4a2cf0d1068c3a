//! One accept/reject decision in the whole workspace, and every method calls it.
//!
//! A loop that decides for itself is how light transport codes come to have the same
//! mistake in three places. So no crate but `kaustik-mcmc` may toss a coin of a known
//! probability, and inside it the files that toss one are named here, each with what it
//! decides. Choices among several by their weights (`Draws::index`) are made where they belong.

use crate::source::{Source, lines_with, sources};

/// The only crate that decides.
const CRATE: &str = "kaustik-mcmc";

/// The file in which a proposal is accepted or rejected.
const DECISION: &str = "crates/kaustik-mcmc/src/decide.rs";

/// Files in which something else is decided by a coin.
const OTHER_COINS: &[(&str, &str)] = &[
    (
        "crates/kaustik-mcmc/src/kernel.rs",
        "whether a point takes a large step",
    ),
    (
        "crates/kaustik-mcmc/src/redistribute/rounding.rs",
        "whether a start has one chain more",
    ),
];

/// How a coin is thrown. The second is a coin in disguise: a known probability must go
/// through `bernoulli`, or the exact transition matrix of a kernel cannot be had.
const COINS: &[&str] = &[
    ".bernoulli(",
    ".uniform() <",
    ".uniform() >",
    ".random_bool(",
];

/// Where what a coin is, is said: by comparing a uniform number.
const COIN: &str = "crates/kaustik-mcmc/src/draws.rs";

fn may_throw(path: &str) -> bool {
    path == DECISION || path == COIN || OTHER_COINS.iter().any(|(file, _)| *file == path)
}

fn coins(source: &Source) -> Vec<String> {
    let thrown = COINS.iter().flat_map(|coin| {
        let lines = lines_with(&source.code, coin).into_iter();
        lines.map(move |line| format!("{}:{line}: `{coin}`", source.path))
    });
    thrown.filter(|_| !may_throw(&source.path)).collect()
}

/// Definitions of the formula and of the decision.
fn definitions(sources: &[Source], signature: &str) -> Vec<String> {
    let with = sources
        .iter()
        .filter(|s| !lines_with(&s.code, signature).is_empty());
    with.map(|s| s.path.clone()).collect()
}

#[test]
fn coins_are_thrown_where_this_file_says() {
    let faults: Vec<String> = sources().iter().flat_map(coins).collect();
    let say = "a coin outside of the decision; call kaustik_mcmc, or name the file here";
    assert!(faults.is_empty(), "{say}:\n{}", faults.join("\n"));
}

#[test]
fn the_decision_stands_in_one_place() {
    let sources = sources();
    assert_eq!(definitions(&sources, "pub fn acceptance("), [DECISION]);
    assert_eq!(definitions(&sources, "pub fn decide<"), [DECISION]);
    let decision = sources
        .iter()
        .find(|s| s.path == DECISION)
        .expect("the decision");
    assert_eq!(decision.crate_name, CRATE);
    assert_eq!(lines_with(&decision.code, ".bernoulli(").len(), 1);
}

/// A list of exceptions rots unless each one is still needed.
#[test]
fn no_exception_is_idle() {
    let sources = sources();
    for (file, what) in OTHER_COINS {
        let source = sources.iter().find(|s| s.path == *file);
        let thrown =
            source.is_some_and(|s| COINS.iter().any(|c| !lines_with(&s.code, c).is_empty()));
        assert!(thrown, "{file} no longer throws a coin ({what})");
        assert!(
            file.starts_with("crates/kaustik-mcmc/"),
            "{file} is not in {CRATE}"
        );
    }
}

#[test]
fn a_planted_decision_is_found() {
    let planted = |path: &str, code: &str| Source {
        path: path.to_owned(),
        crate_name: "kaustik".to_owned(),
        code: code.to_owned(),
    };
    let own = planted("crates/kaustik/src/render.rs", "if draws.bernoulli(a) {\n}");
    let disguised = planted("crates/kaustik/src/render.rs", "if rng.uniform() < a {}");
    assert_eq!(
        coins(&own),
        ["crates/kaustik/src/render.rs:1: `.bernoulli(`"]
    );
    assert_eq!(coins(&disguised).len(), 1);
    assert_eq!(coins(&planted(DECISION, "draws.bernoulli(a)")).len(), 0);
    let twice = [
        planted("a.rs", "pub fn decide<D>() {}"),
        planted("b.rs", "pub fn decide<D>() {}"),
    ];
    assert_eq!(definitions(&twice, "pub fn decide<").len(), 2);
}
