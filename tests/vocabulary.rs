//! The words that the documents list are those that the program knows.

use std::collections::BTreeSet;
use std::process::Command;

use kaustik::scene::{builtin, gltf};
use kaustik::{KEYS, Key, Method};

use crate::source::read;

/// The line of docs/settings.md that a key amounts to, [`plain`].
fn row(key: &Key) -> String {
    let all = key.methods.len() == Method::ALL.len();
    let names: Vec<&str> = key.methods.iter().map(|m| m.name()).collect();
    let methods = if all {
        "all".to_owned()
    } else {
        names.join(", ")
    };
    let Key {
        name,
        range,
        default,
        meaning,
        ..
    } = key;
    let range = range.replace('|', "\\|");
    format!("| {name} | {methods} | {range} | {default} | {meaning} |")
}

/// A line without marks of code, without links in parentheses of their own, and with the words of other links alone.
fn plain(line: &str) -> String {
    let line = line.replace('`', "");
    let mut parts = line.split('[');
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let link = part
            .split_once("](")
            .and_then(|(words, rest)| Some((words, rest.split_once(')')?.1)));
        match link {
            Some((_, after)) if plain.ends_with(" (") && after.starts_with(')') => {
                plain.truncate(plain.len() - 2);
                plain += &after[1..];
            }
            Some((words, after)) => {
                plain += words;
                plain += after;
            }
            None => {
                plain.push('[');
                plain += part;
            }
        }
    }
    plain
}

/// Keys whose line is missing, and lines in the table of keys that no key has.
fn differences(keys: &[Key], document: &str) -> Vec<String> {
    let rows: Vec<String> = keys.iter().map(row).collect();
    let lines: Vec<String> = document
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(plain)
        .collect();
    let missing = rows.iter().filter(|row| !lines.contains(row));
    let surplus = lines.iter().filter(|line| !rows.contains(line));
    let missing = missing.map(|row| format!("lacks {row}"));
    missing
        .chain(surplus.map(|line| format!("has   {line}")))
        .collect()
}

/// Words in backticks in the first column of the tables below a heading.
fn first_column(document: &str, heading: &str) -> BTreeSet<String> {
    let below = document.lines().skip_while(|line| *line != heading).skip(1);
    let section = below.take_while(|line| !line.starts_with("## "));
    let cells = section.filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_scene_page_lists_what_is_read() {
    let page = read("docs/scene-files.md");
    let set = |words: Vec<&str>| {
        words
            .into_iter()
            .map(str::to_owned)
            .collect::<BTreeSet<_>>()
    };
    let extensions = set(gltf::EXTENSIONS.to_vec());
    assert_eq!(first_column(&page, "## What is read"), extensions);
    let scenes = set(builtin::list().iter().map(|scene| scene.name).collect());
    assert_eq!(first_column(&page, "## Built-in scenes"), scenes);
}

/// Words that begin with two dashes.
fn long_options(text: &str) -> BTreeSet<String> {
    let of_word = |c: char| c.is_ascii_lowercase() || c == '-';
    let words = text.split(|c| !of_word(c));
    words
        .filter(|w| w.starts_with("--") && w.len() > 2)
        .map(str::to_owned)
        .collect()
}

/// Long options that a command's help tells.
fn options_of(command: &str) -> BTreeSet<String> {
    let help = Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args([command, "--help"])
        .output()
        .expect("the command runs");
    let mut known = long_options(&String::from_utf8_lossy(&help.stdout));
    known.remove("--help");
    known
}

#[test]
fn the_command_page_lists_every_option() {
    let page = read("docs/command-line.md");
    let commands = [
        "render", "merge", "replay", "scenes", "methods", "info", "compare", "study",
    ];
    for command in commands {
        let heading = format!("## `kaustik {command}`");
        assert!(page.contains(&format!("{heading}\n")), "lacks {heading}");
        let cells = first_column(&page, &heading);
        let listed = long_options(&cells.into_iter().collect::<Vec<_>>().join(" "));
        let mut known = options_of(command);
        if command == "replay" {
            // the render's, which its section says
            let own: BTreeSet<String> = known.difference(&options_of("render")).cloned().collect();
            assert!(own.len() < known.len());
            known = own;
        }
        assert_eq!(listed, known, "{command}");
    }
}

#[test]
fn the_page_of_studies_lists_every_key() {
    let example = read("docs/studies.md");
    let toml = example
        .split("```toml")
        .nth(1)
        .and_then(|text| text.split("```").next());
    let toml = toml.expect("an example in TOML");
    let folder = std::path::Path::new("");
    let study = kaustik_study::Study::parse(toml, "example.toml", folder).expect("a sound example");
    assert!(study.scenes.len() * study.methods.len() > 1);
    // The reader refuses keys that it does not know and names those that it does.
    let listed = first_column(&example, "## Keys");
    for (place, at) in [
        ("", ""),
        ("reference.", "[reference]"),
        ("budget.", "[budget]"),
        ("scene.", "[[scene]]"),
        ("method.", "[[method]]"),
    ] {
        let wrong = if at.is_empty() {
            format!("zzz = 1\n{toml}")
        } else {
            toml.replacen(at, &format!("{at}\nzzz = 1"), 1)
        };
        let message = kaustik_study::Study::parse(&wrong, "x", folder)
            .expect_err("a key too many")
            .to_string();
        let (_, known) = message
            .split_once("expected")
            .expect("the keys that there are");
        let known: BTreeSet<String> = known
            .split('`')
            .skip(1)
            .step_by(2)
            .map(|key| format!("{place}{key}"))
            .collect();
        assert!(!known.is_empty(), "{message}");
        for key in known {
            assert!(listed.contains(&key), "docs/studies.md lacks {key}");
        }
    }
}

#[test]
fn the_settings_page_lists_every_key() {
    let faults = differences(KEYS, &read("docs/settings.md"));
    assert!(faults.is_empty(), "docs/settings.md\n{}", faults.join("\n"));
}

#[test]
fn the_readme_lists_every_method() {
    let readme = read("README.md");
    for method in Method::ALL {
        assert!(
            readme.contains(&format!("\n| `{method}` |")),
            "README.md lacks {method}"
        );
    }
}

#[test]
fn a_planted_difference_is_found() {
    let page = read("docs/settings.md");
    assert_eq!(differences(&KEYS[1..], &page).len(), 1);
    let mut keys = KEYS.to_vec();
    keys[0].default = "another";
    assert_eq!(differences(&keys, &page).len(), 2);
    let mut keys = KEYS.to_vec();
    keys[0].meaning = "something else";
    assert_eq!(differences(&keys, &page).len(), 2);
    assert_eq!(
        plain("| `a\\|b` | [moves](x.md#y) more ([why](z.md)) | [0, 1) |"),
        "| a\\|b | moves more | [0, 1) |"
    );
    let table = "## A\n| `x`, `y` | `no` |\n| `z` | |\n## B\n| `no` | |\n";
    assert_eq!(
        first_column(table, "## A").into_iter().collect::<Vec<_>>(),
        ["x", "y", "z"]
    );
}
