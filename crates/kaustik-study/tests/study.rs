//! Whole studies: cut and resumed, spoilt and mended, by samples and by time.

#![allow(
    clippy::unwrap_used,
    reason = "a test's helper may do what the test may"
)]

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use kaustik::Method;
use kaustik::film::Image;
use kaustik::film::metrics::{difference, matched, measure};
use kaustik_study::{
    Clock, Curve, Figure, MethodEntry, Results, Runner, Section, Study, StudyError, StudyProgress,
    WallClock, write,
};

/// Time that stands still, so that files do not tell one run from another.
struct Frozen;

impl Clock for Frozen {
    fn seconds(&self) -> f64 {
        0.0
    }
}

fn study(budget: &str) -> Study {
    let text = format!(
        r#"
        title = "small <b>&\"'"
        width = 16
        height = 16
        threads = 1
        max_depth = 6
        seeds = [0, 1]
        budget = {{ {budget} }}
        reference = {{ method = "path", per_pixel = 32, error = 0.3, most = 4 }}
        [[scene]]
        name = "box <script>alert(1)</script>"
        scene = "builtin:cornell"
        close_ups = [[2, 2, 8, 8]]
        [[method]]
        name = "</td><script>"
        method = "pssmlt"
        set = ["pilot=2000", "ladders=4"]
        [[method]]
        method = "path"
        "#
    );
    Study::parse(&text, "small.toml", Path::new("")).unwrap()
}

