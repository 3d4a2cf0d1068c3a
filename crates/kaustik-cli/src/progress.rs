//! Progress on standard error: a bar on a terminal, plain lines otherwise.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use kaustik::Progress;

use crate::output;

/// Shows how far something is: a bar on a terminal, lines elsewhere.
pub(crate) enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines { last: Instant, every: Duration },
}

impl Display {
    /// A bar of this template, or a line so often.
    pub(crate) fn new(quiet: bool, template: &str, every: Duration) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines {
                last: Instant::now(),
                every,
            };
        }
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self::Bar(bar)
    }

    /// For a render.
    pub(crate) fn of_render(quiet: bool) -> Self {
        let every = Duration::from_secs(5);
        Self::new(quiet, "{bar:30} {percent:>3} %  {msg}", every)
    }

    /// A share done, from 0 to 1, and what else there is to say.
    pub(crate) fn show(&mut self, fraction: f64, message: impl FnOnce() -> String) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_position((fraction * 1000.0) as u64);
                bar.set_message(message());
            }
            Self::Lines { last, every } => {
                if last.elapsed() >= *every {
                    *last = Instant::now();
                    output::note(&format!("{:3.0} %  {}", fraction * 100.0, message()));
                }
            }
        }
    }

    pub(crate) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Everything but the share done.
pub(crate) fn line(progress: &Progress) -> String {
    let mut line = format!(
        "{} left, {:.2} M steps/s",
        time(progress.remaining),
        progress.rate * 1e-6
    );
    if let Some([small, large]) = progress.acceptance {
        line += &format!(
            ", accepted {:.0} % small {:.0} % large",
            small * 100.0,
            large * 100.0
        );
    }
    if let Some([b, error]) = progress.normalisation {
        line += &format!(", b {b:.5}");
        // one round of its own tells none
        if error.is_finite() {
            line += &format!(" +- {error:.1e}");
        }
    }
    line
}

/// `12s`, `3m 04s`, `2h 05m`.
fn time(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s}s"),
        (0, m, s) => format!("{m}m {s:02}s"),
        (h, m, _) => format!("{h}h {m:02}m"),
    }
}
