//! Contributions that are not finite, planted by lamps at the end of single precision: listed by renders, found again by replays.

use std::path::Path;

use serde_json::Value;

use crate::extremes::room;
use crate::words::{kaustik, path, refused};

pub(crate) fn shown(words: &[&str]) -> String {
    shown_and_said(words).0
}

/// Standard output and standard error.
fn shown_and_said(words: &[&str]) -> (String, String) {
    let output = kaustik(words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{words:?}: {said}");
    (String::from_utf8(output.stdout).expect("text"), said)
}

/// A render in a room, all but the budget.
struct Case {
    method: &'static str,
    room: String,
    more: &'static [&'static str],
    /// What its places begin with.
    places: &'static str,
}

/// A lamp of this radiance in a room of this size.
fn case(method: &'static str, room: String, more: &'static [&'static str]) -> Case {
    Case {
        method,
        room,
        more,
        places: "",
    }
}

/// Of each method one whose contributions are not finite now and then.
fn cases() -> Vec<Case> {
    // What walks from this lamp carry overflows.
    let large = || room("1e30", 1e5);
    // The light of some wavelengths does.
    let bright = || room("1.5e38", 1.0);
    // What the lamp itself emits at some wavelengths does.
    let brightest = || room("1.9e38", 1.0);
    // What photons bring to some points does.
    let photons = || room("2.5e37", 1.0);
    let mut cases = vec![
        case("light", large(), &[]),
        case("bdpt", large(), &[]),
        case("pssmlt", large(), &["pilot=2000", "builder=bidirectional"]),
        case("relt", bright(), &["direct=together"]),
        // Chains of `mlt` start at sound paths, and their products are kept in range: it has lamps alone, below.
        case("erpt", brightest(), &["direct=together"]),
        case("annealing", large(), &["particles=1000"]),
        case("sppm", photons(), &["photons=20000"]),
        case(
            "photon-visibility",
            photons(),
            &["photons=5000", "pilot=1000"],
        ),
        // Two ladders.
        case(
            "photon-visibility",
            photons(),
            &["photons=130000", "pilot=1000"],
        ),
        case("photon-density", photons(), &["photons=5000", "pilot=1000"]),
        case(
            "photon-spatial",
            photons(),
            &["photons=5000", "pilot=1000", "burnin=64"],
        ),
        case("photon-image", photons(), &["photons=5000", "pilot=1000"]),
    ];
    for method in ["pssmlt", "mmlt", "relt", "mlt", "annealing"] {
        cases.push(Case {
            places: "lamps:",
            // Of a lamp less bright, what camera rays leave out is seen from its own side.
            ..case(method, brightest(), &["particles=1000"])
        });
    }
    cases
}

/// How many contributions a render has left out, and the places that it tells.
fn places(stats: &str) -> (u64, Vec<String>) {
    let text = std::fs::read_to_string(stats).expect("statistics");
    let stats: Value = serde_json::from_str(&text).expect("JSON");
    let stats = &stats["statistics"];
    let places = stats["nonfinite_places"].as_array().expect("places");
    let part = |value: &Value| match value.as_str() {
        Some(word) => word.to_owned(),
        None => value.to_string(),
    };
    let place = |place: &Value| format!("{}:{}", part(&place["ladder"]), part(&place["step"]));
    let count = stats["nonfinite"].as_u64().expect("a count");
    (count, places.iter().map(place).collect())
}

impl Case {
    fn words<'a>(&self, file: &'a str) -> Vec<&'a str>
    where
        Self: 'a,
    {
        std::fs::write(file, &self.room).expect("a file");
        let mut words = vec![file, "--method", self.method, "--width", "16"];
        words.extend(["--height", "16", "--seed", "3", "--max-depth", "4"]);
        words.extend(["--set", "ladders=4"]);
        for set in self.more {
            // Settings of other methods are refused.
            if !set.starts_with("particles") || ["relt", "annealing"].contains(&self.method) {
                words.extend(["--set", set]);
            }
        }
        words
    }
}