fn run(
    study: &Study,
    folder: &Path,
    listener: &mut dyn FnMut(&StudyProgress<'_>) -> ControlFlow<()>,
) -> Result<Results, StudyError> {
    Runner::new(study, folder).with_clock(&Frozen).run(listener)
}

/// All files of a report by name.
fn report(results: &Results, folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let section = Section {
        results,
        judged: &[],
    };
    write(folder, &results.study.title, &[("study", section)]).unwrap();
    let files = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    files
        .filter(|file| file.path().is_file())
        .map(|file| {
            let name = file.file_name().into_string().unwrap();
            (name, std::fs::read(file.path()).unwrap())
        })
        .collect()
}

fn cells(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder.join("cells")).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn a_study_that_was_cut_goes_on_to_the_same_bytes() {
    let study = study("per_pixel = [1, 2]");
    let whole = tempfile::tempdir().unwrap();
    let mut most = 0.0f64;
    let results = run(&study, whole.path(), &mut |progress| {
        assert!(progress.fraction >= most, "the bar never goes back");
        most = progress.fraction;
        ControlFlow::Continue(())
    });
    let expected = report(&results.unwrap(), whole.path());
    assert!((most - 1.0).abs() < 1e-12);
    assert!(expected.contains_key("index.html") && expected.contains_key("study-cells.csv"));
    assert!(expected.contains_key("study-summary.csv"));
    assert!(expected.contains_key("study-scene-1-nsd-samples.svg"));
    let html = String::from_utf8(expected["index.html"].clone()).unwrap();
    assert!(
        !html.contains("<script") && html.contains("&lt;script&gt;"),
        "names are escaped"
    );
    assert!(!html.contains("http://") || html.contains("http://www.w3.org/2000/svg"));
    assert!(!html.contains("https://") && html.contains("data:image/png;base64,"));
    let rows = String::from_utf8(expected["study-cells.csv"].clone()).unwrap();
    assert_eq!(rows.lines().count(), 1 + 2 * 2 * 2);

    let cut = tempfile::tempdir().unwrap();
    for stop in [0, 1, 3, 6] {
        let stopped = run(&study, cut.path(), &mut |progress| {
            if progress.finished >= stop {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        assert!(matches!(stopped, Err(StudyError::Stopped)));
    }
    let mut found = 0;
    let resumed = run(&study, cut.path(), &mut |progress| {
        found = progress.found;
        ControlFlow::Continue(())
    });
    assert_eq!(found, 6, "six renders were finished before");
    let resumed = report(&resumed.unwrap(), cut.path());
    for (name, bytes) in &expected {
        assert!(resumed[name] == *bytes, "{name}");
    }
    assert_eq!(resumed.len(), expected.len());
}

#[test]
fn what_is_spoilt_is_rendered_again() {
    let study = study("total = [300]");
    let folder = tempfile::tempdir().unwrap();
    let go = |found: &mut usize| {
        run(&study, folder.path(), &mut |progress| {
            *found = progress.found;
            ControlFlow::Continue(())
        })
        .unwrap()
    };
    let mut found = 0;
    let before = report(&go(&mut found), folder.path());
    assert_eq!(found, 0);
    go(&mut found);
    assert_eq!(found, 4);
    // each file of each render in turn: cut, changed in a byte, taken away
    for path in cells(folder.path()) {
        let bytes = std::fs::read(&path).unwrap();
        let mut changed = bytes.clone();
        changed[bytes.len() / 2] ^= 1;
        // still a good record, of another render; nothing of the kind stands in a picture
        let text = String::from_utf8_lossy(&bytes);
        let forged = text.replace("\"per_pixel\":", "\"per_pixel\":1");
        for spoilt in [&bytes[..bytes.len() / 2], &changed, &[], forged.as_bytes()] {
            std::fs::write(&path, spoilt).unwrap();
            let after = report(&go(&mut found), folder.path());
            assert!(after == before, "{}", path.display());
            // the small file tells how long it took, which is never the same
            let picture = path.extension().is_some_and(|kind| kind == "exr");
            assert!(!picture || std::fs::read(&path).unwrap() == bytes);
        }
    }
}

#[test]
fn other_settings_are_other_renders() {
    let first = study("total = [300]");
    let folder = tempfile::tempdir().unwrap();
    let mut found = 0;
    let mut go = |study: &Study| {
        run(study, folder.path(), &mut |progress| {
            found = progress.found;
            ControlFlow::Continue(())
        })
        .unwrap();
        found
    };
    assert_eq!(go(&first), 0);
    let mut other = first.clone();
    other.methods[0].settings.push("plarge=0.5".to_owned());
    assert_eq!(go(&other), 2, "path stays");
    // the name alone changes no picture
    other.methods[0].name = "another".to_owned();
    assert_eq!(go(&other), 4);
    other.max_depth = 5;
    assert_eq!(go(&other), 0);
}

#[test]
fn a_method_may_have_amounts_of_its_own() {
    // two at the least where direct light is rendered apart
    let mut study = study("per_pixel = [2, 4]");
    study.methods[1].amounts = Some(vec![3.0, 8.0]);
    let folder = tempfile::tempdir().unwrap();
    let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
    let found = results.scenes[0].groups.iter().map(|g| g.per_pixel());
    assert_eq!(found.collect::<Vec<f64>>(), [2.0, 4.0, 3.0, 8.0]);
    let files = report(&results, folder.path());
    let summary = String::from_utf8(files["study-summary.csv"].clone()).unwrap();
    assert!(summary.contains(",path,8,samples a pixel,2,"), "{summary}");
    let page = String::from_utf8(files["index.html"].clone()).unwrap();
    assert!(page.contains("At 4 samples a pixel (path 8)"));
}

#[test]
fn a_study_by_time_looks_at_one_render() {
    let study = study("wall = [0.2, 0.6]");
    let folder = tempfile::tempdir().unwrap();
    let clock = WallClock::default();
    let runner = Runner::new(&study, folder.path()).with_clock(&clock);
    let results = runner.run(&mut |_| ControlFlow::Continue(())).unwrap();
    for group in &results.scenes[0].groups {
        for cell in &group.cells {
            let wanted = study.budgets.amounts[group.budget];
            assert!(
                cell.seconds >= wanted && cell.seconds < wanted + 2.0,
                "{}",
                cell.seconds
            );
            assert!(cell.per_pixel > 0.0);
        }
    }
    for method in 0..2 {
        let at = |budget| results.scenes[0].group(method, budget).unwrap();
        assert!(at(1).per_pixel() > at(0).per_pixel());
        assert!(at(0).quartiles(Figure::RelativeMse).median > 0.0);
    }
}

/// Time that passes with every question of the runner's, and much faster while a picture is written.
struct Slow<'a> {
    folder: &'a Path,
    questions: &'a AtomicU64,
}

impl Clock for Slow<'_> {
    fn seconds(&self) -> f64 {
        let written = cells(self.folder).len();
        0.1 * self.questions.load(Ordering::Relaxed) as f64 + 100.0 * written as f64
    }
}

/// A look is taken at its time, and what looking costs is not the method's.
#[test]
fn looks_are_taken_in_time_and_cost_nothing() {
    let study = study("wall = [0.25, 0.65]");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("cells")).unwrap();
    let questions = AtomicU64::new(0);
    let clock = Slow {
        folder: folder.path(),
        questions: &questions,
    };
    let runner = Runner::new(&study, folder.path()).with_clock(&clock);
    let results = runner.run(&mut |_| {
        questions.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    for group in &results.unwrap().scenes[0].groups {
        let wanted = study.budgets.amounts[group.budget];
        for cell in &group.cells {
            let late = cell.seconds - wanted;
            assert!((0.0..0.1).contains(&late), "{} for {wanted}", cell.seconds);
        }
    }
}

/// The page shows the first seed's picture at the last budget, and it is the one that was measured.
#[test]
fn pictures_shown_are_those_measured() {
    let study = study("per_pixel = [1, 8]");
    let folder = tempfile::tempdir().unwrap();
    let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
    let scene = &results.scenes[0];
    let reference = scene.reference.reference();
    assert!(reference.half().is_some(), "its own noise cancels");
    for shown in &scene.shown {
        let cell = &scene.group(shown.method, 1).unwrap().cells[0];
        assert_eq!(shown.seed, cell.seed);
        let again = measure(&shown.image, &reference).unwrap();
        assert_eq!(again, cell.measured);
        let again = matched(&shown.image, &reference).unwrap();
        assert_eq!(again, cell.matched);
        assert!(cell.matched != cell.measured);
    }
}

/// The map of NSD is that of the last budget: its mean is the figure in the table. One seed has none.
#[test]
fn the_page_has_nsd_as_a_map_and_as_a_curve() {
    let mut study = study("per_pixel = [1, 8]");
    let folder = tempfile::tempdir().unwrap();
    let mut go = |seeds: &[u64]| {
        study.seeds = seeds.to_vec();
        let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
        let page = report(&results, folder.path())["index.html"].clone();
        (results, String::from_utf8(page).unwrap())
    };
    let (results, page) = go(&[0, 1]);
    assert_eq!(page.matches("alt=\"NSD of").count(), 2);
    assert!(page.contains("\nNSD\n"), "an axis");
    for shown in &results.scenes[0].shown {
        let group = results.scenes[0].group(shown.method, 1).unwrap();
        let nsd = group.nsd.unwrap();
        // every pixel of the box is lit
        assert_eq!(nsd.pixels, 16 * 16);
        let map = shown.nsd.as_ref().unwrap().iter();
        let mean = map.map(|&v| f64::from(v)).sum::<f64>() / 256.0;
        assert!((mean - nsd.mean).abs() < 1e-5 && mean > 0.0, "{mean}");
        assert_eq!(
            group.point(Curve::Nsd).unwrap().median.to_bits(),
            nsd.mean.to_bits()
        );
    }
    let (results, page) = go(&[0]);
    assert!(
        results.scenes[0]
            .shown
            .iter()
            .all(|shown| shown.nsd.is_none())
    );
    assert!(!page.contains("NSD of") && !page.contains("\nNSD\n"));
}

/// A picture that is shown matched has the reference's mean luminance, and its differences are taken so.
#[test]
fn matched_pictures_are_as_bright_as_the_reference() {
    let mut study = study("per_pixel = [1]");
    study.matched = vec!["path".to_owned()];
    let folder = tempfile::tempdir().unwrap();
    let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
    let scene = &results.scenes[0];
    let reference = scene.reference.reference();
    let [chain, path] = &scene.shown[..] else {
        panic!("two methods")
    };
    assert_eq!(chain.factor.to_bits(), 1.0f32.to_bits());
    assert_eq!(chain.on_page(), chain.image);
    assert!((path.factor - 1.0).abs() > 1e-4, "{}", path.factor);
    let bias = |image: &Image| measure(image, &reference).unwrap().raw.bias;
    assert!(bias(&path.on_page()).abs() < 1e-5 && bias(&path.image).abs() > 1e-4);
    let again = difference(&path.on_page(), &reference).unwrap();
    assert!(again == path.difference && difference(&path.image, &reference) != Some(again));
    let page = report(&results, folder.path())["index.html"].clone();
    let page = String::from_utf8(page).unwrap();
    assert_eq!(
        page.matches("at the reference&#x27;s brightness").count(),
        1
    );
}

/// What photon chains follow, and how often they come, is on the page as pictures.
#[test]
fn layers_that_are_no_colours_are_shown() {
    let mut study = study("total = [4000]");
    let set = ["photons=1000", "pilot=2000", "maps=on"];
    study.layers = true;
    study.methods = vec![MethodEntry::new("spatial", Method::PhotonSpatial, &set)];
    study.seeds = vec![0];
    let folder = tempfile::tempdir().unwrap();
    let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
    let page = report(&results, folder.path())["index.html"].clone();
    let page = String::from_utf8(page).unwrap();
    let shown = [
        "target, at most",
        "factor: inverse photon density",
        "factor: inverse kernel size",
        "regions: ",
        "contributions a point",
        "remainder",
    ];
    for name in shown {
        let picture = format!("alt=\"{name}");
        assert_eq!(page.matches(&picture).count(), 1, "{name}");
    }
    assert!(!page.contains("alt=\"albedo"));
}

/// Renders are added until their mean is known as well as was asked, or there are as many as may be.
#[test]
fn the_reference_is_rendered_to_its_error() {
    let mut study = study("per_pixel = [4]");
    let folder = tempfile::tempdir().unwrap();
    let mut go = |error: f64, most: u32| {
        study.reference.error = error;
        study.reference.most = most;
        let results = run(&study, folder.path(), &mut |_| ControlFlow::Continue(())).unwrap();
        results.scenes[0].reference.clone()
    };
    let rough = go(10.0, 16);
    assert_eq!(rough.renders, 2);
    let most = go(1e-6, 12);
    assert_eq!(most.renders, 12);
    assert!(most.error > most.wanted && most.error < rough.error);
    let asked = go(1.1 * most.error, 64);
    assert!(asked.error <= asked.wanted && asked.renders <= 12 && asked.renders > 2);
}
