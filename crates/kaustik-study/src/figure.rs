//! The figures of merit: what is tabulated, drawn and compared.

use crate::{Cell, Group};

/// One number a picture, the smaller the better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Root mean square error over X, Y, Z: RELT (25).
    RmseXyz,
    /// Mean over pixels of the squared error relative to the reference.
    RelativeMse,
    /// `RmseXyz` without the worst 0.1 % of the pixels.
    RmseXyzTrimmed,
    /// `RelativeMse` without them.
    RelativeMseTrimmed,
    /// `RelativeMse` with the brightness set right.
    Matched,
    /// Share of pixels that are off by more than 5 % (Kelemen's perceptual measure).
    Over5,
    /// By more than 10 %.
    Over10,
    /// By more than 20 %.
    Over20,
}

impl Figure {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::RmseXyz,
        Self::RelativeMse,
        Self::RmseXyzTrimmed,
        Self::RelativeMseTrimmed,
        Self::Matched,
        Self::Over5,
        Self::Over10,
        Self::Over20,
    ];

    /// Is the reference's own noise left out of it, as that of its halves is in products of differences to both?
    #[must_use]
    pub fn cancels_noise(self) -> bool {
        !matches!(self, Self::Over5 | Self::Over10 | Self::Over20)
    }

    /// A word, for files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::RmseXyz => "rmse_xyz",
            Self::RelativeMse => "relative_mse",
            Self::RmseXyzTrimmed => "rmse_xyz_trimmed",
            Self::RelativeMseTrimmed => "relative_mse_trimmed",
            Self::Matched => "relative_mse_matched",
            Self::Over5 => "over_5_percent",
            Self::Over10 => "over_10_percent",
            Self::Over20 => "over_20_percent",
        }
    }

    /// A few words, for tables and axes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RmseXyz => "RMSE in XYZ",
            Self::RelativeMse => "relative MSE",
            Self::RmseXyzTrimmed => "RMSE in XYZ, worst 0.1 % dropped",
            Self::RelativeMseTrimmed => "relative MSE, worst 0.1 % dropped",
            Self::Matched => "relative MSE at equal brightness",
            Self::Over5 => "pixels off by more than 5 %",
            Self::Over10 => "pixels off by more than 10 %",
            Self::Over20 => "pixels off by more than 20 %",
        }
    }

    /// Of one render.
    #[must_use]
    pub fn of(self, cell: &Cell) -> f64 {
        let (m, matched) = (&cell.measured, &cell.matched);
        match self {
            Self::RmseXyz => m.raw.rmse_xyz,
            Self::RelativeMse => m.raw.relative_mse,
            Self::RmseXyzTrimmed => m.trimmed.rmse_xyz,
            Self::RelativeMseTrimmed => m.trimmed.relative_mse,
            Self::Matched => matched.raw.relative_mse,
            Self::Over5 => m.shares.over_5_percent,
            Self::Over10 => m.shares.over_10_percent,
            Self::Over20 => m.shares.over_20_percent,
        }
    }
}

/// What a curve shows and methods are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// A figure of each render, over the seeds.
    Figure(Figure),
    /// The normalised standard deviation over the seeds: one number for all of them.
    Nsd,
}

impl From<Figure> for Curve {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

impl Curve {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        Figure::ALL.into_iter().map(Self::Figure).chain([Self::Nsd])
    }

    /// A word, for files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Figure(figure) => figure.word(),
            Self::Nsd => "nsd",
        }
    }

    /// A few words, for tables and axes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Figure(figure) => figure.name(),
            Self::Nsd => "NSD",
        }
    }
}

/// Lower quartile, median and upper quartile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// A quarter lies below.
    pub lower: f64,
    /// Half lies below.
    pub median: f64,
    /// Three quarters lie below.
    pub upper: f64,
}

impl Quartiles {
    /// Of these values, linear between neighbours in rank; NaN of none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let at = |q: f64| {
            let place = q * (values.len().saturating_sub(1)) as f64;
            let low = values.get(place as usize).copied().unwrap_or(f64::NAN);
            let high = values.get(place.ceil() as usize).copied().unwrap_or(low);
            let share = place.fract();
            if share > 0.0 {
                low + share * (high - low)
            } else {
                low
            }
        };
        Self {
            lower: at(0.25),
            median: at(0.5),
            upper: at(0.75),
        }
    }
}

