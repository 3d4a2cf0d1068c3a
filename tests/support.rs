//! What the tests of whole renders share: scenes, renders, tiles, what these tell.

mod verdict;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use glam::{Affine3A, Quat, Vec3};
use kaustik::film::Image;
use kaustik::geometry::Mesh;
use kaustik::path::features;
use kaustik::scene::description::{
    CameraDescription, InstanceDescription, LightDescription, LightKind, MaterialDescription,
    Projection, Specular,
};
use kaustik::scene::{Description, Scene, SceneOptions, builtin};
use kaustik::{Budget, Builder, Control, Method, Normaliser, RenderSettings, Starts, render};

pub(crate) use verdict::{Difference, Runs, Tile, Verdict, agree};

/// A built-in scene with its camera for a square image.
pub(crate) fn scene(words: &str, side: u32) -> Scene {
    compile(&builtin::load(words).expect("a built-in scene"), side)
}

/// A description with its camera for a square image.
pub(crate) fn compile(description: &Description, side: u32) -> Scene {
    let options = SceneOptions {
        width: side,
        height: side,
        ..SceneOptions::default()
    };
    Scene::new(description, &options).expect("a sound scene")
}

/// Diffuse, without any gloss.
pub(crate) fn paint([r, g, b]: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        specular: Specular {
            factor: 0.0,
            texture: None,
            color: [1.0; 3],
            color_texture: None,
        },
        ..MaterialDescription::default()
    }
}

