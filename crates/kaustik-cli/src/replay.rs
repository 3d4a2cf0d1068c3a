//! `kaustik replay`: a sample or step of a render once more, part by part.

mod drawing;
mod text;

use std::path::Path;
use std::process::ExitCode;

use kaustik::film::{check_writable, write_file};
use kaustik::scene::gltf::lines;
use kaustik::{RenderSettings, Source, State, replay_from};
use serde_json::json;

use crate::arguments::ReplayWords;
use crate::lock::Locks;
use crate::picture::{ending, refuse_inputs, remark, source_files};
use crate::render::{Loading, failure, settings};
use crate::{Failure, output};

pub(crate) fn run(words: &ReplayWords) -> Result<ExitCode, Failure> {
    let Asked {
        settings,
        source,
        size,
        state,
    } = asked(words)?;
    if let Some(path) = &words.gltf {
        if path.as_os_str() == "-" {
            let what =
                "lines do not go to standard output: expected the name of a file (./- is one)";
            return Err(wrong(path, &what));
        }
        let states = [
            Some(Path::new(&words.render.scene)),
            words.render.resume.as_deref(),
        ];
        refuse_inputs(
            path,
            states.into_iter().flatten().chain(source_files(&source)),
        )?;
        if let Some(other) = ending(path).filter(|ending| ending != "gltf") {
            let what = format!(
                "lines are written as text, not as .{other}: expected a name that ends in .gltf"
            );
            return Err(wrong(path, &what));
        }
        check_writable(path).map_err(Failure::input)?;
    }
    let _locks = Locks::take(words.gltf.iter())?;
    let outputs = &words.render.outputs;
    let loading = Loading {
        outputs,
        source: &source,
        written: words.gltf.iter().collect(),
        max_memory: words.render.max_memory,
        size,
    };
    let scene = loading.load(&settings)?;
    let [width, height] = scene.image_size();
    let settings = RenderSettings {
        width,
        height,
        ..settings
    };
    let place = words.at.place;
    let mut ahead = |iterations| {
        remark(
            outputs,
            &format!(
                "the step follows from the iterations or stages before it: {iterations} of them run first"
            ),
        );
    };
    let events = replay_from(&scene, &settings, state.as_ref(), place, &mut ahead)
        .map_err(|error| failure(&error))?;
    let RenderSettings { method, seed, .. } = settings;
    let what = format!("{method} of {}, step {seed}:{place}", source.scene);
    // names in it are those of the file
    output::print(&output::clean(&text::of(&what, &events, &scene)))?;
    if let Some(path) = &words.gltf {
        let notes = json!({ "kaustik": what });
        let text = lines(&drawing::of(&events), &notes);
        write_file(path, |file| file.write_all(text.as_bytes())).map_err(Failure::other)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Columns and rows as far as they are known.
type Size = (Option<u32>, Option<u32>);

/// What is known of the render.
struct Asked {
    settings: RenderSettings,
    source: Source,
    size: Size,
    /// One that it left behind.
    state: Option<State>,
}

/// The settings and the scene of the render, from its words or from its state.
fn asked(words: &ReplayWords) -> Result<Asked, Failure> {
    let render = &words.render;
    let path = Path::new(&render.scene);
    let read = |path: &Path| State::read(path).map_err(|error| wrong(path, &error));
    if !State::is_at(path) {
        let mut settings = settings(render)?;
        settings.seed = words.at.seed.unwrap_or(settings.seed);
        let source = Source {
            scene: render.scene.clone(),
            camera: render.camera.clone(),
            variant: render.variant.clone(),
            environment: render.environment.clone(),
        };
        return Ok(Asked {
            settings,
            source,
            size: (render.width, render.height),
            state: render.resume.as_deref().map(read).transpose()?,
        });
    }
    let state = read(path)?;
    let settings = RenderSettings {
        threads: render.threads.map_or(0, |threads| threads as usize),
        ..state.settings().map_err(|error| wrong(path, &error))?
    };
    if let Some(seed) = words.at.seed.filter(|seed| *seed != settings.seed) {
        let found = format!("seed is {} in the state, {seed} in --at", settings.seed);
        return Err(wrong(path, &found));
    }
    Ok(Asked {
        size: (Some(settings.width), Some(settings.height)),
        settings,
        source: state.source().clone(),
        state: Some(state),
    })
}

fn wrong(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Input(format!("{}: {error}", path.display()))
}
