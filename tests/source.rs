use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The text of a file below the root.
pub(crate) fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Every file of the project, relative to the root, with `/` between folders, sorted:
/// what git tracks or would offer to, and without git all that is not built or hidden.
pub(crate) fn files() -> Vec<String> {
    let mut files = tracked().unwrap_or_else(|| {
        let mut found = Vec::new();
        walk(&root(), "", &mut found);
        found
    });
    files.retain(|file| root().join(file).is_file());
    files.sort();
    files
}

fn tracked() -> Option<Vec<String>> {
    let output = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let list = String::from_utf8(output.stdout).ok()?;
    Some(list.lines().map(str::to_owned).collect())
}

fn walk(folder: &Path, prefix: &str, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder)
        .expect("a folder of the project")
        .flatten()
    {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{prefix}{name}");
        if entry.path().is_file() {
            found.push(path);
        } else if name != "target" && name != ".git" && path != "docs/book" {
            walk(&entry.path(), &format!("{path}/"), found);
        }
    }
}

/// A Rust source file of the product: no tests, benches or examples.
pub(crate) struct Source {
    /// Relative to the root.
    pub(crate) path: String,
    /// The crate it belongs to.
    pub(crate) crate_name: String,
    /// Its code, see [`product`].
    pub(crate) code: String,
}

/// All Rust sources under `crates/*/src` that are compiled into the product.
pub(crate) fn sources() -> Vec<Source> {
    let in_src = |path: &String| path.starts_with("crates/") && path.contains("/src/");
    let files: Vec<(String, String)> = files()
        .into_iter()
        .filter(|path| in_src(path) && path.ends_with(".rs"))
        .map(|path| (path.clone(), read(&path)))
        .collect();
    let tests: Vec<String> = files.iter().flat_map(|(p, t)| test_modules(p, t)).collect();
    let in_tests = |path: &str| tests.iter().any(|test| path.starts_with(test));
    let product_files = files.iter().filter(|(path, _)| !in_tests(path));
    product_files
        .map(|(path, text)| Source {
            path: path.clone(),
            crate_name: path.split('/').nth(1).unwrap_or_default().to_owned(),
            code: product(text),
        })
        .collect()
}

/// Beginnings of the paths of modules that a file declares under `#[cfg(test)]`.
fn test_modules(path: &str, text: &str) -> Vec<String> {
    let (folder, file) = path.rsplit_once('/').unwrap_or(("", path));
    let folder = match file {
        "lib.rs" | "main.rs" | "mod.rs" => folder.to_owned(),
        _ => format!("{folder}/{}", file.trim_end_matches(".rs")),
    };
    let code: String = masked(text).into_iter().collect();
    let items = code.split("#[cfg(test)]").skip(1);
    let declared = items.filter_map(|item| {
        let (declaration, _) = item.split_once(';')?;
        let name = declaration.trim().rsplit_once("mod ")?.1;
        name.chars().all(joins).then(|| name.to_owned())
    });
    declared
        .flat_map(|name| [format!("{folder}/{name}.rs"), format!("{folder}/{name}/")])
        .collect()
}

/// The lines (from 1) on which `token` stands on its own, not as the end of a longer name.
pub(crate) fn lines_with(code: &str, token: &str) -> Vec<usize> {
    let longer = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(token)
        .filter(|(at, _)| !code[..*at].ends_with(longer) || token.starts_with(['.', ' ']))
        .map(|(at, _)| code[..at].matches('\n').count() + 1)
        .collect()
}

/// What of a Rust source becomes the product: comments, the contents of strings, and
/// items under `#[cfg(test)]` are blanked; lines stay where they are.
pub(crate) fn product(source: &str) -> String {
    let mut code: Vec<char> = masked(source);
    let attribute: Vec<char> = "#[cfg(test)]".chars().collect();
    let mut at = 0;
    while at + attribute.len() <= code.len() {
        if code[at..].starts_with(&attribute) {
            let end = end_of_item(&code, at + attribute.len());
            blank(&mut code[at..end]);
            at = end;
        } else {
            at += 1;
        }
    }
    code.into_iter().collect()
}