/// A square that looks along the z axis, from `-half` to `half` around a place.
pub(crate) fn square(centre: Vec3, half: f32) -> Mesh {
    let corner = |x: f32, y: f32| centre + half * Vec3::new(x, y, 0.0);
    Mesh {
        positions: vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A pinhole camera that looks down -z, and things that stand where their meshes say.
pub(crate) fn describe(
    eye: Vec3,
    yfov: f32,
    things: impl IntoIterator<Item = (MaterialDescription, Mesh)>,
) -> Description {
    let mut description = Description::default();
    description.cameras.push(CameraDescription {
        name: "camera".to_owned(),
        transform: Affine3A::from_translation(eye),
        projection: Projection::Perspective {
            yfov,
            aspect_ratio: None,
        },
        lens: None,
        shutter: None,
    });
    for (index, (material, mesh)) in things.into_iter().enumerate() {
        description.instances.push(InstanceDescription {
            name: format!("instance {index}"),
            mesh: index,
            material: Some(index),
            transform: Affine3A::IDENTITY,
        });
        description.materials.push(material);
        description.meshes.push(Arc::new(mesh));
    }
    description
}

/// Settings for a small square image without feature layers.
pub(crate) fn settings(method: Method, side: u32, spp: u64) -> RenderSettings {
    let mut settings = RenderSettings {
        method,
        width: side,
        height: side,
        budget: Budget::PerPixel(spp),
        max_depth: 12,
        features: false,
        ..RenderSettings::default()
    };
    settings.options.pilot = 5_000;
    settings.options.particles = 1_000;
    // from each sample, so that there is little chance in how many there are
    (settings.options.chains, settings.options.length) = (Some(1.0), 8);
    settings.options.photon.photons = Some(2_000);
    settings.options.photon.burn_in = Some(4);
    settings
}

/// Where a path tracer seldom finds the light: paths from both sides, and starts that know of all light.
pub(crate) fn from_both_sides(settings: &mut RenderSettings) {
    let options = &mut settings.options;
    match settings.method {
        Method::Pssmlt => (options.builder, options.p_large) = (Builder::Bidirectional, 0.6),
        // A sample shows one strategy: it takes more of them until starts know of all light. What scales the picture by the same
        // samples is unbiased for any number of them.
        Method::Mmlt => (options.pilot, options.normaliser) = (1_000_000, Normaliser::Initial),
        Method::Erpt => options.seeds = Starts::Bidirectional,
        Method::ErptPss => options.builder = Builder::Bidirectional,
        _ => {}
    }
}

/// The picture of a render.
pub(crate) fn picture(scene: &Scene, settings: &RenderSettings) -> Image {
    render(scene, settings, &mut Control::default())
        .expect("a render")
        .image
}

/// Mean over all pixels of each channel.
pub(crate) fn means(image: &Image) -> [f64; 3] {
    image
        .rgb()
        .map(|plane| plane.iter().map(|&v| f64::from(v)).sum::<f64>() / plane.len() as f64)
}

/// Parallel white light along an axis of length 1, of this irradiance on what faces it.
pub(crate) fn sun(axis: Vec3, irradiance: f64) -> LightDescription {
    LightDescription {
        name: "sun".to_owned(),
        kind: LightKind::Directional,
        color: [1.0; 3],
        intensity: irradiance as f32,
        range: None,
        transform: Affine3A::from_quat(Quat::from_rotation_arc(Vec3::NEG_Z, axis)),
    }
}

/// Mean over all pixels and channels of the light of paths of two edges at most, by every method.
pub(crate) fn direct_light_by_all(scene: &Scene, side: u32) -> Vec<(Method, f64)> {
    let mean = |method: Method| {
        // Of light walks few come to what little is seen.
        let spp = if method == Method::Light { 4_096 } else { 256 };
        let mut settings = RenderSettings {
            max_depth: 2,
            ..settings(method, side, spp)
        };
        from_both_sides(&mut settings);
        // By seed 2000 light paths an iteration differ by 2 % with chains.
        settings.options.photon.photons = Some(10_000);
        settings.options.photon.reduction = None;
        let [r, g, b] = means(&picture(scene, &settings));
        (method, (r + g + b) / 3.0)
    };
    Method::ALL.into_iter().map(mean).collect()
}

/// Means of square groups of tiles, `finer` along a side, from those of tiles row by row.
pub(crate) fn merged(tiles: &[[f64; 3]], columns: usize, finer: usize) -> Vec<[f64; 3]> {
    let across = columns / finer;
    let mut means = vec![[0.0; 3]; tiles.len() / (finer * finer)];
    for (index, tile) in tiles.iter().enumerate() {
        let (x, y) = (index % columns, index / columns);
        for (sum, value) in means[y / finer * across + x / finer].iter_mut().zip(tile) {
            *sum += value / (finer * finer) as f64;
        }
    }
    means
}

/// Pixels, row by row, that a light tracer shows in full: what they see first is neither Dirac
/// nor the environment.
pub(crate) fn pixels_of_light(scene: &Scene, side: u32) -> Vec<bool> {
    let mut shown = vec![true; (side * side) as usize];
    // A few points a pixel; edges of Dirac surfaces are thinner than nothing.
    let points = side * 4;
    for y in 0..points {
        for x in 0..points {
            let raster = [x, y].map(|i| (f64::from(i) + 0.5) / f64::from(points));
            let beyond = features(scene, raster.into(), 0.5).beyond_light_tracing;
            shown[(y / 4 * side + x / 4) as usize] &= !beyond;
        }
    }
    shown
}

/// Side of a tile in pixels.
pub(crate) const TILE: usize = 8;

/// Tile means of an image, three channels a tile, row by row.
pub(crate) fn tile_means(image: &Image) -> Vec<[f64; 3]> {
    let columns = image.width() as usize / TILE;
    let rows = image.height() as usize / TILE;
    let mut tiles = vec![[0.0; 3]; columns * rows];
    for (channel, plane) in image.rgb().iter().enumerate() {
        for (index, &value) in plane.iter().enumerate() {
            let (x, y) = (
                index % image.width() as usize,
                index / image.width() as usize,
            );
            tiles[y / TILE * columns + x / TILE][channel] +=
                f64::from(value) / (TILE * TILE) as f64;
        }
    }
    tiles
}

/// Tiles that a light tracer shows in full.
pub(crate) fn shown_by_light(scene: &Scene, side: u32) -> Vec<bool> {
    let side_of_tiles = side as usize / TILE;
    let mut shown = vec![true; side_of_tiles * side_of_tiles];
    for (pixel, seen) in pixels_of_light(scene, side).into_iter().enumerate() {
        let (x, y) = (pixel % side as usize, pixel / side as usize);
        shown[y / TILE * side_of_tiles + x / TILE] &= seen;
    }
    shown
}

/// Tile means of several seeds.
pub(crate) fn tiles_of_seeds(
    scene: &Scene,
    settings: &RenderSettings,
    seeds: std::ops::Range<u64>,
) -> Vec<Tile> {
    tiles_of(seeds.map(|seed| of_seed(scene, settings, seed)))
}

fn of_seed(scene: &Scene, settings: &RenderSettings, seed: u64) -> Image {
    picture(
        scene,
        &RenderSettings {
            seed,
            ..settings.clone()
        },
    )
}

/// As [`tiles_of_seeds`], but what `KAUSTIK_KEEP` names as a folder keeps each seed's tiles under
/// `name` and a later run reads them: hours can be spent in pieces. One folder for one state of
/// the sources.
pub(crate) fn kept_tiles_of_seeds(
    name: &str,
    scene: &Scene,
    settings: &RenderSettings,
    seeds: std::ops::Range<u64>,
) -> Vec<Tile> {
    let Some(file) = kept_file(name) else {
        return tiles_of_seeds(scene, settings, seeds);
    };
    let text = fs::read_to_string(&file).unwrap_or_else(|_| "{}".to_owned());
    let mut kept: BTreeMap<u64, Vec<[f64; 3]>> = serde_json::from_str(&text).expect("kept tiles");
    for seed in seeds.clone() {
        if let Entry::Vacant(vacant) = kept.entry(seed) {
            vacant.insert(tile_means(&of_seed(scene, settings, seed)));
            keep(&file, &serde_json::to_string(&kept).expect("numbers"));
        }
    }
    by_tile(&seeds.map(|seed| kept[&seed].clone()).collect::<Vec<_>>())
}

/// Whoever has little time names some of the methods that are held against the first: `KAUSTIK_METHODS=light,pssmlt`.
pub(crate) fn is_wanted(method: Method) -> bool {
    let named = |word: &str| {
        word.parse::<Method>()
            .expect("KAUSTIK_METHODS names methods")
            == method
    };
    std::env::var("KAUSTIK_METHODS").map_or(true, |words| words.split(',').any(named))
}

/// What the folder `KAUSTIK_KEEP` names keeps under this name; `None` if it names none.
pub(crate) fn kept_file(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("KAUSTIK_KEEP")?;
    let plain = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
    Some(Path::new(&folder).join(format!("{plain}.json")))
}

/// Puts a text in the place of a kept file, as a whole.
pub(crate) fn keep(file: &Path, text: &str) {
    let beside = file.with_extension("new");
    fs::write(&beside, text).expect("the folder KAUSTIK_KEEP names");
    fs::rename(&beside, file).expect("the folder KAUSTIK_KEEP names");
}

/// Tile means of independent pictures.
pub(crate) fn tiles_of(pictures: impl Iterator<Item = Image>) -> Vec<Tile> {
    by_tile(&pictures.map(|image| tile_means(&image)).collect::<Vec<_>>())
}

/// What each number gives, in their order; as many at a time as the machine has threads.
pub(crate) fn side_by_side<T: Send>(
    numbers: std::ops::Range<u64>,
    of: impl Fn(u64) -> T + Sync,
) -> Vec<T> {
    let next = AtomicU64::new(numbers.start);
    let worker = || {
        let number = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|n| *n < numbers.end);
        std::iter::from_fn(|| number().map(|n| (n, of(n)))).collect::<Vec<_>>()
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<(u64, T)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let join = |worker: thread::ScopedJoinHandle<'_, _>| worker.join().expect("a worker");
        workers.into_iter().flat_map(join).collect()
    });
    all.sort_unstable_by_key(|(number, _)| *number);
    all.into_iter().map(|(_, given)| given).collect()
}

/// Tiles of runs that are given as means of tiles.
pub(crate) fn by_tile(runs: &[Vec<[f64; 3]>]) -> Vec<Tile> {
    let of = |tile| Tile::of(&runs.iter().map(|run| run[tile]).collect::<Vec<_>>());
    (0..runs[0].len()).map(of).collect()
}
