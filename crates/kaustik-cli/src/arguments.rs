//! The words of the command line.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use kaustik::film::{Filter, Tone, ToneCurve, Window};
use kaustik::{Method, StepId};

/// Light transport with Markov chains.
#[derive(Debug, Parser)]
#[command(name = "kaustik", version, about, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an EXR and a PNG file
    Render(Box<RenderWords>),
    /// Show what happened in one sample or step of a render: its words, or one of its states in the place of the scene
    #[command(mut_args(|arg| match arg.get_id().as_str() {
        // Accepted, as the words of a render are, and of no effect: no picture is written.
        "output" | "png" | "stats" | "exposure" | "tone" | "no_features" | "checkpoint" | "checkpoint_every" => arg.hide(true),
        _ => arg,
    }))]
    Replay(Box<ReplayWords>),
    /// Add up the states of shares of a render to the picture of the whole
    Merge(MergeWords),
    /// List the built-in scenes, or export one as glTF
    Scenes(SceneWords),
    /// List the methods, or the settings of one
    Methods(MethodWords),
    /// Say what a scene file holds and what of it is ignored
    Info(InfoWords),
    /// Compare pictures with a reference
    Compare(CompareWords),
    /// Render methods x scenes x seeds against a reference, to tables, curves and a page
    Study(StudyWords),
}

/// Words of `render`.
#[derive(Args, Debug)]
pub(crate) struct RenderWords {
    /// A .gltf or .glb file, or builtin:NAME (see `kaustik scenes`)
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) outputs: OutputWords,
    /// How to compute the picture (see `kaustik methods`)
    #[arg(long, value_name = "NAME", default_value_t = Method::default())]
    pub(crate) method: Method,
    /// Columns; by default what the camera's aspect ratio makes of the height, or of a longer side of 1024
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub(crate) width: Option<u32>,
    /// Rows; by default what the camera's aspect ratio makes of the width, or of a longer side of 1024
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub(crate) height: Option<u32>,
    /// Samples or mutations a pixel; of photon methods iterations
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) spp: Option<u64>,
    /// The same over the whole picture; of photon methods light paths
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) mutations: Option<u64>,
    /// Time, for instance 500ms, 30s, 5m, 1h [default: 60s]
    #[arg(long, value_name = "TIME", group = "budget", value_parser = duration)]
    pub(crate) time: Option<Duration>,
    /// Every random number follows from it
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Worker threads; changes nothing in the picture [default: one a processor]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) threads: Option<u32>,
    /// Longest path in edges
    #[arg(long, value_name = "D", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) max_depth: u32,
    /// Wavelengths a path: 4 importance-sampled, or 1 uniform over 400-700 nm
    #[arg(long, value_name = "N", value_parser = ["1", "4"])]
    pub(crate) wavelengths: Option<String>,
    /// Pixel filter: box, tent, gaussian, mitchell or blackman-harris, with a radius as in gaussian:2
    #[arg(long, value_name = "NAME", default_value = "box", value_parser = str::parse::<Filter>)]
    pub(crate) filter: Filter,
    /// Pixels to render: X0,Y0,X1,Y1, the last two excluded
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = window)]
    pub(crate) crop: Option<Window>,
    /// Camera by name, or by index from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) camera: Option<String>,
    /// Material variant by name (see `kaustik info`) [default: each mesh's own materials]
    #[arg(long, value_name = "NAME")]
    pub(crate) variant: Option<String>,
    /// Light from all around: a .hdr or .exr file, one number, or R,G,B
    #[arg(long, value_name = "FILE|COLOUR")]
    pub(crate) environment: Option<String>,
    /// The ladders that this process runs, half-open
    #[arg(long, value_name = "I..J", value_parser = ladders)]
    pub(crate) ladders: Option<Range<u32>>,
    /// Most memory that loading the scene may take, for instance 500M or 4G [default: 1G and 64 bytes for each byte of its files]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) max_memory: Option<u64>,
    /// A setting of the method (see `kaustik methods NAME`); may be repeated, and of one key the last counts
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) settings: Vec<String>,
    /// Write the state to this file now and then, and at the end
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Time between two states
    #[arg(long, value_name = "TIME", default_value = "60s", requires = "checkpoint", value_parser = duration)]
    pub(crate) checkpoint_every: Duration,
    /// Go on from a state that the same words wrote; the budget may be larger
    #[arg(long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,
}

