//! `kaustik scenes` and `kaustik methods`.

use std::fmt::Write;
use std::process::ExitCode;

use kaustik::film::{check_writable, write_file};
use kaustik::scene::{builtin, gltf};
use kaustik::{Key, Method};

use crate::arguments::{MethodWords, SceneWords};
use crate::lock::Locks;
use crate::picture::ending;
use crate::{Failure, output};

/// Lists the built-in scenes, or exports one.
pub(crate) fn scenes(words: &SceneWords) -> Result<ExitCode, Failure> {
    if let (Some(name), Some(path)) = (&words.name, &words.export) {
        let name = name.strip_prefix("builtin:").unwrap_or(name);
        let description = builtin::load(name).map_err(Failure::input)?;
        let export = match ending(path).as_deref() {
            Some("glb") => gltf::export_bytes,
            Some("gltf") => gltf::export_text,
            _ => {
                return Err(Failure::Input(format!(
                    "{}: --export writes glTF: expected a name that ends in .glb or .gltf",
                    path.display()
                )));
            }
        };
        check_writable(path).map_err(Failure::input)?;
        let _locks = Locks::take(words.export.iter())?;
        let bytes = export(&description).map_err(Failure::other)?;
        write_file(path, |file| file.write_all(&bytes)).map_err(Failure::other)?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut text = String::new();
    for scene in builtin::list() {
        let _ = writeln!(text, "{:<18} {}", scene.name, scene.summary);
        for parameter in scene.parameters {
            let _ = writeln!(
                text,
                "{:<18}   ?{}={}: {} (default {})",
                "", parameter.key, parameter.values, parameter.meaning, parameter.default
            );
        }
    }
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// Lists the methods, or the settings of one.
pub(crate) fn methods(words: &MethodWords) -> Result<ExitCode, Failure> {
    let mut text = String::new();
    match words.name {
        None => {
            for method in Method::ALL {
                let mark = if method == Method::default() {
                    " (default)"
                } else {
                    ""
                };
                let _ = writeln!(text, "{:<19} {}{mark}", method.name(), method.summary());
            }
            text += "\nkaustik methods NAME lists the settings of one.\n";
        }
        Some(method) => {
            let _ = writeln!(text, "{}: {}\n", method.name(), method.summary());
            for Key {
                name,
                default,
                range,
                meaning,
                ..
            } in method.keys()
            {
                let _ = writeln!(
                    text,
                    "--set {name}={range}  (default {default})\n    {meaning}"
                );
            }
        }
    }
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
