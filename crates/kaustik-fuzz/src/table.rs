use std::fmt;

use crate::campaign::{Outcome, Verdict};
use crate::kind::Kind;

/// The columns of [`Row`].
pub(crate) const HEAD: &str = "kind            files pictures refused panics aborts hangs   p50 ms   p99 ms   max ms  max MiB";

/// Goals: time of the 99th of a hundred, and memory.
const P99_MILLISECONDS: f64 = 200.0;
const MOST_MEBIBYTES: f64 = 256.0;

/// What a campaign found, in a line.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    kind: Kind,
    files: usize,
    counts: [usize; 5],
    times: [f64; 3],
    mebibytes: f64,
}

impl Row {
    pub(crate) fn of(kind: Kind, verdicts: &[Verdict]) -> Self {
        let count = |outcome: Outcome| verdicts.iter().filter(|v| v.outcome == outcome).count();
        let mut times: Vec<f64> = verdicts.iter().map(|v| v.milliseconds).collect();
        times.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = times.len().saturating_sub(1);
            let index = (share * last as f64).round() as usize;
            times.get(index).copied().unwrap_or(0.0)
        };
        let kilobytes = verdicts.iter().map(|v| v.kilobytes).max();
        Self {
            kind,
            files: verdicts.len(),
            counts: [
                count(Outcome::Picture),
                count(Outcome::Refused),
                count(Outcome::Panic),
                count(Outcome::Abort),
                count(Outcome::Hang),
            ],
            times: [at(0.5), at(0.99), at(1.0)],
            mebibytes: kilobytes.unwrap_or(0) as f64 / 1024.0,
        }
    }

    /// No panic, no abort, no hang, and no file that took too much memory. Times depend on what else
    /// the machine does, and are told alone.
    pub(crate) fn is_clean(&self) -> bool {
        let [_, _, panics, aborts, hangs] = self.counts;
        panics + aborts + hangs == 0 && self.mebibytes <= MOST_MEBIBYTES
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [pictures, refused, panics, aborts, hangs] = self.counts;
        let [p50, p99, most] = self.times;
        write!(
            f,
            "{:<15} {:>5} {pictures:>8} {refused:>7} {panics:>6} {aborts:>6} {hangs:>5} {p50:>8.2} {p99:>8.2} {most:>8.2} {:>8.1}",
            self.kind, self.files, self.mebibytes
        )?;
        if p99 > P99_MILLISECONDS {
            write!(f, "  slow: p99 above {P99_MILLISECONDS} ms")?;
        }
        if self.mebibytes > MOST_MEBIBYTES {
            write!(f, "  hungry: above {MOST_MEBIBYTES} MiB")?;
        }
        Ok(())
    }
}
