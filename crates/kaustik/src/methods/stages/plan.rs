//! Which stage has which mutations, and how wide its map is.

use crate::{RenderSettings, StageLadder};

/// Share of the budget that goes to maps of less than half of the image's width, in proportion to theirs.
const NARROW: f64 = 0.25;
/// Widths from half of the image's to all of it, each with the same share of the rest.
const WIDE: u32 = 10;
/// Share of the first of two stages.
const FIRST: f64 = 1.0 / 16.0;
/// Its pixels over those of the map that is made of it: as many mutations for each as the budget has for a pixel.
const FIRST_SIDE: f64 = 4.0;
/// A ladder takes so many steps in a stage at least, or the stage is left out: a pool of its own would not be worth it.
const LEAST: u64 = 64;
/// A stage's pool is at least this part of the pilot, and so many samples.
const LEAST_SHARE: f64 = 1.0 / 40.0;
const LEAST_POOL: u64 = 256;
/// More stages than any render comes to.
const MOST: usize = 256;

/// One stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stage {
    /// Cells of its map along the longer side of the window; of the first stage, which has no picture to go by, 1.
    pub(super) width: u32,
    /// Steps that a ladder has behind it at its end, in all stages.
    pub(super) end: u64,
}

/// All of them. All ladders reach the end of a stage in the same round, before any goes on: their numbers of
/// steps differ by one at most.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    /// Those within the budget.
    stages: Vec<Stage>,
    /// Cells of the maps beyond: each stage takes as many steps as all before it.
    width: u32,
    /// Does the last stage have no end?
    endless: bool,
    ladders: u64,
    pilot: u64,
}

impl Plan {
    pub(super) fn new(settings: &RenderSettings) -> Self {
        let window = settings.layout().crop;
        let options = &settings.options;
        let longer = window.width().max(window.height());
        let two = options.stages.ladder == StageLadder::Two;
        let total = options.stages.budget.saturating_mul(window.area()) as f64;
        let of_ladder = total / f64::from(options.ladders);
        let mut stages: Vec<Stage> = Vec::new();
        let mut sum = 0.0;
        let shares = if two {
            vec![(1, FIRST)]
        } else {
            widths(longer)
        };
        for (width, share) in shares {
            sum += share;
            let end = (of_ladder * sum).ceil() as u64;
            let start = stages.last().map_or(0, |stage| stage.end);
            if end >= start + LEAST {
                stages.push(Stage { width, end });
            }
        }
        match stages.first_mut() {
            Some(first) => first.width = 1,
            None => stages.push(Stage {
                width: 1,
                end: LEAST,
            }),
        }
        Self {
            stages,
            width: if two {
                (f64::from(longer) / FIRST_SIDE).ceil() as u32
            } else {
                longer
            },
            endless: two,
            ladders: u64::from(options.ladders),
            pilot: options.pilot,
        }
    }

    /// The stage of this number.
    pub(super) fn stage(&self, number: usize) -> Stage {
        if let Some(stage) = self.stages.get(number) {
            return *stage;
        }
        let last = self.stages.last().map_or(LEAST, |stage| stage.end);
        let beyond = (number - self.stages.len()).min(63) as u32;
        let end = (1_u64 << beyond)
            .checked_mul(2)
            .and_then(|times| last.checked_mul(times));
        Stage {
            width: self.width,
            end: end.filter(|_| !self.endless).unwrap_or(u64::MAX),
        }
    }

    /// The last number that a stage may have.
    pub(super) fn most(&self) -> usize {
        self.of_step(u64::MAX - 1).min(MOST)
    }

    /// Steps that a ladder has behind it where a stage begins.
    pub(super) fn start(&self, number: usize) -> u64 {
        number
            .checked_sub(1)
            .map_or(0, |before| self.stage(before).end)
    }

    /// The stage of a ladder's step.
    pub(super) fn of_step(&self, step: u64) -> usize {
        let stages = 0..MOST;
        let found = stages
            .into_iter()
            .find(|&number| step < self.stage(number).end);
        found.unwrap_or(MOST)
    }

    /// Samples of a stage's pool. The first stage has as many as the pilot. Each other has its share of as many
    /// again, but not far more than it has mutations, and at least `many`; never more than the pilot.
    pub(super) fn pool(&self, number: usize, many: u64) -> u64 {
        if number == 0 {
            return self.pilot;
        }
        let steps = self.stage(number).end.saturating_sub(self.start(number));
        let budget = self.stages.last().map_or(LEAST, |stage| stage.end);
        let share = (steps as f64 / budget as f64).clamp(LEAST_SHARE, 1.0);
        let samples = (self.pilot as f64 * share).ceil() as u64;
        let mutations = steps.saturating_mul(self.ladders);
        let samples = samples.min(mutations).max(LEAST_POOL);
        samples.max(many).min(self.pilot)
    }
}

