//! The command and its states: checkpoints, signals, kills, merges, disks that are full, folders that go away.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use kaustik::Method;
use kaustik::film::{Keep, Limits, read};

use crate::words::{kaustik, path, refused};

/// Words of a small render of a method, with more.
fn words<'a>(method: &'a str, spp: &'a str, more: &[&'a str]) -> Vec<&'a str> {
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

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn done(words: &[&str]) -> String {
    let output = kaustik(words);
    assert!(output.status.success(), "{words:?}: {}", told(&output));
    assert!(output.stdout.is_empty());
    told(&output)
}

/// All layers, to the bit.
fn picture(file: &str) -> BTreeMap<String, Vec<u32>> {
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
            ["12", "40"]
        } else {
            ["2", "6"]
        };
        let said = done(&words(method, few, &["-o", &part, "--checkpoint", &state]));
        assert!(said.contains("1 states in"), "{said}");
        done(&words(
            method,
            more,
            &["-o", &whole, "--resume", &state, "--threads", "3"],
        ));
        done(&words(method, more, &["-o", &through]));
        assert!(picture(&whole) == picture(&through), "{method}");
        assert!(picture(&whole) != picture(&part), "{method}");
    }
}

#[test]
fn shares_are_merged() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (a, b, c) = (file("a"), file("b"), file("c"));
    let (all, one, on) = (file("all.exr"), file("one.exr"), file("on.exr"));
    for method in methods() {
        if method == "sppm" || method.starts_with("photon") {
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
        // Bands of the image say nothing of each other; one round of annealing is one share's.
        let told = matches!(method, "light" | "pssmlt" | "mmlt" | "relt" | "mlt");
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

/// A render that nobody waits for the end of.
fn begin(words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs")
}

fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill")
        .args(["-s", name, &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
}

/// Waits until a file is there; again and again for another one, if `old` is given.
fn wait_for(file: &str, old: Option<&fs::Metadata>) -> fs::Metadata {
    let start = Instant::now();
    loop {
        if let Ok(now) = fs::metadata(file) {
            let new = old.is_none_or(|old| old.modified().ok() != now.modified().ok());
            if new {
                return now;
            }
        }
        assert!(start.elapsed() < Duration::from_secs(60), "no {file}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// More samples than a test will wait for.
const ENDLESS: &str = "10000000";

#[test]
fn signals_write_state_and_image() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let (state, part) = (file(name), file("part.exr"));
        let more = [
            "--checkpoint",
            &state,
            "--checkpoint-every",
            "100ms",
            "-o",
            &part,
        ];
        let mut child = begin(&words("pssmlt", ENDLESS, &more));
        wait_for(&state, None);
        signal(&child, name);
        let sent = Instant::now();
        assert_eq!(child.wait().expect("it ends").code(), Some(status));
        assert!(sent.elapsed() < Duration::from_secs(10));
        assert!(!picture(&part).is_empty());
        // Picture and state are of one moment: resumed without anything left to do, the state is that picture.
        let again = file("again.exr");
        let small = ["--resume", &state, "-o", &again];
        done(&words("pssmlt", "1", &small));
        assert!(picture(&again) == picture(&part), "{name}");
    }
}

#[test]
fn hanging_up_writes_both_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, part) = (file("s"), file("part.exr"));
    let more = [
        "--checkpoint",
        &state,
        "--checkpoint-every",
        "150ms",
        "-o",
        &part,
    ];
    let mut child = begin(&words("pssmlt", ENDLESS, &more));
    wait_for(&state, None);
    assert!(!Path::new(&part).exists());
    signal(&child, "HUP");
    let first = wait_for(&part, None);
    signal(&child, "HUP");
    wait_for(&part, Some(&first));
    assert!(child.try_wait().expect("a child").is_none(), "it goes on");
    signal(&child, "TERM");
    assert_eq!(child.wait().expect("it ends").code(), Some(143));
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
    for method in ["path", "pssmlt", "mlt", "photon-spatial"] {
        killed(SCENES[0], method, 4);
    }
    killed(SCENES[1], "relt", 4);
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

/// Before the first sample there is nothing to write: a signal ends the render at once, and leaves nothing, not even a lock.
#[test]
fn a_signal_in_a_pilot_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (exr, lock) = (
        path(folder.path(), "a.exr"),
        path(folder.path(), ".a.exr.lock"),
    );
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let mut words = vec!["render", "builtin:cornell", "--method", "pssmlt"];
        words.extend(["--set", "pilot=10000000", "--threads", "1", "-o", &exr]);
        let child = begin(&words);
        wait_for(&lock, None);
        // Loading takes no time, the pilot many seconds.
        std::thread::sleep(Duration::from_millis(500));
        let sent = Instant::now();
        signal(&child, name);
        let output = child.wait_with_output().expect("it ends");
        assert!(sent.elapsed() < Duration::from_secs(2));
        assert_eq!(output.status.code(), Some(status));
        let said = told(&output);
        assert!(said.contains("before the first sample"), "{said}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }
}

/// A pass or iteration that a signal breaks off is taken back: the state is that of whole ones, or of none, and goes on to the
/// picture of a render that nothing interrupted.
#[test]
fn a_broken_pass_is_taken_back() {
    broken_passes("bdpt", "400", "heuristic=power");
    broken_passes("erpt", "48", "chains=1");
    broken_passes("photon-spatial", "64", "photons=200000");
}

fn broken_passes(method: &str, width: &str, set: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, whole, through) = (file("s"), file("whole.exr"), file("through.exr"));
    let words = |spp: &'static str, more: &[&str]| -> Vec<String> {
        let mut words = vec![
            "render",
            "builtin:cornell",
            "--method",
            method,
            "--spp",
            spp,
        ];
        words.extend([
            "--width",
            width,
            "--max-depth",
            "4",
            "--no-features",
            "--set",
            set,
        ]);
        words.extend(more);
        words.into_iter().map(str::to_owned).collect()
    };
    let run = |words: &[String]| done(&words.iter().map(String::as_str).collect::<Vec<_>>());
    run(&words("3", &["-o", &through]));
    let mut states = 0;
    for wait in [60, 300, 1500] {
        // As many passes as of the whole: a fast machine takes no more, and may be done before the signal.
        let part = words("3", &["--checkpoint", &state, "--threads", "1"]);
        let child = begin(&part.iter().map(String::as_str).collect::<Vec<_>>());
        std::thread::sleep(Duration::from_millis(wait));
        signal(&child, "INT");
        let output = child.wait_with_output().expect("it ends");
        let status = output.status.code();
        assert!(matches!(status, Some(0 | 130)), "{}", told(&output));
        if Path::new(&state).exists() {
            states += 1;
            run(&words("3", &["--resume", &state, "-o", &whole]));
            assert!(
                picture(&whole) == picture(&through),
                "{method} after {wait} ms"
            );
            fs::remove_file(&state).expect("a state");
        }
    }
    assert!(states > 0, "{method}");
}
