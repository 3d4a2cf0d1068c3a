//! The arrows between crates, as declared, as listed here, and as the documents say.
//!
//! A new arrow is the dearest kind of change (see CONTRIBUTING.md): it takes a line in
//! [`TABLE`] and one in `docs/architecture.md`, and so a reason.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

use crate::source::{lines_with, product, read, root, sources};

/// One crate: its level and what it depends on. Names of ours go without `kaustik-`.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    level: u8,
    name: String,
    ours: BTreeSet<String>,
    outside: BTreeSet<String>,
    /// Of ours, in tests alone.
    tests: BTreeSet<String>,
}

/// Level, crate, crates of ours, crates of others, crates of ours in tests alone.
const TABLE: &[(u8, &str, &str, &str, &str)] = &[
    (0, "kaustik-pss", "", "serde", ""),
    (0, "kaustik-spectrum", "", "libm miniz_oxide thiserror", ""),
    (0, "kaustik-geometry", "", "glam obvhs rayon thiserror", ""),
    (
        1,
        "kaustik-mcmc",
        "pss",
        "libm proptest rand rand_pcg serde",
        "",
    ),
    (1, "kaustik-bsdf", "spectrum", "glam libm", ""),
    (
        1,
        "kaustik-film",
        "spectrum",
        "exr image libm serde serde_json tempfile thiserror",
        "",
    ),
    (
        2,
        "kaustik-scene",
        "bsdf geometry spectrum",
        "base64 bevy_mikktspace blake3 glam image libm meshoptimizer-rs rayon serde serde_json thiserror",
        "",
    ),
    (
        3,
        "kaustik-path",
        "bsdf geometry pss scene spectrum",
        "glam serde",
        "mcmc",
    ),
    (
        4,
        "kaustik-mutate",
        "bsdf geometry mcmc path scene spectrum",
        "glam libm serde",
        "pss",
    ),
    (
        4,
        "kaustik-estimate",
        "film mcmc path pss scene spectrum",
        "libm serde",
        "",
    ),
    (
        5,
        "kaustik",
        "bsdf estimate film geometry mcmc mutate path pss scene spectrum",
        "blake3 glam postcard rayon serde serde_json sobol_burley thiserror",
        "",
    ),
    (
        6,
        "kaustik-study",
        "kaustik",
        "base64 minijinja plotters serde serde_json statrs thiserror toml",
        "",
    ),
    (
        7,
        "kaustik-cli",
        "kaustik study",
        "clap glam indicatif serde_json signal-hook",
        "",
    ),
    (
        7,
        "kaustik-fuzz",
        "kaustik",
        "clap glam image meshoptimizer-rs serde_json tempfile",
        "",
    ),
];

/// What a crate must not reach, however many arrows away, and why.
const ABSENT: &[(&[&str], &[&str], &str)] = &[
    (
        &["kaustik-pss", "kaustik-mcmc"],
        &[
            "glam",
            "obvhs",
            "image",
            "png",
            "exr",
            "gltf",
            "rayon",
            "rayon-core",
            "crossbeam-utils",
            "tempfile",
        ],
        "the chains know no vector, no light, no image, no thread",
    ),
    (
        &["kaustik-path", "kaustik-scene"],
        &[
            "kaustik-mcmc",
            "rand",
            "rand_core",
            "rand_pcg",
            "rand_chacha",
        ],
        "a path is a function of its coordinates: it knows no chain and no generator",
    ),
];

/// Words that only some crates may write, and why. Tests may write any.
const RESERVED: &[(&[&str], &[&str], &str)] = &[
    (
        &["thread::spawn", "thread::scope", "thread::Builder"],
        &["kaustik", "kaustik-cli", "kaustik-fuzz"],
        "the threads of a render stand in kaustik alone; the command waits for signals, a campaign watches over its children",
    ),
    (
        &["rayon::"],
        &["kaustik", "kaustik-geometry", "kaustik-scene"],
        "the threads of a render stand in kaustik alone; scenes are loaded and built on some behind a feature",
    ),
    (
        &["std::fs", "fs::", "File::", "OpenOptions", "tempfile"],
        &[
            "kaustik-scene",
            "kaustik-film",
            "kaustik",
            "kaustik-study",
            "kaustik-cli",
            "kaustik-fuzz",
        ],
        "files are read and written at the rim alone",
    ),
    (
        &["rand::", "rand_pcg", "Rng"],
        &["kaustik-mcmc", "kaustik"],
        "random numbers come from coordinates or from a ladder's generator",
    ),
];

