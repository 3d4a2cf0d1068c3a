//! Links of the documents: each leads to a file, and the book names each of its pages.

use std::path::Path;

use crate::source::{files, read, root};

/// The targets of `[text](target)` outside of code, without fragments.
fn targets(markdown: &str) -> Vec<String> {
    let mut fenced = false;
    let prose = markdown.lines().filter(|line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    });
    let mut found = Vec::new();
    for line in prose {
        for rest in line.split("](").skip(1) {
            let target = rest.split(')').next().unwrap_or_default();
            found.push(target.split('#').next().unwrap_or_default().to_owned());
        }
    }
    found
}

/// Relative targets that are not there.
fn broken(page: &str, markdown: &str, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let folder = Path::new(page).parent().unwrap_or(Path::new(""));
    let outside = |t: &str| t.is_empty() || t.contains("://") || t.starts_with("mailto:");
    targets(markdown)
        .into_iter()
        .filter(|target| !outside(target) && !exists(&folder.join(target)))
        .map(|target| format!("{page}: {target} is not there"))
        .collect()
}

fn pages() -> Vec<String> {
    files().into_iter().filter(|f| f.ends_with(".md")).collect()
}

#[test]
fn every_link_leads_somewhere() {
    let there = |path: &Path| root().join(path).exists();
    let faults: Vec<String> = pages()
        .iter()
        .flat_map(|page| broken(page, &read(page), there))
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// The book is its folder alone: a link to a file beside it leads nowhere there.
#[test]
fn links_of_the_book_stay_in_it() {
    for page in pages().iter().filter(|page| page.starts_with("docs/")) {
        let depth = page.matches('/').count();
        for target in targets(&read(page)) {
            let up = target.split('/').take_while(|part| *part == "..").count();
            assert!(up < depth, "{page}: {target} leads out of docs/");
        }
    }
}

#[test]
fn the_book_names_each_of_its_pages() {
    let listed = targets(&read("docs/SUMMARY.md"));
    for page in pages() {
        if let Some(inner) = page.strip_prefix("docs/").filter(|p| *p != "SUMMARY.md") {
            let times = listed
                .iter()
                .filter(|t| t.trim_start_matches("./") == inner)
                .count();
            assert_eq!(times, 1, "docs/SUMMARY.md names {inner} {times} times");
        }
    }
}

#[test]
fn a_planted_broken_link_is_found() {
    let text = "[a](b.md#c) [d](http://x.y/z) [e](#f)\n```\n[g](h)\n```\n[i](../j.md)";
    let found = broken("docs/a.md", text, |path| path.ends_with("b.md"));
    assert_eq!(found, ["docs/a.md: ../j.md is not there"]);
}
