use std::path::Path;

use super::*;

const GOOD: &str = r#"
title = "A <study>"
width = 16
height = 12
seeds = [0, 1]

[budget]
per_pixel = [1, 2]

[reference]
method = "path"
per_pixel = 4
error = 0.1

[[scene]]
scene = "builtin:cornell"
close_ups = [[0, 0, 4, 4]]

[[method]]
method = "pssmlt"
name = "5 %"
set = ["mutation=uniform:0.05"]
"#;

fn parse(text: &str) -> Result<Study, String> {
    Study::parse(text, "s.toml", Path::new("")).map_err(|e| e.to_string())
}

#[test]
fn a_good_file_is_read() {
    let study = parse(GOOD).unwrap();
    assert_eq!((study.width, study.height, study.max_depth), (16, 12, 64));
    assert_eq!(study.budgets.unit, Unit::PerPixel);
    assert_eq!(study.methods[0].name, "5 %");
    assert!(study.matched.is_empty());
    let matched = GOOD.replace("seeds", "matched = [\"5 %\"]\nseeds");
    assert_eq!(parse(&matched).unwrap().matched, ["5 %"]);
    assert_eq!(study.scenes[0].name, "builtin:cornell");
    assert_eq!(study.scenes[0].close_ups[0].area(), 16);
    assert_eq!(study.last_budget(), "2 samples a pixel");
    let own = parse(&(GOOD.to_owned() + "amounts = [3, 4]")).unwrap();
    assert_eq!(own.last_budget(), "2 samples a pixel (5 % 4)");
}

#[test]
fn settings_that_contradict_each_other_are_refused_before_anything_is_rendered() {
    for (method, set, expected) in [
        (
            "pssmlt",
            r#"["builder=bidirectional", "nextevent=off"]"#,
            "nextevent",
        ),
        ("annealing", r#"["replicas=sides"]"#, "climb a line"),
    ] {
        let more = format!("[[method]]\nmethod = \"{method}\"\nset = {set}\n");
        let error = parse(&(GOOD.to_owned() + &more)).unwrap_err();
        // with the file, and what is wrong in it
        assert!(
            error.contains(expected) && error.starts_with("s.toml"),
            "{error}"
        );
    }
}

#[test]
fn wrong_words_are_refused_with_their_place() {
    let cases = [
        (
            "seeds",
            "matched = [\"6 %\"]\nseeds",
            "s.toml: matched '6 %'",
            "name of a method",
        ),
        ("width = 16", "wdith = 16", "s.toml:3:1", "wdith"),
        ("width = 16", "width = \"wide\"", "s.toml:3:9", "u32"),
        (
            "\"pssmlt\"",
            "\"pssmtl\"",
            "s.toml:20:10",
            "known are: path",
        ),
        (
            "mutation=uniform:0.05",
            "mutation=wide",
            "s.toml:22:8",
            "kelemen",
        ),
        ("mutation=", "colour=", "s.toml:22:8", "plarge"),
        (
            "builtin:cornell",
            "builtin:cornel",
            "s.toml:16:9",
            "glass-cube",
        ),
        ("builtin:cornell", "no/such.glb", "s.toml:16:9", "no file"),
        ("per_pixel = [1, 2]", "", "s.toml:7:1", "expected one of"),
        (
            "per_pixel = [1, 2]",
            "per_pixel = [2, 1]",
            "s.toml: budget",
            "rising",
        ),
        (
            "name = \"5 %\"",
            "name = \"5 %\"\namounts = [1]",
            "s.toml: method '5 %'",
            "as many",
        ),
        (
            "name = \"5 %\"",
            "name = \"5 %\"\namounts = [2, 1]",
            "s.toml: method '5 %'",
            "rising",
        ),
        (
            "per_pixel = [1, 2]",
            "per_pixel = [1.5]",
            "s.toml: budget",
            "whole",
        ),
        (
            "per_pixel = [1, 2]",
            "wall = [nan]",
            "s.toml: budget",
            "above 0",
        ),
        (
            "seeds = [0, 1]",
            "seeds = [1, 1]",
            "s.toml: seeds",
            "different",
        ),
        ("[0, 0, 4, 4]", "[0, 0, 4, 40]", "close-ups", "within"),
        (
            "error = 0.1",
            "error = nan",
            "s.toml: reference",
            "error > 0",
        ),
        ("height = 12", "height = 0", "s.toml: width", "1 to 4096"),
        ("\"5 %\"", "\"5\\u0000\"", "s.toml: method", "control"),
        ("[[scene]]", "[[scene", "s.toml:15", ""),
    ];
    for (from, to, place, expected) in cases {
        let text = GOOD.replacen(from, to, 1);
        assert_ne!(text, GOOD, "{from} is there");
        let message = parse(&text).unwrap_err();
        assert!(message.contains(place), "{to}: {message}");
        assert!(message.contains(expected), "{to}: {message}");
    }
    let twice = GOOD.replace(
        "[[method]]",
        "[[method]]\nmethod=\"path\"\nname=\"5 %\"\n[[method]]",
    );
    assert!(parse(&twice).unwrap_err().contains("different names"));
}

#[test]
fn every_beginning_of_a_file_is_survived() {
    for end in 0..GOOD.len() {
        if let Some(part) = GOOD.get(..end) {
            let _ = parse(part);
        }
    }
    let error = Study::load(Path::new("/")).unwrap_err().to_string();
    assert!(error.contains("expected a file"), "{error}");
}
