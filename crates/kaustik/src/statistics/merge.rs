use std::ops::Range;

use kaustik_film::{Image, Layer};
use serde::Serialize;

use crate::RenderStatistics;

/// What parts that were merged say about each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MergeStatistics {
    /// What they differ in.
    pub of: Parts,
    /// The parts, by seed and ladders.
    pub parts: Vec<MergedPart>,
    /// Mean luminance over the pixels of the picture; `None` where parts tell of different pixels.
    pub luminance: Option<f64>,
    /// Its standard error, from the spread of the parts; `None` if it is not known.
    pub luminance_error: Option<f64>,
    /// Root mean square of the pixels' standard errors (layer `error`), over the mean of all channels.
    pub pixel_error: Option<f64>,
    /// Why errors are not known.
    pub unknown: Option<String>,
}

/// What parts differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Parts {
    /// Renders that have nothing in common.
    Seeds,
    /// Shares of one render: their pilot is the same, and what it got wrong they all have.
    Ladders,
}

/// One part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MergedPart {
    /// Its seed.
    pub seed: u64,
    /// Its first ladder and the one after its last.
    pub ladders: [u32; 2],
    /// Its samples or mutations: the weight that it has.
    pub steps: u64,
    /// Mean luminance over its pixels.
    pub luminance: f64,
    /// Mean over all channels of its pixels.
    #[serde(skip)]
    channels: f64,
}

impl MergedPart {
    pub(crate) fn new(seed: u64, ladders: &Range<u32>, steps: u64, image: &Image) -> Self {
        let mean = |plane: &[f32]| {
            let sum: f64 = plane.iter().map(|&v| f64::from(v)).sum();
            sum / plane.len().max(1) as f64
        };
        let [r, g, b] = image.rgb().map(mean);
        Self {
            seed,
            ladders: [ladders.start, ladders.end],
            steps,
            // Rec.709
            luminance: 0.2126 * r + 0.7152 * g + 0.0722 * b,
            channels: (r + g + b) / 3.0,
        }
    }
}

impl MergeStatistics {
    /// Of parts that tell of the same pixels. Their errors are known if the largest has at most `comparable` times the
    /// samples of the smallest.
    pub(crate) fn new(of: Parts, parts: Vec<MergedPart>, comparable: f64) -> Self {
        let steps = parts.iter().map(|part| part.steps);
        let (least, most) = (steps.clone().min(), steps.max());
        let (least, most) = (least.unwrap_or(0), most.unwrap_or(0));
        let weight: f64 = parts.iter().map(|part| part.steps as f64).sum();
        let terms = parts.iter().map(|part| part.steps as f64 * part.luminance);
        let luminance = terms.sum::<f64>() / weight.max(1.0);
        let squares = (parts.iter())
            .map(|part| part.steps as f64 * (part.luminance - luminance).powi(2))
            .sum::<f64>();
        let freedom = parts.len().saturating_sub(1) as f64;
        let unknown = if parts.len() < 2 {
            Some("there is one part".to_owned())
        } else if most as f64 > comparable * least as f64 {
            Some(format!(
                "the largest part has {most} samples, the smallest {least}: more than {comparable} times as many"
            ))
        } else {
            None
        };
        Self {
            luminance_error: (unknown.is_none())
                .then(|| (squares / (weight.max(1.0) * freedom)).sqrt()),
            of,
            parts,
            luminance: Some(luminance),
            pixel_error: None,
            unknown,
        }
    }

    /// Of parts that tell nothing of each other.
    pub(crate) fn without(of: Parts, why: &str) -> Self {
        Self {
            of,
            parts: Vec::new(),
            luminance: None,
            luminance_error: None,
            pixel_error: None,
            unknown: Some(why.to_owned()),
        }
    }

    pub(crate) fn is_told(&self) -> bool {
        self.unknown.is_none()
    }

    /// Takes what the pixels say.
    pub(crate) fn see(&mut self, errors: &Layer) {
        let samples = errors.channels.iter().flat_map(|channel| &channel.samples);
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for &sample in samples {
            squares += f64::from(sample).powi(2);
            count += 1.0;
        }
        let weight: f64 = self.parts.iter().map(|part| part.steps as f64).sum();
        let channels = self
            .parts
            .iter()
            .map(|part| part.steps as f64 * part.channels);
        let mean = channels.sum::<f64>() / weight.max(1.0);
        if mean > 0.0 {
            self.pixel_error = Some((squares / count.max(1.0)).sqrt() / mean);
        }
    }

    /// What whoever looks at the picture should know.
    pub fn notices(&self) -> Vec<String> {
        let of = match self.of {
            Parts::Seeds => "renders of other seeds",
            Parts::Ladders => "shares",
        };
        if let Some(why) = &self.unknown {
            return vec![format!("note: no errors from the spread of {of}: {why}")];
        }
        let error = self.luminance_error.unwrap_or(0.0);
        let luminance = self.luminance.unwrap_or(0.0);
        let percent = 100.0 * error / luminance.max(f64::MIN_POSITIVE);
        let pixels = self.pixel_error.map_or(String::new(), |error| {
            format!("; a pixel's error is {:.2} % of the mean", 100.0 * error)
        });
        vec![format!(
            "{} {of}: mean luminance {luminance:.6} +- {error:.6} ({percent:.3} %){pixels}",
            self.parts.len()
        )]
    }
}

impl RenderStatistics {
    /// Adds another render's, of another seed: what adds up, and without what does not.
    pub(crate) fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.planned = None;
        self.per_pixel += other.per_pixel;
        self.seconds += other.seconds;
        self.pilot_seconds += other.pilot_seconds;
        self.start_share = self.start_share.min(other.start_share);
        self.nonfinite += other.nonfinite;
        self.film = crate::engine::add_counters(self.film, other.film);
        self.rays = match (self.rays, other.rays) {
            (Some(mut rays), Some(more)) => {
                rays += more;
                Some(rays)
            }
            _ => None,
        };
        if let (Some(direct), Some(more)) = (&mut self.direct, other.direct) {
            direct.samples += more.samples;
        }
        self.chain = None;
        self.replicas = None;
        self.mutations = Vec::new();
        self.energy = None;
        self.photons = None;
        self.stages = Vec::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(steps: u64, luminance: f32) -> MergedPart {
        let planes = [(); 3].map(|()| vec![luminance; 4]);
        let image = Image::from_rgb(2, 2, planes).expect("an image");
        MergedPart::new(3, &(0..4), steps, &image)
    }

    #[test]
    fn parts_of_one_size_tell_their_error() {
        let told = MergeStatistics::new(Parts::Seeds, vec![part(10, 1.0), part(30, 2.0)], 4.0);
        assert!(
            told.luminance
                .is_some_and(|luminance| (luminance - 1.75).abs() < 1e-6)
        );
        // (10 x 0.75^2 + 30 x 0.25^2) / 40
        let error = told.luminance_error.expect("known");
        assert!((error - 0.1875_f64.sqrt()).abs() < 1e-6);
        assert!(told.notices()[0].contains("2 renders of other seeds"));
        for parts in [
            vec![part(10, 1.0)],
            vec![part(10, 1.0), part(41, 1.0)],
            vec![part(0, 1.0), part(1, 1.0)],
        ] {
            let told = MergeStatistics::new(Parts::Ladders, parts, 4.0);
            assert!(!told.is_told() && told.luminance_error.is_none());
            assert!(told.notices()[0].contains("no errors from the spread of shares"));
        }
    }
}
