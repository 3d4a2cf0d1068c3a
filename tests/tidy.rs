//! Habits that a compiler does not check.

use cargo_metadata::{MetadataCommand, Package};

use crate::source::{files, lines_with, product, read, root, sources};

/// No source file is longer: what needs more holds more than one noun.
const LONGEST: usize = 500;

/// Tables of numbers may be as long as they are.
fn is_table(path: &str) -> bool {
    path.contains("/data/") || path.ends_with("/tables.rs")
}

/// Leftovers that must not be committed.
const LEFTOVERS: &[&str] = &["todo!", "unimplemented!", "dbg!"];

fn packages() -> Vec<Package> {
    let metadata = MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .expect("cargo metadata runs");
    metadata.workspace_packages().into_iter().cloned().collect()
}

/// Lints of the workspace are not inherited by themselves.
fn inherits_lints(manifest: &str) -> bool {
    let mut lines = manifest
        .lines()
        .map(str::trim)
        .skip_while(|line| *line != "[lints]");
    lines.nth(1) == Some("workspace = true")
}

/// What a registry or a reader would miss in a package.
fn missing(package: &Package) -> Vec<&'static str> {
    let checks = [
        (
            "description",
            package.description.as_ref().is_some_and(|d| d.len() > 20),
        ),
        ("keywords", (1..=5).contains(&package.keywords.len())),
        ("categories", !package.categories.is_empty()),
        ("readme", package.readme().is_some_and(|path| path.exists())),
        (
            "license",
            package.license.as_deref() == Some("MIT OR Apache-2.0"),
        ),
        ("repository", package.repository.is_some()),
        ("rust-version", package.rust_version.is_some()),
    ];
    checks
        .iter()
        .filter(|(_, there)| !there)
        .map(|(what, _)| *what)
        .collect()
}

/// Inner dependencies that a registry would refuse: a path without a version. (A crate that
/// names itself for a feature in its own tests must have none: packages leave it out.)
fn versionless(package: &Package) -> Vec<String> {
    let bare = |d: &&cargo_metadata::Dependency| {
        d.path.is_some() && d.req.comparators.is_empty() && d.name != *package.name
    };
    package
        .dependencies
        .iter()
        .filter(bare)
        .map(|d| d.name.clone())
        .collect()
}

/// Folders of somebody's machine, spelled so that this file holds none of them.
fn machine_folders() -> Vec<String> {
    ["work", "tmp", "home", "root", "Users"]
        .map(|name| format!("/{name}"))
        .to_vec()
}

/// Lines that name a folder of somebody's machine as an absolute path.
fn machine_paths(text: &str) -> Vec<usize> {
    let part = |c: char| c.is_alphanumeric() || "_-.~/".contains(c);
    let name = |c: char| c.is_alphanumeric() || "_-".contains(c);
    let mut lines = Vec::new();
    for folder in machine_folders() {
        for (at, _) in text.match_indices(&folder) {
            let (before, after) = (&text[..at], &text[at + folder.len()..]);
            let starts = !before.ends_with(part) || before.ends_with("://");
            if starts && !after.starts_with(name) {
                lines.push(before.matches('\n').count() + 1);
            }
        }
    }
    lines
}

#[test]
fn members_say_what_they_are() {
    for package in packages() {
        let name = &package.name;
        assert_eq!(
            missing(&package),
            [""; 0],
            "missing in the manifest of {name}"
        );
        assert_eq!(
            versionless(&package),
            [""; 0],
            "without a version in {name}"
        );
        let folder = package.manifest_path.parent().and_then(|p| p.file_name());
        assert_eq!(
            folder,
            Some(name.as_str()),
            "a crate's folder bears its name"
        );
        let manifest = read(&format!("crates/{name}/Cargo.toml"));
        assert!(
            inherits_lints(&manifest),
            "{name} lacks [lints] workspace = true"
        );
    }
}

#[test]
fn files_hold_one_noun() {
    let ours = |f: &String| f.ends_with(".rs") && !is_table(f);
    for file in files().into_iter().filter(ours) {
        let length = read(&file).lines().count();
        assert!(
            length <= LONGEST,
            "{file} has {length} lines, more than {LONGEST}"
        );
    }
}

#[test]
fn nothing_is_left_over() {
    for source in sources() {
        for leftover in LEFTOVERS {
            let lines = lines_with(&source.code, leftover);
            assert!(
                lines.is_empty(),
                "{}: {leftover} on lines {lines:?}",
                source.path
            );
        }
    }
}

#[test]
fn nobodys_machine_is_named() {
    for file in files() {
        let bytes = std::fs::read(root().join(&file)).expect("a file of the project");
        let Ok(text) = String::from_utf8(bytes) else {
            continue; // pictures, packed tables
        };
        let lines = machine_paths(&text);
        assert!(
            lines.is_empty(),
            "{file} names a folder of a machine on lines {lines:?}"
        );
    }
}

#[test]
fn planted_violations_are_found() {
    assert!(inherits_lints("[package]\n[lints]\nworkspace = true\n"));
    assert!(!inherits_lints(
        "[package]\nworkspace = true\n[lints.rust]\n"
    ));

    let mut package = packages().swap_remove(0);
    package.keywords.clear();
    package.license = None;
    assert_eq!(missing(&package), ["keywords", "license"]);

    let code = product("fn f() {\n todo!() // dbg!\n}");
    assert_eq!(lines_with(&code, LEFTOVERS[0]), [2]);
    assert_eq!(lines_with(&code, LEFTOVERS[2]), [0; 0]);

    for folder in machine_folders() {
        for text in ["\"X/a\"", "`X`", "see X.", "file://X/a", "a=X"] {
            assert_eq!(
                machine_paths(&text.replace('X', &folder)).len(),
                1,
                "{folder} in {text}"
            );
        }
        for text in ["aX/b", "./aX", "Xing", "..X/a"] {
            assert_eq!(
                machine_paths(&text.replace('X', &folder)),
                [0; 0],
                "{folder} in {text}"
            );
        }
    }
    assert!(is_table("crates/kaustik-spectrum/src/data/metals.rs") && !is_table("src/lib.rs"));
}
