//! Agreement tile by tile: each block of tiles is rendered as long as its noise asks for.
//!
//! Where most of the noise of an image is in a few of its tiles, renders of the whole image that
//! bring those to half a percent spend most of their time on the others. Here each method renders
//! windows (`crop`) of the image, first for as short as each other, then for as long as the spread over the seeds
//! so far says. What decides how long is the spread alone; means are looked at in the end.

use std::path::PathBuf;
use std::{fmt, fs};

use kaustik::film::Window;
use kaustik::scene::Scene;
use kaustik::{Builder, Method, RenderSettings, Starts};

use crate::support::{
    TILE, Tile, Verdict, agree, by_tile, keep, kept_file, picture, scene, settings, shown_by_light,
    tile_means,
};

const SIDE: usize = 64;
/// Tiles along a side of the image.
const TILES: usize = SIDE / TILE;
/// Independent seeds.
const SEEDS: usize = 32;
/// Tiles whose error may be larger.
const SPARED: usize = 3;

/// What has been rendered.
struct Tally {
    /// Samples a pixel of each block that each seed is to have.
    wanted: Vec<u64>,
    /// What each seed has of them, by block.
    spent: Vec<Vec<u64>>,
    /// Sums over samples of each tile's mean, by seed.
    sums: Vec<Vec<[f64; 3]>>,
}

/// A method and how it is to be rendered.
struct Contender {
    method: Method,
    /// What tells its settings from those of others of the same method.
    variant: &'static str,
    /// Tiles along a side of a window.
    block: usize,
    /// Samples a pixel of each window at first.
    first: u64,
    /// Standard error of a tile's mean, relative, that it is to reach by itself.
    error: f64,
    change: fn(&mut RenderSettings),
}

impl Contender {
    fn blocks(&self) -> usize {
        (TILES / self.block).pow(2)
    }

    fn block_of(&self, tile: usize) -> usize {
        let (x, y) = (tile % TILES, tile / TILES);
        y / self.block * (TILES / self.block) + x / self.block
    }

    fn window(&self, block: usize) -> Window {
        let (columns, side) = (TILES / self.block, self.block * TILE);
        let [x0, y0] = [block % columns, block / columns].map(|i| (i * side) as u32);
        let side = side as u32;
        Window {
            x0,
            y0,
            x1: x0 + side,
            y1: y0 + side,
        }
    }

    fn file(&self, words: &str) -> Option<PathBuf> {
        kept_file(&format!("{words} {self} by {}", self.block))
    }
}

impl fmt::Display for Contender {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}{}", self.method, self.variant)
    }
}

/// A contender at work on a scene.
struct Entry<'a> {
    contender: &'a Contender,
    words: &'a str,
    scene: &'a Scene,
    /// Tiles that it shows in full.
    shown: &'a [bool],
    tally: Tally,
}

impl Entry<'_> {
    /// Renders what the windows still are to have; what a folder keeps is not rendered again.
    fn render(&mut self) {
        for seed in 0..self.tally.spent.len() {
            for block in 0..self.contender.blocks() {
                let (wanted, had) = (self.tally.wanted[block], self.tally.spent[seed][block]);
                if wanted > had {
                    self.render_block(seed, block, wanted - had);
                }
            }
            self.keep();
        }
    }

    fn render_block(&mut self, seed: usize, block: usize, spp: u64) {
        let Contender { method, change, .. } = *self.contender;
        let mut settings = RenderSettings {
            crop: Some(self.contender.window(block)),
            ..settings(method, SIDE as u32, spp)
        };
        change(&mut settings);
        // Samples of their own for what is added later.
        settings.seed = seed as u64 + SEEDS as u64 * self.tally.spent[seed][block];
        let means = tile_means(&picture(self.scene, &settings));
        let mine = (0..TILES * TILES).filter(|&tile| self.contender.block_of(tile) == block);
        for (tile, mean) in mine.zip(means) {
            for (sum, mean) in self.tally.sums[seed][tile].iter_mut().zip(mean) {
                *sum += mean * spp as f64;
            }
        }
        self.tally.spent[seed][block] += spp;
    }

    fn keep(&self) {
        let Some(file) = self.contender.file(self.words) else {
            return;
        };
        let Tally {
            wanted,
            spent,
            sums,
        } = &self.tally;
        let text = serde_json::to_string(&(wanted, spent, sums)).expect("numbers");
        keep(&file, &text);
    }

    fn tiles(&self) -> Vec<Tile> {
        let Tally { spent, sums, .. } = &self.tally;
        let mean = |seed: usize, tile: usize| {
            let spp = spent[seed][self.contender.block_of(tile)] as f64;
            sums[seed][tile].map(|sum| sum / spp)
        };
        let run = |seed| (0..TILES * TILES).map(|tile| mean(seed, tile)).collect();
        by_tile(&(0..spent.len()).map(run).collect::<Vec<Vec<_>>>())
    }

    /// Samples a pixel of each tile with which its error would be the wanted one.
    fn needs(&self) -> Vec<f64> {
        let need = |(tile, is): (usize, &Tile)| {
            let block = self.contender.block_of(tile);
            let error = is.luminance.variance.sqrt() / is.luminance.mean;
            let seen = self.shown[tile] && is.luminance.mean > 0.0;
            let spp = self.tally.wanted[block] as f64 * (error / self.contender.error).powi(2);
            if seen { spp } else { 0.0 }
        };
        self.tiles().iter().enumerate().map(need).collect()
    }

    /// Asks for more where there is too little; at most three times what there is, whose spread may mislead.
    fn ask(&mut self, spared: &[usize]) {
        let needs = self.needs();
        for block in 0..self.contender.blocks() {
            let mine =
                |tile: &usize| self.contender.block_of(*tile) == block && !spared.contains(tile);
            let tiles = (0..TILES * TILES).filter(mine);
            let need = tiles.map(|tile| needs[tile]).fold(0.0, f64::max);
            let had = self.tally.wanted[block];
            if need > had as f64 {
                // A tenth more, so that the next look finds enough.
                self.tally.wanted[block] = ((need * 1.1) as u64).clamp(had + had / 10, had * 3);
            }
        }
    }
}