/// Faults are the same on any number of threads, and a replay on any number of them finds them where they were reported.
#[test]
fn faults_are_listed_and_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (room, stats, lines) = (file("room.gltf"), file("stats.json"), file("lines.gltf"));
    for case in cases() {
        let method = case.method;
        let words = case.words(&room);
        let render = |threads: &str| {
            let budget = match method {
                "mlt" => "64",
                "sppm" => "1",
                _ if method.starts_with("photon") => "4",
                _ => "16",
            };
            let more = ["--spp", budget, "--threads", threads, "--stats", &stats];
            let (_, said) = shown_and_said(&[&["render"], &words[..], &more].concat());
            (places(&stats), said)
        };
        let ((count, places), said) = render("1");
        assert_eq!((count, &places), (render("3").0.0, &render("3").0.1));
        assert!(count >= places.len() as u64, "{method}");
        let places = places.iter().filter(|place| place.starts_with(case.places));
        let places: Vec<_> = places.collect();
        assert!(!places.is_empty() && places.len() <= 32, "{method}: {said}");
        for (index, place) in [places[0], places[places.len() - 1]]
            .into_iter()
            .enumerate()
        {
            let at = format!("3:{place}");
            let threads = ["1", "3"][index];
            let more = ["--at", &at, "--gltf", &lines, "--threads", threads];
            let text = shown(&[&["replay"], &words[..], &more].concat());
            let found = text.contains("not finite\n") || text.contains("not finite, left out");
            assert!(found, "{method} {place}: {text}");
            let drawn = std::fs::read_to_string(&lines).expect("lines");
            let drawn: Value = serde_json::from_str(&drawn).expect("JSON");
            let mode = &drawn["meshes"][0]["primitives"][0]["mode"];
            assert_eq!(mode, 3, "{method} {place}: {text}");
        }
    }
}

/// A render that reports faults says what shows them, and that does: from its words and from its state.
#[test]
fn a_reported_fault_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (room, state, stats) = (file("room.gltf"), file("s"), file("stats.json"));
    for case in cases().iter().take(3) {
        let method = case.method;
        let words = case.words(&room);
        let more = ["--spp", "4", "--stats", &stats, "--checkpoint", &state];
        let (_, said) = shown_and_said(&[&["render"], &words[..], &more].concat());
        let short = &places(&stats).1[0];
        let at = format!("3:{short}");
        assert!(said.contains(&format!("--at {at}")), "{said}");
        let text = shown(&[&["replay"], &words[..], &["--at", &at]].concat());
        assert!(text.contains("left out at raster"), "{method}: {text}");
        assert_eq!(text, shown(&["replay", &state, "--at", short]), "{method}");
    }
    refused(
        &["replay", &state, "--at", "9:0:0"],
        &["seed is 3 in the state, 9"],
    );
    refused(&["replay", &state, "--at", "4:0"], &["the ladder is 4"]);
    refused(&["replay", "builtin:cornell"], &["--at"]);
    refused(
        &[
            "replay",
            "builtin:cornell",
            "--method",
            "path",
            "--at",
            "lamps:0",
        ],
        &["the ladder is lamps", "beside its chains"],
    );
    let nowhere = file("nowhere/a.gltf");
    refused(
        &[
            "replay",
            "builtin:cornell",
            "--at",
            "0:0",
            "--gltf",
            &nowhere,
        ],
        &["nowhere"],
    );
}

/// Iterations before the one that is shown are run again, and it is said how many; those that a state has behind it are not.
#[test]
fn a_state_spares_iterations() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (room, state) = (file("room.gltf"), file("s"));
    for case in cases() {
        if case.method != "photon-visibility" || !case.more.contains(&"photons=5000") {
            continue;
        }
        let words = case.words(&room);
        // A step of the fourth iteration; the first number is the seed.
        let shown_at = |at: &str| {
            let (text, said) = shown_and_said(&[&["replay"], &words[..], &["--at", at]].concat());
            (number(&text, "iteration "), text, said)
        };
        let steps = (0..64).map(|number| format!("3:0:{}", 500 * number));
        let mut steps = steps.skip_while(|at| shown_at(at).0 < 3);
        let last = &steps.next().expect("a step");
        let at = ["--at", last.as_str()];
        let (iteration, text, said) = shown_at(last);
        assert_eq!(iteration, 3, "{text}");
        assert!(
            said.contains(&format!("{iteration} of them run first")),
            "{said}"
        );
        for (spp, left) in [("1", iteration - 1), ("2", iteration - 2), ("4", iteration)] {
            let _ = std::fs::remove_file(Path::new(&state));
            let more = ["--spp", spp, "--checkpoint", &state];
            shown(&[&["render"], &words[..], &more].concat());
            let resumed = [&["replay"], &words[..], &at, &["--resume", &state]].concat();
            for words in [&resumed[..], &["replay", &state, "--at", last]] {
                let (again, said) = shown_and_said(words);
                assert_eq!(again, text);
                assert!(
                    said.contains(&format!("{left} of them run first")) || left == 0,
                    "{spp}: {said}"
                );
                assert!(left > 0 || !said.contains("run first"), "{said}");
            }
        }
        // Of another render.
        let other = [&["replay"], &words[..], &at, &["--resume", &state]].concat();
        refused(
            &[&other[..], &["--set", "radius=2"]].concat(),
            &["radius", "2"],
        );
    }
}

/// The number behind a word.
fn number(text: &str, word: &str) -> u64 {
    let (_, rest) = text.split_once(word).expect("the word");
    let digits = rest.split(|c: char| !c.is_ascii_digit()).next();
    digits.expect("digits").parse().expect("a number")
}
