//! The command and its states: checkpoints, kills, merges, disks that are full, folders that go away.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;
use std::time::{Duration, Instant};

use kaustik::Method;
use kaustik::film::{Keep, Limits, read};

use crate::child::{ENDLESS, begin, signal, wait_for};
use crate::words::{kaustik, path, refused};

/// Words of a small render of a method, with more.
pub(crate) fn words<'a>(method: &'a str, spp: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    words_of("builtin:cornell", method, spp, more)
}

/// The same in another scene.
fn words_of<'a>(scene: &'a str, method: &'a str, spp: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut words = vec!["render", scene, "--method", method];
    words.extend(["--width", "24", "--spp", spp, "--max-depth", "6"]);
    match method {
        "path" | "light" | "bdpt" => {}
        "relt" | "annealing" => words.extend(["--set", "particles=1000"]),
        "sppm" => words.extend(["--set", "photons=2000"]),
        method if method.starts_with("photon") => {
            words.extend(["--set", "photons=2000", "--set", "pilot=2000"]);
        }
        _ => words.extend(["--set", "pilot=2000"]),
    }
    words.extend(more);
    words
}

/// Names of all methods.
fn methods() -> Vec<&'static str> {
    Method::ALL.into_iter().map(Method::name).collect()
}

pub(crate) fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn done(words: &[&str]) -> String {
    let output = kaustik(words);
    assert!(output.status.success(), "{words:?}: {}", told(&output));
    assert!(output.stdout.is_empty());
    told(&output)
}

/// All layers, to the bit.
pub(crate) fn picture(file: &str) -> BTreeMap<String, Vec<u32>> {
    let image = read(Path::new(file), &Limits::default(), Keep::All).expect("a picture");
    let layers = image.layers().iter().map(|layer| {
        let samples = layer.channels.iter().flat_map(|channel| &channel.samples);
        (layer.name.clone(), samples.map(|v| v.to_bits()).collect())
    });
    layers.collect()
}

#[test]
fn a_render_goes_on_where_it_was_and_on_to_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, part, whole, through) = (
        file("s"),
        file("part.exr"),
        file("whole.exr"),
        file("through.exr"),
    );
    for method in methods() {
        // rounds of annealing are long
        let [few, more] = if method == "annealing" {
            ["30", "40"]
        } else {
            ["3", "6"]
        };
        let said = done(&words(method, few, &["-o", &part, "--checkpoint", &state]));
        assert!(said.contains("1 states in"), "{said}");
        let resumed = done(&words(
            method,
            more,
            &["-o", &whole, "--resume", &state, "--threads", "3"],
        ));
        done(&words(method, more, &["-o", &through]));
        assert!(picture(&whole) == picture(&through), "{method}");
        assert!(picture(&whole) != picture(&part), "{method}");
        // Of less than there is it says so.
        let less = done(&words(method, "1", &["-o", &whole, "--resume", &state]));
        assert!(picture(&whole) == picture(&part), "{method}");
        let told = [resumed, less].map(|said| said.contains("more than was asked for"));
        assert_eq!(told, [false, true], "{method}");
    }
}

#[test]
fn shares_are_merged() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (a, b, c) = (file("a"), file("b"), file("c"));
    let (all, one, on) = (file("all.exr"), file("one.exr"), file("on.exr"));
    for method in methods() {
        let has_shares = method.parse().is_ok_and(Method::has_shares);
        if !has_shares {
            continue;
        }
        done(&words(
            method,
            "4",
            &["--ladders", "0..20", "--checkpoint", &a],
        ));
        done(&words(
            method,
            "4",
            &["--ladders", "20..64", "--checkpoint", &b],
        ));
        done(&["merge", &a, &b, "-o", &all, "--state", &c]);
        done(&words(method, "4", &["-o", &one]));
        let mut merged = picture(&all);
        // Bands of the image say nothing of each other, nor do those of direct light beside other chains; one round of annealing is one share's.
        let told = matches!(method, "light" | "relt");
        assert_eq!(merged.remove("error").is_some(), told, "{method}");
        assert!(merged == picture(&one), "{method}");
        // The state of the whole goes on as the whole.
        done(&words(method, "6", &["-o", &on, "--resume", &c]));
        done(&words(method, "6", &["-o", &one]));
        assert!(picture(&on) == picture(&one), "{method}");
    }
    refused(&["merge", &a, &a, "-o", &all], &["0..20 and 0..20 overlap"]);
    let png = file("all.png");
    done(&["merge", &b, &a, "--png", &png, "--scene", "builtin:cornell"]);
    refused(
        &["merge", &a, &b, "--png", &png, "--scene", "builtin:furnace"],
        &["scene's content is"],
    );
    refused(&["merge", &a, &png, "-o", &all], &[&png, "no state file"]);
}

