//! Planted faults: each line of [`tables::TABLES`] breaks the sources in one place, and the
//! tests that it names must fail.
//!
//! A test that cannot fail proves nothing. The campaign copies the crate beside the build
//! folder, plants one fault at a time, builds (a fault that does not compile is a fault of the
//! table) and runs the named tests; first it makes sure that they pass without any fault.
//!
//! ```sh
//! nice cargo test -p kaustik-mcmc --test faults -- --ignored --nocapture
//! FAULTS=pool nice cargo test -p kaustik-mcmc --test faults -- --ignored --nocapture
//! ```
//!
//! The second runs only faults whose name or file contains the word. Needs the workspace
//! (not the published package) and no network.

mod tables;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tables::TABLES;

/// One fault and who must find it.
pub(crate) struct Fault {
    /// What is wrong, in a few words.
    pub(crate) name: &'static str,
    /// The file, below `src/`.
    pub(crate) file: &'static str,
    /// A piece of the file that occurs in it exactly once.
    pub(crate) find: &'static str,
    /// What stands there instead.
    pub(crate) replace: &'static str,
    /// Tests that must fail, parted by spaces: paths in `tests/all/`, as
    /// `unbiased::the_guard_alone_is_unbiased`; in the crate itself with `lib:` before.
    pub(crate) caught_by: &'static str,
}

impl Fault {
    fn tests(&self) -> impl Iterator<Item = &'static str> {
        self.caught_by.split_whitespace()
    }

    /// The source with the fault in it.
    fn plant(&self, source: &str) -> Result<String, String> {
        match source.matches(self.find).count() {
            1 => Ok(source.replacen(self.find, self.replace, 1)),
            n => Err(format!(
                "{:?} occurs {n} times in src/{}",
                self.find, self.file
            )),
        }
    }
}

fn faults() -> impl Iterator<Item = &'static Fault> {
    TABLES.iter().copied().flatten()
}