/// Package -> packages it is built from, tests aside.
type Graph = BTreeMap<String, BTreeSet<String>>;

fn short(name: &str) -> String {
    name.strip_prefix("kaustik-").unwrap_or(name).to_owned()
}

fn words(list: &str) -> BTreeSet<String> {
    list.split_whitespace().map(str::to_owned).collect()
}

fn expected() -> Vec<Row> {
    TABLE
        .iter()
        .map(|(level, name, ours, outside, tests)| Row {
            level: *level,
            name: (*name).to_owned(),
            ours: words(ours),
            outside: words(outside),
            tests: words(tests),
        })
        .collect()
}

/// The row that a manifest amounts to; its level is that of the table.
fn declared(package: &Package) -> Row {
    let of = |kind: DependencyKind, ours: bool| -> BTreeSet<String> {
        // A crate that names itself does so for a feature in its own tests: no arrow.
        let others = package
            .dependencies
            .iter()
            .filter(|d| d.name != *package.name);
        let wanted = others.filter(|d| d.kind == kind);
        let names = wanted.map(|d| d.name.as_str());
        names
            .filter(|n| n.starts_with("kaustik") == ours)
            .map(short)
            .collect()
    };
    let level = TABLE.iter().find(|row| row.1 == package.name.as_str());
    Row {
        level: level.map_or(u8::MAX, |row| row.0),
        name: package.name.to_string(),
        ours: of(DependencyKind::Normal, true),
        outside: &of(DependencyKind::Normal, false) | &of(DependencyKind::Build, false),
        tests: &of(DependencyKind::Development, true) - &of(DependencyKind::Normal, true),
    }
}

/// The rows of the table between the `arrows` marks of a document.
fn documented(text: &str) -> Vec<Row> {
    let table = text
        .split_once("<!-- arrows -->")
        .and_then(|(_, rest)| rest.split_once("<!-- /arrows -->"))
        .map_or("", |(table, _)| table);
    table.lines().filter_map(documented_row).collect()
}

fn documented_row(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line
        .trim()
        .trim_matches('|')
        .split('|')
        .map(str::trim)
        .collect();
    let list = |cell: &str| words(&cell.replace([',', '`'], " ").replace('–', ""));
    let [level, name, ours, outside, tests] = cells.as_slice() else {
        return None;
    };
    Some(Row {
        level: level.parse().ok()?,
        name: name.trim_matches('`').to_owned(),
        ours: list(ours),
        outside: list(outside),
        tests: list(tests),
    })
}

/// Rows of one list that the other lacks, as text.
fn differences(what: &str, found: &[Row], wanted: &[Row]) -> Vec<String> {
    let missing = wanted.iter().filter(|row| !found.contains(row));
    let surplus = found.iter().filter(|row| !wanted.contains(row));
    missing
        .map(|row| format!("{what} lacks {row:?}"))
        .chain(surplus.map(|row| format!("{what} has {row:?}")))
        .collect()
}

/// Arrows that do not point down.
fn upward(rows: &[Row]) -> Vec<String> {
    let level = |name: &str| {
        rows.iter()
            .find(|r| short(&r.name) == name)
            .map(|r| r.level)
    };
    rows.iter()
        .flat_map(|row| row.ours.iter().chain(&row.tests).map(move |to| (row, to)))
        .filter(|(row, to)| level(to).is_none_or(|level| level >= row.level))
        .map(|(row, to)| format!("{} -> {to} does not point down", row.name))
        .collect()
}

fn metadata() -> Metadata {
    let host = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned()))
        .arg("-vV")
        .output()
        .expect("rustc runs");
    let text = String::from_utf8(host.stdout).expect("rustc speaks UTF-8");
    let host = text
        .lines()
        .find_map(|l| l.strip_prefix("host: "))
        .expect("a host");
    MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .other_options(["--filter-platform".to_owned(), host.to_owned()])
        .exec()
        .expect("cargo metadata runs")
}

fn graph(metadata: &Metadata) -> Graph {
    let name = |id| metadata[id].name.to_string();
    let mut graph = Graph::new();
    for node in &metadata.resolve.as_ref().expect("a resolved graph").nodes {
        let product = |kind| kind != DependencyKind::Development;
        let used = node
            .deps
            .iter()
            .filter(|d| d.dep_kinds.iter().any(|k| product(k.kind)));
        let all = graph.entry(name(&node.id)).or_default();
        all.extend(used.map(|dep| name(&dep.pkg)));
    }
    graph
}