/// Widths below half of the image's, doubling, then ten from half to all of it, with their shares of the
/// budget. Those that rounding makes one are one.
fn widths(longer: u32) -> Vec<(u32, f64)> {
    let half = f64::from(longer) / 2.0;
    let powers = (0..32).map(|power| 1_u32 << power);
    let narrow: Vec<u32> = powers.take_while(|w| f64::from(*w) < half).collect();
    let sum: f64 = narrow.iter().map(|w| f64::from(*w)).sum();
    let rest = if narrow.is_empty() { 1.0 } else { 1.0 - NARROW };
    let mut stages: Vec<(u32, f64)> = narrow
        .into_iter()
        .map(|w| (w, NARROW * f64::from(w) / sum))
        .collect();
    for step in 0..WIDE {
        let width = half * (1.0 + f64::from(step) / f64::from(WIDE - 1));
        let width = (width.round() as u32).max(1);
        let share = rest / f64::from(WIDE);
        match stages.last_mut() {
            Some(last) if last.0 == width => last.1 += share,
            _ => stages.push((width, share)),
        }
    }
    stages
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StageOptions;

    fn plan(size: [u32; 2], ladders: u32, budget: u64, ladder: StageLadder) -> Plan {
        let mut settings = RenderSettings {
            width: size[0],
            height: size[1],
            ..RenderSettings::default()
        };
        settings.options.ladders = ladders;
        settings.options.stages = StageOptions {
            budget,
            ladder,
            ..StageOptions::default()
        };
        Plan::new(&settings)
    }

    fn all(plan: &Plan, count: usize) -> Vec<Stage> {
        (0..count).map(|number| plan.stage(number)).collect()
    }

    #[test]
    fn widths_have_their_shares() {
        let stages = widths(256);
        let found: Vec<u32> = stages.iter().map(|(width, _)| *width).collect();
        let narrow = [1, 2, 4, 8, 16, 32, 64];
        let wide = [128, 142, 156, 171, 185, 199, 213, 228, 242, 256];
        assert_eq!(found, [&narrow[..], &wide].concat());
        for (width, share) in &stages {
            let expected = match width {
                128.. => 0.075,
                _ => 0.25 * f64::from(*width) / 127.0,
            };
            assert!((share - expected).abs() < 1e-12, "{width}: {share}");
        }
        for longer in [1, 2, 3, 5, 96, 1000] {
            let stages = widths(longer);
            let sum: f64 = stages.iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{longer}");
            assert!(stages.is_sorted_by(|a, b| a.0 < b.0), "{stages:?}");
            assert_eq!(stages.last().map(|s| s.0), Some(longer));
        }
    }

    #[test]
    fn stages_end_where_the_budget_says() {
        // the longer side counts
        for size in [[64, 48], [48, 64]] {
            let plan = plan(size, 7, 100, StageLadder::Widths);
            let of_ladder = 64.0 * 48.0 * 100.0 / 7.0;
            let mut sum = 0.0;
            for (number, (width, share)) in widths(64).into_iter().enumerate() {
                sum += share;
                let end = (of_ladder * sum).ceil() as u64;
                assert_eq!(plan.stage(number), Stage { width, end });
            }
            let count = widths(64).len();
            let last = plan.stage(count - 1).end;
            assert!((last as f64 - of_ladder).abs() < 2.0);
            for (beyond, times) in [2, 4, 8, 16].into_iter().enumerate() {
                let end = last * times;
                assert_eq!(plan.stage(count + beyond), Stage { width: 64, end });
            }
            assert_eq!(plan.stage(MOST).end, u64::MAX);
        }
        let plan = plan([64, 48], 7, 100, StageLadder::Two);
        let end = (64.0 * 48.0 * 100.0 / 7.0 / 16.0_f64).ceil() as u64;
        assert_eq!(plan.stage(0), Stage { width: 1, end });
        let rest = Stage {
            width: 16,
            end: u64::MAX,
        };
        assert_eq!([plan.stage(1), plan.stage(2)], [rest; 2]);
        assert_eq!(plan.of_step(u64::MAX - 1), 1);
    }

    #[test]
    fn no_image_is_too_small() {
        for size in [[1, 1], [2, 2], [1, 9], [9, 1], [3, 2]] {
            for ladders in [1, 64, 4096] {
                for budget in [1, 64, 100_000] {
                    for ladder in [StageLadder::Widths, StageLadder::Two] {
                        let plan = plan(size, ladders, budget, ladder);
                        let stages = all(&plan, 40);
                        assert_eq!(stages[0].width, 1);
                        assert!(stages[0].end >= LEAST);
                        for (number, pair) in stages.windows(2).enumerate() {
                            assert!(pair[1].width <= size[0].max(size[1]));
                            let long = pair[1].end >= pair[0].end.saturating_add(LEAST);
                            assert!(long || pair[0].end == u64::MAX, "{stages:?}");
                            assert_eq!(plan.start(number + 1), pair[0].end);
                            if pair[0].end < u64::MAX {
                                assert_eq!(plan.of_step(pair[0].end - 1), number);
                                assert_eq!(plan.of_step(pair[0].end), number + 1);
                            }
                            let pool = plan.pool(number, 0);
                            assert!(pool >= LEAST_POOL && pool <= plan.pilot, "{pool}");
                        }
                    }
                }
            }
        }
    }

    /// All pools within the budget together, beside the first: not far more than one pilot.
    #[test]
    fn pools_share_a_pilot() {
        let plan = plan([256, 256], 64, 64, StageLadder::Widths);
        assert_eq!(plan.pool(0, 0), 100_000);
        let pools: Vec<u64> = (1..plan.stages.len()).map(|n| plan.pool(n, 0)).collect();
        let sum: u64 = pools.iter().sum();
        assert!((100_000..140_000).contains(&sum), "{pools:?}");
        assert!(pools.iter().all(|&pool| pool >= 2_500), "{pools:?}");
        // More where light is hard to find, but never more than the first.
        assert_eq!(
            [plan.pool(3, 70_000), plan.pool(3, 200_000)],
            [70_000, 100_000]
        );
    }
}
