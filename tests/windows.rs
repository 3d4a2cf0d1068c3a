//! Methods against each other, window by window of the image.
//!
//! Where most of the noise of an image is in a few of its tiles, renders of the whole image that
//! bring those to half a percent spend most of their time on the others. Here each method renders
//! windows (`crop`) of the image, first for as short as each other, then for as long as the spread over the seeds
//! so far says. What decides how long is the spread alone; means are looked at in the end.

use std::path::PathBuf;
use std::{fmt, fs};

use kaustik::film::Window;
use kaustik::scene::Scene;
use kaustik::{Method, RenderSettings};

use crate::support::{
    TILE, Tile, Verdict, agree, by_tile, is_wanted, keep, kept_file, picture, scene, settings,
    shown_by_light, tile_means,
};

const SIDE: usize = 64;
/// Tiles along a side of the image.
pub(crate) const TILES: usize = SIDE / TILE;
/// Most independent seeds of a look.
pub(crate) const SEEDS: usize = 32;
/// Tiles whose error may be larger.
pub(crate) const SPARED: usize = 3;

/// How long contenders are rendered.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    /// Independent seeds of each.
    pub(crate) seeds: usize,
    /// The first of them.
    pub(crate) first: u64,
    /// Until each two whose errors allow it are known to this share in all tiles but [`SPARED`].
    pub(crate) share: f64,
    /// Or until they have been asked for more so often.
    pub(crate) rounds: usize,
}

impl Look {
    /// The same with seeds that had no part in it.
    pub(crate) const fn afresh(self) -> Self {
        Self {
            first: 1 << 40,
            ..self
        }
    }
}

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
#[derive(Clone, Copy)]
pub(crate) struct Contender {
    pub(crate) method: Method,
    /// What tells its settings from those of others of the same method.
    pub(crate) variant: &'static str,
    /// Tiles along a side of a window.
    pub(crate) block: usize,
    /// Samples a pixel of each window at first.
    pub(crate) first: u64,
    /// Standard error of a tile's mean, relative, that it is to reach by itself.
    pub(crate) error: f64,
    pub(crate) change: fn(&mut RenderSettings),
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

    /// A look at other seeds has files of its own.
    fn file(&self, words: &str, first_seed: u64) -> Option<PathBuf> {
        let again = if first_seed == 0 { "" } else { " again" };
        kept_file(&format!("{words} {self} by {}{again}", self.block))
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
    first_seed: u64,
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
        settings.seed =
            self.first_seed + seed as u64 + SEEDS as u64 * self.tally.spent[seed][block];
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
        let Some(file) = self.contender.file(self.words, self.first_seed) else {
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

/// The first and, of the others, those that are wanted.
pub(crate) fn wanted(contenders: &[Contender]) -> Vec<Contender> {
    (contenders.iter().enumerate())
        .filter(|(index, contender)| *index == 0 || is_wanted(contender.method))
        .map(|(_, contender)| *contender)
        .collect()
}

/// Renders as long as the look says; the verdicts on each two contenders.
#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
pub(crate) fn compare(
    words: &str,
    contenders: &[Contender],
    look: Look,
) -> Vec<([Contender; 2], Verdict)> {
    let share = look.share;
    let scene = scene(words, SIDE as u32);
    let all = vec![true; TILES * TILES];
    let light = shown_by_light(&scene, SIDE as u32);
    let entry = |contender| enter(contender, words, look, &scene, [&all, &light]);
    let mut entries: Vec<Entry> = contenders.iter().map(entry).collect();
    let mut round = 0;
    loop {
        round += 1;
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
                verdicts.push(([*a.contender, *b.contender], verdict));
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
        let known = verdicts.iter().all(|(_, v)| v.uncertain.len() <= SPARED);
        if enough || known || round == look.rounds {
            return verdicts;
        }
    }
}

fn enter<'a>(
    contender: &'a Contender,
    words: &'a str,
    look: Look,
    scene: &'a Scene,
    [all, light]: [&'a [bool]; 2],
) -> Entry<'a> {
    let (blocks, seeds) = (contender.blocks(), look.seeds);
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
    let kept = (contender.file(words, look.first)).and_then(|file| fs::read_to_string(file).ok());
    Entry {
        contender,
        words,
        scene,
        shown: match contender.method {
            Method::Light => light,
            _ => all,
        },
        first_seed: look.first,
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

/// Asserts that no tile of a verdict differs that `differs` counts. One comparison of equal methods in a hundred is
/// rejected by chance: seeds that had no part in it tell. A fault is there again.
pub(crate) fn assert_equal(
    words: &str,
    (pair, verdict): &([Contender; 2], Verdict),
    look: Look,
    differs: impl Fn(&Verdict) -> Vec<usize>,
) {
    if differs(verdict).is_empty() {
        return;
    }
    for (_, again) in compare(words, pair, look.afresh()) {
        let found = differs(&again);
        assert!(
            found.is_empty(),
            "{words}, {}: {verdict:?}, {again:?}",
            pair[1]
        );
    }
}

/// Asserts that no tile that is known differs between the first contender and any other that is wanted, and that so many are known.
pub(crate) fn assert_known_equal(
    words: &str,
    contenders: &[Contender],
    look: Look,
    least_known: usize,
) {
    let told = compare(words, &wanted(contenders), look);
    for told in with_the_first(told, contenders) {
        let ([_, rival], verdict) = &told;
        let known = TILES * TILES - verdict.uncertain.len();
        assert!(known >= least_known, "{words}, {rival}: {verdict:?}");
        assert_equal(words, &told, look, Verdict::known_to_differ);
    }
}

/// Of verdicts on each two those on the first contender, whose method no other has, and another.
pub(crate) fn with_the_first(
    told: Vec<([Contender; 2], Verdict)>,
    contenders: &[Contender],
) -> impl Iterator<Item = ([Contender; 2], Verdict)> {
    let first = contenders[0].method;
    told.into_iter()
        .filter(move |(pair, _)| pair[0].method == first)
}