/// Everything that can be reached from a package.
fn reach(graph: &Graph, from: &str) -> BTreeSet<String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
    while let Some(name) = open.pop() {
        for next in graph.get(&name).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

/// Written absences that do not hold in a graph.
fn present(graph: &Graph) -> Vec<String> {
    let mut found = Vec::new();
    for (crates, packages, why) in ABSENT {
        for name in *crates {
            let reach = reach(graph, name);
            let bad = packages.iter().filter(|p| reach.contains(**p));
            found.extend(bad.map(|p| format!("{name} reaches {p}: {why}")));
        }
    }
    found
}

/// Reserved words that a crate may not write.
fn trespasses(crate_name: &str, path: &str, code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (tokens, allowed, why) in RESERVED {
        for token in tokens.iter().filter(|_| !allowed.contains(&crate_name)) {
            let lines = lines_with(code, token);
            found.extend(
                lines
                    .iter()
                    .map(|n| format!("{path}:{n}: `{token}`: {why}")),
            );
        }
    }
    found
}

/// `cargo run`, as the README has it, must know which of the programs is meant.
#[test]
fn the_command_is_what_runs() {
    let metadata = metadata();
    let packages = metadata.workspace_packages();
    let meant: Vec<&str> = (packages.iter())
        .filter_map(|package| package.default_run.as_deref())
        .collect();
    assert_eq!(meant, ["kaustik"]);
    assert_eq!(metadata.workspace_default_members.len(), packages.len());
}

#[test]
fn manifests_agree_with_the_table() {
    let metadata = metadata();
    let found: Vec<Row> = metadata
        .workspace_packages()
        .into_iter()
        .map(declared)
        .collect();
    let faults = differences("the workspace", &found, &expected());
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn the_document_agrees_with_the_table() {
    let found = documented(&read("docs/architecture.md"));
    let faults = differences("docs/architecture.md", &found, &expected());
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn every_arrow_points_down() {
    assert_eq!(upward(&expected()), [""; 0]);
}

#[test]
fn what_is_absent_is_absent() {
    let faults = present(&graph(&metadata()));
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// rayon is a matter of `kaustik`; building and loading may use it behind a feature.
#[test]
fn rayon_is_optional_below_kaustik() {
    for package in metadata().workspace_packages() {
        let bare = package
            .dependencies
            .iter()
            .any(|d| d.name == "rayon" && !d.optional);
        let free = package.name.as_str() == "kaustik";
        assert!(
            free || !bare,
            "{} depends on rayon without a feature",
            package.name
        );
    }
}

#[test]
fn reserved_words_stay_where_they_belong() {
    let faults: Vec<String> = sources()
        .iter()
        .flat_map(|s| trespasses(&s.crate_name, &s.path, &s.code))
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn planted_violations_are_found() {
    let wanted = expected();
    let mut planted = wanted.clone();
    planted[0].outside.insert("glam".to_owned());
    assert_eq!(differences("x", &planted, &wanted).len(), 2);
    assert_eq!(differences("x", &planted[1..], &wanted).len(), 1);

    planted[0].ours.insert("mcmc".to_owned());
    assert_eq!(
        upward(&planted),
        ["kaustik-pss -> mcmc does not point down"]
    );

    let arrow = |from: &str, to: &str| (from.to_owned(), words(to));
    let bad = Graph::from([
        arrow("kaustik-mcmc", "harmless"),
        arrow("harmless", "glam"),
        arrow("kaustik-path", "kaustik-scene"),
        arrow("kaustik-scene", "rand"),
    ]);
    assert_eq!(present(&bad).len(), 3, "{:?}", present(&bad));

    let spawn = product("use std::{fs, thread};\nfn f() { thread::spawn(|| fs::read(p)); }");
    assert_eq!(trespasses("kaustik-bsdf", "x.rs", &spawn).len(), 2);
    let join = product("fn f() { rayon::join(a, b); }");
    assert_eq!(trespasses("kaustik-estimate", "x.rs", &join).len(), 1);
    assert_eq!(trespasses("kaustik", "x.rs", &spawn).len(), 0);
}

#[test]
fn a_row_of_the_document_is_read() {
    let text = "<!-- arrows -->\n| level | crate |\n|---|---|\n\
        | 3 | `kaustik-path` | pss, scene | `glam` | – |\n<!-- /arrows -->\n| 9 | x | | | |";
    let row = Row {
        level: 3,
        name: "kaustik-path".to_owned(),
        ours: words("pss scene"),
        outside: words("glam"),
        tests: words(""),
    };
    assert_eq!(documented(text), [row]);
}
