//! Pictures that are black, and outputs and references that cannot be what was meant.

use kaustik::Method;

use crate::words::{kaustik, path, refused};

/// Light that one edge cannot bring: every method tells that its picture is black, and not that it was fast.
#[test]
fn every_method_says_that_a_picture_is_black() {
    let said = |method: &str, depth: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let png = path(folder.path(), "a.png");
        let small = ["--width", "8", "--height", "8", "--spp", "1"];
        let words = ["render", "builtin:cornell-indirect", "--png", &png];
        let which = ["--method", method, "--max-depth", depth, "--no-features"];
        let output = kaustik(&[&words[..], &small, &which].concat());
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{method}: {text}");
        text
    };
    for method in Method::ALL {
        let text = said(method.name(), "1");
        assert!(text.contains("the picture is black"), "{method}: {text}");
    }
    let lit = said("path", "16");
    assert!(!lit.contains("black"), "{lit}");
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let [exr, obj] = ["a.exr", "a.obj"].map(|name| path(folder.path(), name));
    for word in ["-o", "--png", "--stats"] {
        refused(
            &["render", "builtin:cornell", word, "-"],
            &["standard output"],
        );
    }
    refused(&["scenes", "cornell", "--export", &obj], &["a.obj", ".glb"]);
    let small = ["--width", "8", "--height", "8", "--spp", "1", "-o", &exr];
    let rendered = kaustik(
        &[
            &["render", "builtin:cornell", "--method", "path"],
            &small[..],
        ]
        .concat(),
    );
    assert_eq!(rendered.status.code(), Some(0), "{rendered:?}");
    refused(&["compare", &exr, &exr, "--half", &exr], &["same picture"]);
    assert!(!std::path::Path::new(&obj).exists());
}