/// Words of `replay`.
#[derive(Args, Debug)]
pub(crate) struct ReplayWords {
    // The scene may be one of the render's states: then that says all but the place. A state, given so or by --resume, spares
    // iterations of photon methods and stages.
    #[command(flatten)]
    pub(crate) render: RenderWords,
    /// Which sample or step, as a render reports it; LADDER may be lamps or meter
    #[arg(long, value_name = "[SEED:]LADDER:STEP", value_parser = at)]
    pub(crate) at: At,
    /// Write the walks and their connections as lines, to look at
    #[arg(long, value_name = "OUT.gltf")]
    pub(crate) gltf: Option<PathBuf>,
}

/// A place in a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct At {
    pub(crate) seed: Option<u64>,
    pub(crate) place: StepId,
}

/// Where a picture goes, and how much is said about it.
#[derive(Args, Debug)]
pub(crate) struct OutputWords {
    /// Linear EXR file with layers and metadata
    #[arg(short, long, value_name = "OUT.exr")]
    pub(crate) output: Option<PathBuf>,
    /// PNG file for looking at
    #[arg(long, value_name = "OUT.png")]
    pub(crate) png: Option<PathBuf>,
    /// Statistics as JSON
    #[arg(long, value_name = "OUT.json")]
    pub(crate) stats: Option<PathBuf>,
    /// Stops by which the PNG is brightened
    #[arg(long, value_name = "STOPS", requires = "png", default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
    pub(crate) exposure: f64,
    /// Tone curve of the PNG: srgb or filmic
    #[arg(long, value_name = "CURVE", requires = "png", default_value_t = ToneCurve::Srgb)]
    pub(crate) tone: ToneCurve,
    /// Leave out the layers albedo, normal, depth and those of parts of the picture
    #[arg(long)]
    pub(crate) no_features: bool,
    /// No progress, no remarks; errors only
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Words of `merge`.
#[derive(Args, Debug)]
pub(crate) struct MergeWords {
    /// States of shares of one render, or of renders that differ in their seeds
    #[arg(value_name = "STATE", required = true)]
    pub(crate) states: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) outputs: OutputWords,
    /// State of the whole
    #[arg(long, value_name = "OUT.state")]
    pub(crate) state: Option<PathBuf>,
    /// Where the scene is now, if not where it was
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene: Option<String>,
    /// Worker threads; changes nothing in the picture [default: one a processor]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) threads: Option<u32>,
    /// Most memory that loading the scene may take, for instance 500M or 4G [default: 1G and 64 bytes for each byte of its files]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) max_memory: Option<u64>,
}

impl OutputWords {
    /// The files that will be written.
    pub(crate) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.output, &self.png, &self.stats].into_iter().flatten()
    }

    /// How the PNG is shown.
    pub(crate) fn display(&self) -> Tone {
        Tone {
            exposure: self.exposure,
            curve: self.tone,
        }
    }
}

/// Words of `scenes`.
#[derive(Args, Debug)]
pub(crate) struct SceneWords {
    /// Name of a built-in scene, with parameters as in glass-cube?light=0.8
    #[arg(requires = "export")]
    pub(crate) name: Option<String>,
    /// Write it as glTF
    #[arg(long, value_name = "OUT.glb", requires = "name")]
    pub(crate) export: Option<PathBuf>,
}

/// Words of `methods`.
#[derive(Args, Debug)]
pub(crate) struct MethodWords {
    /// A method's name
    pub(crate) name: Option<Method>,
}

/// Words of `info`.
#[derive(Args, Debug)]
pub(crate) struct InfoWords {
    /// A .gltf or .glb file, or builtin:NAME
    pub(crate) scene: String,
    /// Most memory that loading the scene may take, for instance 500M or 4G [default: 1G and 64 bytes for each byte of its files]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) max_memory: Option<u64>,
}

/// Words of `compare`.
#[derive(Args, Debug)]
pub(crate) struct CompareWords {
    /// Pictures, the reference last
    #[arg(value_name = "IMAGE", num_args = 2.., required = true)]
    pub(crate) images: Vec<PathBuf>,
    /// The other half of the reference: its noise then cancels
    #[arg(long, value_name = "REFERENCE2")]
    pub(crate) half: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Words of `study`.
#[derive(Args, Debug)]
pub(crate) struct StudyWords {
    /// A paper's study (pssmlt, relt, erpt, spatial-target), or a .toml file
    #[arg(value_name = "NAME|FILE.toml")]
    pub(crate) study: String,
    /// A small version: shows that everything works
    #[arg(long, conflicts_with = "as_published")]
    pub(crate) quick: bool,
    /// One figure of the paper, by its number
    #[arg(long, value_name = "N")]
    pub(crate) figure: Option<u32>,
    /// The paper's own sizes and times: hours to days
    #[arg(long)]
    pub(crate) as_published: bool,
    /// Folder for renders, tables, curves and page; a study that was cut goes on in it
    /// [default: study-NAME, with -quick or -as-published]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
    /// No progress
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// `500ms`, `30s`, `5m`, `1h`.
fn duration(text: &str) -> Result<Duration, String> {
    let digits = text.len()
        - text
            .trim_start_matches(|c: char| c.is_ascii_digit() || c == '.')
            .len();
    let (number, unit) = text.split_at(digits);
    let scale = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err("expected a number with ms, s, m or h, for instance 30s".to_owned()),
    };
    number
        .parse::<f64>()
        .ok()
        .and_then(|number| Duration::try_from_secs_f64(number * scale).ok())
        .filter(|duration| !duration.is_zero())
        .ok_or_else(|| "expected a time above 0, for instance 30s".to_owned())
}

/// `X0,Y0,X1,Y1`.
fn window(text: &str) -> Result<Window, String> {
    let numbers: Option<Vec<u32>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Window { x0, y0, x1, y1 }),
        _ => Err("expected X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1".to_owned()),
    }
}