/// Behind the `;` or the closing brace of the item that begins at `at`.
fn end_of_item(code: &[char], at: usize) -> usize {
    let mut depth = 0usize;
    for (i, c) in code.iter().enumerate().skip(at) {
        match c {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && matches!(c, ';' | '}') {
            return i + 1;
        }
    }
    code.len()
}

fn blank(code: &mut [char]) {
    for c in code.iter_mut().filter(|c| **c != '\n') {
        *c = ' ';
    }
}

/// Blanks comments and what strings and characters hold.
fn masked(source: &str) -> Vec<char> {
    let mut code: Vec<char> = source.chars().collect();
    let mut at = 0;
    while at < code.len() {
        let end = hidden_until(&code, at);
        if end > at {
            blank(&mut code[at..end]);
            at = end;
        } else {
            at += 1;
        }
    }
    code
}

/// The end of the comment, string or character that begins at `at`; `at` if none does.
fn hidden_until(code: &[char], at: usize) -> usize {
    let next = code.get(at + 1).copied().unwrap_or('\0');
    match code[at] {
        '/' if next == '/' => find(code, at, |i| code[i] == '\n'),
        '/' if next == '*' => end_of_block_comment(code, at),
        '"' => end_of_string(code, at + 1),
        'r' if at == 0 || !joins(code[at - 1]) || code[at - 1] == 'b' => {
            let quote = find(code, at + 1, |i| code[i] != '#');
            if code.get(quote) == Some(&'"') {
                end_of_raw_string(code, quote + 1, quote - at - 1)
            } else {
                at
            }
        }
        '\'' if next == '\\' => find(code, at + 3, |i| code[i] == '\'') + 1,
        '\'' if code.get(at + 2) == Some(&'\'') => at + 3,
        _ => at,
    }
    .min(code.len())
}

fn joins(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn find(code: &[char], from: usize, wanted: impl Fn(usize) -> bool) -> usize {
    (from..code.len())
        .find(|i| wanted(*i))
        .unwrap_or(code.len())
}

fn end_of_string(code: &[char], mut at: usize) -> usize {
    while at < code.len() && code[at] != '"' {
        at += if code[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

fn end_of_raw_string(code: &[char], from: usize, hashes: usize) -> usize {
    let closes = |i: usize| {
        let rest = &code[i + 1..];
        code[i] == '"' && rest.len() >= hashes && rest[..hashes].iter().all(|c| *c == '#')
    };
    find(code, from, closes) + 1 + hashes
}

fn end_of_block_comment(code: &[char], from: usize) -> usize {
    let (mut at, mut depth) = (from, 0usize);
    while at < code.len() {
        match (code[at], code.get(at + 1)) {
            ('/', Some('*')) => (depth, at) = (depth + 1, at + 2),
            ('*', Some('/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_tests_are_no_product() {
        let hidden = [
            "// gone(",
            "//! gone(",
            "/* a /* b */ gone( */",
            "let s = \"\\\"gone(\";",
            "let s = r#\"\" gone( \"#;",
            "let s = br\"gone(\";",
            "let c = ['\"', '\\'', '\"']; // gone(",
            "#[cfg(test)]\nmod tests { fn f() { gone(1) } }",
            "#[cfg(test)]\n#[path = \"x.rs\"]\nuse gone();",
            "#[cfg(test)]\nmod tests;\n// gone(",
            "regone(",
        ];
        for source in hidden {
            assert_eq!(lines_with(&product(source), "gone("), [0; 0], "{source}");
        }
    }

    #[test]
    fn what_stands_beside_them_is_found_on_its_line() {
        let shown = [
            "/* a */ /* b */\nstays();",
            "let a = \"x\";\nstays();",
            "fn f<'a>(x: &'a str) {\n stays() }",
            "#[cfg(test)]\nuse x; stays();",
            "let c = '\"'; //\nstays();",
            "let r = br; \n stays();",
            "// c\nlet x = xr\"a\".stays();",
        ];
        for source in shown {
            assert_eq!(lines_with(&product(source), "stays("), [2], "{source}");
        }
    }

    #[test]
    fn test_modules_in_files_of_their_own_are_known() {
        let text = "#[cfg(test)]\npub(crate) mod kit;\nmod real; #[cfg(test)]\nmod tests { f(); }";
        assert_eq!(test_modules("a/lib.rs", text), ["a/kit.rs", "a/kit/"]);
        assert_eq!(test_modules("a/b.rs", text), ["a/b/kit.rs", "a/b/kit/"]);
    }

    #[test]
    fn the_tree_is_seen() {
        let files = files();
        for file in [
            "Cargo.toml",
            "crates/kaustik-pss/src/lib.rs",
            "tests/source.rs",
        ] {
            assert!(
                files.iter().any(|f| f == file),
                "{file} among {} files",
                files.len()
            );
        }
        assert!(sources().iter().any(|s| s.crate_name == "kaustik-pss"));
    }
}