/// Renders until each two contenders whose errors allow it are known to `share` in all tiles but [`SPARED`]; the
/// verdicts.
#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
fn compare(words: &str, contenders: &[Contender], seeds: usize, share: f64) -> Vec<Verdict> {
    let scene = scene(words, SIDE as u32);
    let all = vec![true; TILES * TILES];
    let light = shown_by_light(&scene, SIDE as u32);
    let entry = |contender| enter(contender, words, seeds, &scene, [&all, &light]);
    let mut entries: Vec<Entry> = contenders.iter().map(entry).collect();
    loop {
        entries.iter_mut().for_each(Entry::render);
        let tiles: Vec<Vec<Tile>> = entries.iter().map(Entry::tiles).collect();
        let mut verdicts = Vec::new();
        for (i, a) in entries.iter().enumerate() {
            for (j, b) in entries.iter().enumerate().skip(i + 1) {
                let mut verdict = agree(&tiles[i], &tiles[j], |t| a.shown[t] && b.shown[t], share);
                println!(
                    "{words}: {} and {}: differ in {:?}, worst error {:.4}, above {share}: {:?}",
                    a.contender,
                    b.contender,
                    verdict.rejected,
                    verdict.worst_error,
                    verdict.uncertain
                );
                // Two that are known less well can be told apart all the same.
                if a.contender.error.hypot(b.contender.error) > share {
                    verdict.uncertain.clear();
                }
                verdicts.push(verdict);
            }
        }
        let spared = hardest(&entries);
        let had: Vec<Vec<u64>> = entries.iter().map(|e| e.tally.wanted.clone()).collect();
        println!("samples a pixel of each window: {had:?}");
        entries.iter_mut().for_each(|entry| entry.ask(&spared));
        let enough = entries
            .iter()
            .zip(had)
            .all(|(e, had)| e.tally.wanted == had);
        if enough || verdicts.iter().all(|v| v.uncertain.len() <= SPARED) {
            return verdicts;
        }
    }
}

fn enter<'a>(
    contender: &'a Contender,
    words: &'a str,
    seeds: usize,
    scene: &'a Scene,
    [all, light]: [&'a [bool]; 2],
) -> Entry<'a> {
    let blocks = contender.blocks();
    let fresh = || Tally {
        wanted: vec![contender.first; blocks],
        spent: vec![vec![0; blocks]; seeds],
        sums: vec![vec![[0.0; 3]; TILES * TILES]; seeds],
    };
    let of_text = |text: String| {
        let (wanted, spent, sums) = serde_json::from_str(&text).expect("a tally");
        Tally {
            wanted,
            spent,
            sums,
        }
    };
    let kept = (contender.file(words)).and_then(|file| fs::read_to_string(file).ok());
    Entry {
        contender,
        words,
        scene,
        shown: match contender.method {
            Method::Light => light,
            _ => all,
        },
        tally: kept.map_or_else(fresh, of_text),
    }
}

/// The tiles that would take longest.
fn hardest(entries: &[Entry]) -> Vec<usize> {
    let mut total = vec![0.0; TILES * TILES];
    for entry in entries {
        for (total, need) in total.iter_mut().zip(entry.needs()) {
            *total += need;
        }
    }
    let mut order: Vec<usize> = (0..TILES * TILES).collect();
    order.sort_by(|&a, &b| total[b].total_cmp(&total[a]));
    order.truncate(SPARED);
    order
}

const PATH: Contender = Contender {
    method: Method::Path,
    variant: "",
    block: 1,
    first: 300,
    error: 0.0027,
    change: |_| {},
};