/// `I..J`.
fn ladders(text: &str) -> Result<Range<u32>, String> {
    text.split_once("..")
        .and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?))
        .filter(|range: &Range<u32>| !range.is_empty())
        .ok_or_else(|| "expected I..J with I < J".to_owned())
}

/// `SEED:LADDER:STEP` or `LADDER:STEP`.
fn at(text: &str) -> Result<At, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let at = |seed: Option<&str>, ladder: &str, step: &str| {
        let seed = seed.map(str::parse).transpose().ok()?;
        let ladder = match ladder {
            "lamps" => StepId::LAMPS,
            "meter" => StepId::METER,
            ladder => ladder
                .parse()
                .ok()
                .filter(|&ladder| ladder < StepId::METER)?,
        };
        let step = step.parse().ok()?;
        let place = StepId { ladder, step };
        // Steps are counted, and a chain has to get there.
        (step < 1 << 48).then_some(At { seed, place })
    };
    match *parts {
        [seed, ladder, step] => at(Some(seed), ladder, step),
        [ladder, step] => at(None, ladder, step),
        _ => None,
    }
    .ok_or_else(|| {
        "expected SEED:LADDER:STEP or LADDER:STEP, for instance 0:3:1000; LADDER may be lamps or meter"
            .to_owned()
    })
}

/// `500M`, `4G`, a number of bytes.
fn size(text: &str) -> Result<u64, String> {
    let (number, scale) = match text.as_bytes().last() {
        Some(b'k' | b'K') => (&text[..text.len() - 1], 1u64 << 10),
        Some(b'M') => (&text[..text.len() - 1], 1 << 20),
        Some(b'G') => (&text[..text.len() - 1], 1 << 30),
        _ => (text, 1),
    };
    number
        .parse::<u64>()
        .ok()
        .and_then(|number| number.checked_mul(scale))
        .ok_or_else(|| "expected bytes, or a number with K, M or G".to_owned())
}

/// A number that is one.
fn finite(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| x.is_finite())
        .ok_or_else(|| "expected a number".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_words_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn durations_are_a_number_and_a_unit() {
        assert_eq!(duration("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(duration("1.5m"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("1h"), Ok(Duration::from_secs(3600)));
        for wrong in [
            "",
            "5",
            "s",
            "-1s",
            "1d",
            "0s",
            "1e9h",
            "..s",
            "99999999999999999999h",
        ] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn windows_ladders_places_and_sizes_are_read_or_refused() {
        assert!(window("0,0,4,5").is_ok());
        assert!(window("4,0,4,5").is_err() && window("1,2,3").is_err() && window("").is_err());
        assert_eq!(ladders("2..5"), Ok(2..5));
        let place = |seed, ladder| At {
            seed,
            place: StepId { ladder, step: 3 },
        };
        assert_eq!(at("1:2:3"), Ok(place(Some(1), 2)));
        assert_eq!(at("2:3"), Ok(place(None, 2)));
        assert_eq!(at("lamps:3"), Ok(place(None, StepId::LAMPS)));
        assert_eq!(at("meter:3"), Ok(place(None, StepId::METER)));
        assert_eq!(
            at("1:lamps:3").map(|at| at.place.to_string()),
            Ok("lamps:3".to_owned())
        );
        for wrong in [
            "",
            "3",
            "1:2:3:4",
            "-1:2:3",
            "1:99999999999:3",
            "1:4294967295:3",
            "lamps:2:3",
            "1:2:999999999999999",
        ] {
            assert!(at(wrong).is_err(), "{wrong}");
        }
        assert!(ladders("5..5").is_err() && ladders("5").is_err());
        assert_eq!(size("2G"), Ok(2 << 30));
        assert!(size("99999999999999999G").is_err() && size("G").is_err() && size("é").is_err());
    }
}