/// Mean and its standard error; the latter NaN for fewer than two values.
#[must_use]
pub fn mean_and_error(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    let error = if values.len() < 2 {
        f64::NAN
    } else {
        (squares / (n - 1.0) / n).sqrt()
    };
    [mean, error]
}

impl Group {
    /// A figure over the seeds.
    #[must_use]
    pub fn quartiles(&self, figure: Figure) -> Quartiles {
        Quartiles::of(self.cells.iter().map(|cell| figure.of(cell)))
    }

    /// A point of a curve, or `None`. Where the seeds have one number together it stands for all three.
    #[must_use]
    pub fn point(&self, curve: Curve) -> Option<Quartiles> {
        match curve {
            Curve::Figure(figure) => Some(self.quartiles(figure)),
            Curve::Nsd => self.nsd.map(|nsd| Quartiles::of([nsd.mean])),
        }
    }

    /// Median seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        Quartiles::of(self.cells.iter().map(|cell| cell.seconds)).median
    }

    /// Median of samples a pixel.
    #[must_use]
    pub fn per_pixel(&self) -> f64 {
        Quartiles::of(self.cells.iter().map(|cell| cell.per_pixel)).median
    }

    /// Bias in brightness: the mean over the seeds and its standard error.
    #[must_use]
    pub fn bias(&self) -> [f64; 2] {
        let values: Vec<f64> = self
            .cells
            .iter()
            .map(|cell| cell.measured.raw.bias)
            .collect();
        mean_and_error(&values)
    }

    /// Median of a number in the renders' statistics, by its path as in `/chain/small_acceptance`.
    #[must_use]
    pub fn statistic(&self, path: &str) -> Option<f64> {
        let numbers: Vec<f64> = (self.cells.iter())
            .filter_map(|cell| cell.statistics.pointer(path)?.as_f64())
            .collect();
        (!numbers.is_empty()).then(|| Quartiles::of(numbers).median)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kaustik::film::metrics::{Errors, Measured, PixelShares};

    #[test]
    fn quartiles_lie_between_values() {
        let q = Quartiles::of([4.0, 1.0, 3.0, 2.0, 10.0]);
        assert_eq!((q.lower, q.median, q.upper), (2.0, 3.0, 4.0));
        let q = Quartiles::of([1.0, 2.0]);
        assert_eq!((q.lower, q.median, q.upper), (1.25, 1.5, 1.75));
        let q = Quartiles::of([7.0]);
        assert_eq!((q.lower, q.median, q.upper), (7.0, 7.0, 7.0));
        assert!(Quartiles::of([]).median.is_nan());
    }

    #[test]
    fn every_figure_is_what_its_name_says() {
        let errors = |rmse_xyz, relative_mse| Errors {
            rmse_xyz,
            relative_mse,
            ..Errors::default()
        };
        let measured = Measured {
            raw: errors(0.0, 1.0),
            trimmed: errors(2.0, 3.0),
            shares: PixelShares {
                over_5_percent: 5.0,
                over_10_percent: 6.0,
                over_20_percent: 7.0,
            },
            non_finite: 0,
        };
        let matched = Measured {
            raw: errors(-1.0, 4.0),
            ..measured
        };
        let cell = Cell {
            seed: 0,
            seconds: -1.0,
            per_pixel: -1.0,
            measured,
            matched,
            quarters: [-1.0; 2],
            colours: Vec::new(),
            statistics: serde_json::Value::Null,
        };
        let all = Figure::ALL.map(|figure| figure.of(&cell) as i32);
        assert_eq!(all, [0, 1, 2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn the_error_of_a_mean_is_its_standard_error() {
        // deviations -2, 0, 2: s^2 = 8/2 = 4, error = 2/sqrt(3)
        let [mean, error] = mean_and_error(&[1.0, 3.0, 5.0]);
        assert!((mean - 3.0).abs() < 1e-12 && (error - 2.0 / 3.0f64.sqrt()).abs() < 1e-12);
        assert!(mean_and_error(&[1.0])[1].is_nan());
    }
}