/// A chain must have more than one tile in its window: the light of a window as a whole it knows from
/// independent samples.
const PSSMLT: Contender = Contender {
    method: Method::Pssmlt,
    variant: "",
    block: 2,
    first: 1_000,
    error: 0.0042,
    // Its own acceptance does little where independent samples seldom find the light.
    change: |settings| {
        settings.options.p_large = 0.9;
        settings.options.pilot = 100_000;
    },
};

const BDPT: Contender = Contender {
    method: Method::Bdpt,
    first: 200,
    ..PATH
};

const LIGHT: Contender = Contender {
    method: Method::Light,
    variant: "",
    block: TILES,
    first: 200,
    error: 0.0025,
    change: |_| {},
};

/// Chains on paths: a window of a quarter, so that each has room for its caustics.
const MLT: Contender = Contender {
    method: Method::Mlt,
    variant: "",
    block: TILES / 2,
    first: 1_000,
    error: 0.0042,
    change: |settings| settings.options.pilot = 100_000,
};

const ERPT: Contender = Contender {
    method: Method::Erpt,
    first: 100,
    ..MLT
};

const ERPT_PSS: Contender = Contender {
    method: Method::ErptPss,
    first: 50,
    ..MLT
};

/// Redistribution is as uncertain as the samples that it starts from: where a path tracer seldom meets the light,
/// they are bidirectional.
const ERPT_BIDIRECTIONAL: Contender = Contender {
    variant: " bidirectional",
    change: |settings| {
        (ERPT.change)(settings);
        settings.options.seeds = Starts::Bidirectional;
    },
    ..ERPT
};

const ERPT_PSS_BIDIRECTIONAL: Contender = Contender {
    variant: " bidirectional",
    change: |settings| {
        (ERPT_PSS.change)(settings);
        settings.options.builder = Builder::Bidirectional;
    },
    ..ERPT_PSS
};

#[test]
fn windows_agree_roughly_and_a_missing_bounce_is_found() {
    let short = |contender, first| Contender {
        first,
        error: 0.1,
        ..contender
    };
    let path = short(PATH, 8);
    let chain = Contender {
        change: |_| {},
        ..short(PSSMLT, 64)
    };
    for verdict in compare("cornell", &[path, chain, short(LIGHT, 16)], 8, 0.2) {
        assert!(verdict.rejected.is_empty(), "{verdict:?}");
        assert!(verdict.uncertain.len() <= SPARED, "{verdict:?}");
    }
    let cut = Contender {
        change: |settings| settings.max_depth = 2,
        ..short(LIGHT, 16)
    };
    let verdicts = compare("cornell", &[short(PATH, 8), cut], 8, 0.2);
    assert!(!verdicts[0].rejected.is_empty(), "{verdicts:?}");
}

/// Each two agree, and are known to half a percent if their errors are to be so small together.
fn assert_agreement(words: &str, contenders: &[Contender]) {
    for verdict in compare(words, contenders, SEEDS, 0.005) {
        assert!(verdict.rejected.is_empty(), "{verdict:?}");
        assert!(verdict.uncertain.len() <= SPARED, "{verdict:?}");
    }
}

#[test]
#[ignore = "hours; KAUSTIK_KEEP keeps what is done"]
fn path_light_and_pssmlt_agree_on_water() {
    assert_agreement("water-cornell?light=0.8", &[PATH, PSSMLT, LIGHT]);
}

/// One long test a scene: chains on paths and redistribution against independent bidirectional paths.
macro_rules! mutations_agree_on {
    ($($name:ident: $words:literal, $erpt:expr, $erpt_pss:expr;)*) => {$(
        #[test]
        #[ignore = "long; KAUSTIK_KEEP keeps what is done"]
        fn $name() {
            assert_agreement($words, &[BDPT, MLT, $erpt, $erpt_pss]);
        }
    )*};
}

mutations_agree_on! {
    mutations_agree_on_cornell: "cornell", ERPT, ERPT_PSS;
    mutations_agree_on_direct_light: "cornell-direct", ERPT, ERPT_PSS;
    mutations_agree_on_indirect_light: "cornell-indirect", ERPT_BIDIRECTIONAL, ERPT_PSS_BIDIRECTIONAL;
    mutations_agree_on_ring_and_sphere: "ring-and-sphere?light=0.8", ERPT_BIDIRECTIONAL, ERPT_PSS_BIDIRECTIONAL;
    mutations_agree_on_glass_cube: "glass-cube?light=0.8", ERPT_BIDIRECTIONAL, ERPT_PSS_BIDIRECTIONAL;
    mutations_agree_on_water: "water-cornell?light=0.8", ERPT_BIDIRECTIONAL, ERPT_PSS_BIDIRECTIONAL;
}

#[test]
#[ignore = "hours; KAUSTIK_KEEP keeps what is done"]
fn path_and_bdpt_agree_on_water() {
    assert_agreement("water-cornell?light=0.8", &[PATH, BDPT]);
}