/// The crate.
fn home() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn source(file: &str) -> String {
    fs::read_to_string(home().join("src").join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

/// The table is kept in order by every run of the tests: no fault is idle, no test is missing.
#[test]
fn the_table_fits_the_sources() {
    let mut wrong = Vec::new();
    let mut names = BTreeSet::new();
    for fault in faults() {
        wrong.extend(fault.plant(&source(fault.file)).err());
        wrong
            .extend((!names.insert(fault.name)).then(|| format!("two are named {:?}", fault.name)));
        for test in fault.tests().filter(|test| !exists(test)) {
            wrong.push(format!("{}: no test {test}", fault.name));
        }
        if fault.tests().next().is_none() || fault.find == fault.replace {
            wrong.push(format!("{}: no test or no fault", fault.name));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Whether a test of this name stands in the file that its path says.
fn exists(test: &str) -> bool {
    let (folder, path) = match test.strip_prefix("lib:") {
        Some(path) => ("src", path),
        None => ("tests/all", test),
    };
    let parts: Vec<&str> = path.split("::").filter(|part| *part != "tests").collect();
    let Some((name, modules)) = parts.split_last() else {
        return false;
    };
    let stem = home().join(folder).join(modules.join("/"));
    let files = [
        stem.with_extension("rs"),
        stem.join("tests.rs"),
        stem.join("mod.rs"),
    ];
    let texts = files
        .iter()
        .filter_map(|file| fs::read_to_string(file).ok());
    texts
        .into_iter()
        .any(|text| text.contains(&format!("fn {name}(")))
}

#[test]
#[ignore = "long"]
fn every_planted_fault_is_caught() {
    let only = std::env::var("FAULTS").unwrap_or_default();
    let chosen = |fault: &&Fault| fault.name.contains(&only) || fault.file.contains(&only);
    let faults: Vec<&Fault> = faults().filter(chosen).collect();
    assert!(!faults.is_empty(), "no fault is called {only:?}");

    let copy = Copy::new();
    let all: BTreeSet<&str> = faults.iter().flat_map(|fault| fault.tests()).collect();
    let all: Vec<&str> = all.into_iter().collect();
    let verdicts = copy.run(&all);
    assert_eq!(
        verdicts,
        Ok(vec![true; all.len()]),
        "without a fault: {all:?}"
    );

    let mut missed = Vec::new();
    println!("{:<50} {:<16} {:>6}  caught by", "fault", "file", "s");
    for fault in faults {
        let (verdict, seconds) = copy.try_fault(fault);
        println!(
            "{:<50} {:<16} {seconds:>6.1}  {verdict}",
            fault.name, fault.file
        );
        if verdict != fault.caught_by {
            missed.push(format!("{}: {verdict}", fault.name));
        }
    }
    assert!(missed.is_empty(), "not caught:\n{}", missed.join("\n"));
}

/// A copy of the crate, in a workspace of its own.
struct Copy {
    root: PathBuf,
}

impl Copy {
    fn new() -> Self {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("faults");
        let copy = Self { root };
        let workspace = home().join("../..");
        let manifest = fs::read_to_string(workspace.join("Cargo.toml"))
            .expect("faults are planted in the workspace, not in the published package");
        let members = "members = [\"crates/*\"]";
        assert!(
            manifest.contains(members),
            "the workspace lists its members anew"
        );
        fs::create_dir_all(&copy.root).expect("a folder for the copy");
        // The workspace's own manifest but for the speed of builds.
        let [test, lean] = [
            "[profile.test]\nopt-level = 2",
            "[profile.test]\nopt-level = 1\ndebug = false",
        ];
        let manifest = manifest.replace(test, lean);
        fs::write(copy.root.join("Cargo.toml"), manifest).expect("the copy's manifest");
        let lock = workspace.join("Cargo.lock");
        fs::copy(lock, copy.root.join("Cargo.lock")).expect("the lock file");
        for (name, parts) in [
            ("kaustik-pss", &["Cargo.toml", "README.md", "src"][..]),
            (
                "kaustik-mcmc",
                &["Cargo.toml", "README.md", "src", "tests", "examples"],
            ),
        ] {
            let to = copy.root.join("crates").join(name);
            let _ = fs::remove_dir_all(&to); // of an earlier run
            for part in parts {
                copy_all(
                    &workspace.join("crates").join(name).join(part),
                    &to.join(part),
                );
            }
            let manifest = to.join("Cargo.toml");
            let text = fs::read_to_string(&manifest).expect("a crate's manifest");
            fs::write(&manifest, without_benches(&text)).expect("the copy's manifest");
        }
        copy
    }

    /// What became of a fault: the tests that caught it, or why none did; and the time it took.
    fn try_fault(&self, fault: &Fault) -> (String, f64) {
        let began = Instant::now();
        let path = self.root.join("crates/kaustik-mcmc/src").join(fault.file);
        let right = source(fault.file);
        let wrong = fault.plant(&right).unwrap_or_else(|e| panic!("{e}"));
        fs::write(&path, wrong).expect("a source of the copy");
        let tests: Vec<&str> = fault.tests().collect();
        let verdict = match self.run(&tests) {
            Err(why) => why,
            Ok(passed) => {
                let failed = tests.iter().zip(passed).filter(|(_, passed)| !passed);
                let failed: Vec<&str> = failed.map(|(test, _)| *test).collect();
                if failed.is_empty() {
                    "NOTHING".into()
                } else {
                    failed.join(" ")
                }
            }
        };
        fs::write(&path, right).expect("a source of the copy");
        (verdict, began.elapsed().as_secs_f64())
    }

    /// Builds and runs tests; whether each passed.
    fn run(&self, tests: &[&str]) -> Result<Vec<bool>, String> {
        let (inner, outer): (Vec<&str>, Vec<&str>) =
            tests.iter().partition(|test| test.starts_with("lib:"));
        let mut said = String::new();
        for (target, names) in [(&["--lib"][..], inner), (&["--test", "all"], outer)] {
            if !names.is_empty() {
                let build = self.cargo(&[target, &["--no-run"]].concat())?;
                if !build.contains("Executable") {
                    return Err(format!("does not build:\n{build}"));
                }
                let names = names.iter().map(|name| name.trim_start_matches("lib:"));
                let run: Vec<&str> = target
                    .iter()
                    .copied()
                    .chain(["--", "--exact"])
                    .chain(names)
                    .collect();
                said += &self.cargo(&run)?;
            }
        }
        let outcome = |test: &&str| {
            let name = test.trim_start_matches("lib:");
            let ended = |how: &str| said.contains(&format!("test {name} ... {how}"));
            match (ended("ok"), ended("FAILED")) {
                (true, false) => Ok(true),
                (false, true) => Ok(false),
                _ => Err(format!("no outcome of {name}:\n{said}")),
            }
        };
        tests.iter().map(outcome).collect()
    }

    /// What `cargo test` said, on both channels.
    fn cargo(&self, arguments: &[&str]) -> Result<String, String> {
        let log = self.root.join("log");
        let file = fs::File::create(&log).map_err(|e| e.to_string())?;
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut child = Command::new(cargo)
            .args(
                ["test", "--offline", "--quiet", "-p", "kaustik-mcmc"]
                    .iter()
                    .filter(|a| **a != "--quiet"),
            )
            .args(arguments)
            .current_dir(&self.root)
            .env("CARGO_TARGET_DIR", self.root.join("target"))
            .env("CARGO_INCREMENTAL", "1")
            .env("CARGO_TERM_COLOR", "never")
            .env("RUST_BACKTRACE", "0")
            .env_remove("RUSTFLAGS")
            .stdin(Stdio::null())
            .stdout(file.try_clone().map_err(|e| e.to_string())?)
            .stderr(file)
            .spawn()
            .map_err(|e| e.to_string())?;
        let began = Instant::now();
        while child.try_wait().map_err(|e| e.to_string())?.is_none() {
            if began.elapsed() > LONGEST {
                child.kill().map_err(|e| e.to_string())?;
                return Err("no end within ten minutes".into());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        fs::read_to_string(&log).map_err(|e| e.to_string())
    }
}

/// A manifest without benchmarks and what they alone depend on: half of the first build.
fn without_benches(manifest: &str) -> String {
    let sections = manifest.split("\n[").filter(|s| !s.starts_with("[bench]]"));
    let lines = sections.collect::<Vec<_>>().join("\n[");
    let lines = lines.lines().filter(|line| !line.starts_with("criterion"));
    lines.map(|line| format!("{line}\n")).collect()
}

/// The first build compiles all dependencies.
const LONGEST: Duration = Duration::from_secs(600);

/// Copies a file or a folder.
fn copy_all(from: &Path, to: &Path) {
    if from.is_dir() {
        fs::create_dir_all(to).expect("a folder of the copy");
        for entry in fs::read_dir(from).expect("a folder of the crate").flatten() {
            copy_all(&entry.path(), &to.join(entry.file_name()));
        }
    } else {
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder of the copy");
        fs::copy(from, to).expect("a file of the crate");
    }
}