#[test]
fn what_cannot_go_on_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, cut) = (file("s"), file("cut"));
    done(&words("path", "1", &["--checkpoint", &state]));
    let resume = ["--resume", state.as_str()];
    let with = |more: &[&'static str]| [&resume[..], more].concat();
    refused(
        &words("path", "2", &with(&["--seed", "3"])),
        &["seed is 0 in the state, 3 here"],
    );
    refused(
        &words("light", "2", &resume),
        &["method is path in the state, light here"],
    );
    refused(
        &words("sppm", "2", &["--ladders", "0..3"]),
        &["all of them: the iterations", "other seeds can be merged"],
    );
    refused(
        &words("path", "2", &with(&["--environment", "0.5"])),
        &["scene's content is"],
    );
    let missing = file("missing");
    refused(
        &words("path", "2", &["--resume", &missing]),
        &[&missing, "cannot be read"],
    );
    let mut bytes = fs::read(&state).expect("the state");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&cut, bytes).expect("a file");
    refused(
        &words("path", "2", &["--resume", &cut]),
        &[&cut, "damaged", "checksum"],
    );
    let nowhere = file("nowhere/s");
    refused(
        &words("path", "2", &["--checkpoint", &nowhere]),
        &["nowhere"],
    );
    refused(
        &words("path", "2", &["--checkpoint-every", "5s"]),
        &["--checkpoint"],
    );
}

/// Killed at any moment, a render loses at most an interval, and what it goes on to is what it would have been. Tells how
/// often it was resumed.
fn killed(scene: &str, method: &str, times: u64) -> u64 {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, through, whole) = (file("s"), file("through.exr"), file("whole.exr"));
    let spp = "400";
    let start = Instant::now();
    done(&words_of(scene, method, spp, &["-o", &through]));
    // Kills come all over the time that a render takes, most of them early.
    let length = (start.elapsed().as_millis() as u64).clamp(100, 2_000);
    let mut resumed = 0;
    for time in 0..times {
        let mut more = vec![
            "--checkpoint",
            &state,
            "--checkpoint-every",
            "1ms",
            "-o",
            &whole,
        ];
        if Path::new(&state).exists() {
            more.extend(["--resume", &state]);
            resumed += 1;
        }
        let mut child = begin(&words_of(scene, method, spp, &more));
        if time == 0 {
            wait_for(&state, None);
        }
        // Any moment, the first ones included.
        std::thread::sleep(Duration::from_millis(20 + time * 7919 % length));
        child.kill().expect("SIGKILL");
        child.wait().expect("it ends");
    }
    assert!(resumed > 0, "{method}: no state was left behind");
    done(&words_of(
        scene,
        method,
        spp,
        &["--resume", &state, "-o", &whole],
    ));
    assert!(picture(&whole) == picture(&through), "{scene} {method}");
    resumed
}

/// Two scenes: diffuse walls, and glass that light passes.
const SCENES: [&str; 2] = ["builtin:cornell", "builtin:glass-cube?light=0.8"];

#[test]
fn killed_renders_go_on() {
    for method in ["path", "mlt", "photon-spatial"] {
        killed(SCENES[0], method, 2);
    }
    killed(SCENES[1], "relt", 2);
}

/// All methods, or those that `KAUSTIK_METHODS` names.
#[test]
#[ignore = "hours"]
fn renders_that_are_killed_a_hundred_times_go_on() {
    let chosen = std::env::var("KAUSTIK_METHODS").ok();
    let chosen = |method: &str| {
        let names = chosen.as_ref();
        names.is_none_or(|names| names.split(',').any(|name| name == method))
    };
    for scene in SCENES {
        for method in methods().into_iter().filter(|method| chosen(method)) {
            let resumed = killed(scene, method, 100);
            eprintln!("{scene} {method}: resumed {resumed} times, equal");
        }
    }
}

#[test]
fn a_full_disk_is_said_and_the_render_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let exr = path(folder.path(), "a.exr");
    let more = [
        "--checkpoint",
        "/dev/full",
        "--checkpoint-every",
        "1ms",
        "-o",
        &exr,
    ];
    let output = kaustik(&words("path", "40", &more));
    let said = told(&output);
    assert!(said.contains("could not be written: /dev/full"), "{said}");
    assert!(said.contains("the render goes on"), "{said}");
    assert!(said.contains("error: the last state"), "{said}");
    assert_eq!(output.status.code(), Some(1), "{said}");
    let through = path(folder.path(), "b.exr");
    done(&words("path", "40", &["-o", &through]));
    assert!(picture(&exr) == picture(&through));
}

/// The folder goes away and comes back: the last good state stays, and the next one is written.
#[test]
fn a_folder_that_goes_away_costs_a_state_at_most() {
    let folder = tempfile::tempdir().expect("a folder");
    let (there, away) = (folder.path().join("there"), folder.path().join("away"));
    fs::create_dir(&there).expect("a folder");
    let state = path(&there, "s");
    let more = ["--checkpoint", &state, "--checkpoint-every", "50ms"];
    let child = begin(&words("pssmlt", ENDLESS, &more));
    wait_for(&state, None);
    fs::rename(&there, &away).expect("a move");
    let kept = path(&away, "s");
    std::thread::sleep(Duration::from_millis(800));
    kaustik::State::read(Path::new(&kept)).expect("the last good state");
    fs::rename(&away, &there).expect("a move");
    let old = fs::metadata(&state).expect("the state");
    wait_for(&state, Some(&old));
    signal(&child, "TERM");
    let output = child.wait_with_output().expect("it ends");
    let said = told(&output);
    assert_eq!(output.status.code(), Some(143), "{said}");
    assert!(
        said.contains("does not exist") && said.contains("the render goes on"),
        "{said}"
    );
    assert!(said.contains("states could not be written"), "{said}");
    assert!(!said.contains("error: the last state"), "{said}");
    kaustik::State::read(Path::new(&state)).expect("the last state");
    // Nothing is left lying about.
    assert_eq!(fs::read_dir(&there).expect("a folder").count(), 1);
}
