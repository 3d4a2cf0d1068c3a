//! What time a study counts.

use std::time::Instant;

use crate::Unit;

/// Seconds since some start, never going back.
pub trait Clock: Sync {
    /// Now.
    fn seconds(&self) -> f64;
}

/// Time on the wall.
#[derive(Clone, Copy, Debug)]
pub struct WallClock(Instant);

/// Processor time of this process, all threads together, as Linux tells it in steps of 10 ms; time on the
/// wall where it does not.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuClock(WallClock);

impl Default for WallClock {
    fn default() -> Self {
        Self(Instant::now())
    }
}

impl Clock for WallClock {
    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

impl Clock for CpuClock {
    fn seconds(&self) -> f64 {
        processor_time().unwrap_or_else(|| self.0.seconds())
    }
}

impl CpuClock {
    /// Does this system tell processor time?
    #[must_use]
    pub fn is_told() -> bool {
        processor_time().is_some()
    }
}

/// User and system time of the process in seconds.
fn processor_time() -> Option<f64> {
    parse_stat(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// Fields 14 and 15; the name in field 2 may hold blanks and brackets.
fn parse_stat(stat: &str) -> Option<f64> {
    /// What Linux tells user space, whatever its own clock.
    const TICKS: f64 = 100.0;
    let (_, rest) = stat.rsplit_once(')')?;
    let mut fields = rest.split_ascii_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<u64>().ok();
    Some((ticks()? + ticks()?) as f64 / TICKS)
}

/// The clock of a unit; samples are timed on the wall.
pub(crate) fn clock(unit: Unit) -> Box<dyn Clock> {
    match unit {
        Unit::Cpu => Box::new(CpuClock::default()),
        Unit::Wall | Unit::PerPixel | Unit::Total => Box::new(WallClock::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_is_read_past_any_name() {
        let stat = "12 (a ) b) S 1 2 3 4 5 6 7 8 9 10 250 50 7 8 9";
        assert_eq!(parse_stat(stat), Some(3.0));
        assert_eq!(parse_stat("12 (a S 1 2"), None);
        assert_eq!(parse_stat("12 (a) S 1 2 x"), None);
    }

    #[test]
    fn work_takes_processor_time() {
        if !CpuClock::is_told() {
            return;
        }
        let (clock, wall) = (CpuClock::default(), WallClock::default());
        let start = clock.seconds();
        let mut x = 0u64;
        while wall.seconds() < 5.0 && clock.seconds() < start + 0.05 {
            x = std::hint::black_box(x + 1);
        }
        assert!(clock.seconds() >= start + 0.05);
    }
}
