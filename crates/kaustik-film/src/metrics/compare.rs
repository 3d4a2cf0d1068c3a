//! The comparison of one or more pictures with a reference, as one report.

use super::{Errors, Measured, Nsd, PixelShares, Reference, Tile, measure, nsd, tiles};
use crate::{Image, Window};
use serde::Serialize;
use std::fmt;

/// Side in pixels of the tiles whose means are compared.
const TILE: u32 = 16;

/// What `compare` says of all pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Whether the reference was given as two halves, so that its own noise has cancelled.
    pub halves: bool,
    /// One a picture, in the order given.
    pub images: Vec<ImageReport>,
    /// Spread between the pictures, if there are two or more of one size.
    pub nsd: Option<Nsd>,
}

/// What it says of one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImageReport {
    /// The picture's name as given.
    pub name: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels left out because they are not finite.
    pub non_finite: u64,
    /// Over all pixels.
    pub raw: Errors,
    /// Without the worst 0.1 %.
    pub trimmed: Errors,
    /// Shares of pixels that are off by more than 5, 10 and 20 %.
    pub shares: PixelShares,
    /// The tile of 16 x 16 pixels whose mean is farthest off, and how far.
    pub worst_tile: Option<Tile>,
}

/// Pictures that cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// An empty list.
    #[error("no picture to compare: expected at least one and a reference")]
    Nothing,
    /// A picture of another size than the reference.
    #[error(
        "{name}: {width} x {height} pixels, but the reference has {expected_width} x {expected_height}"
    )]
    Size {
        /// The picture's name.
        name: String,
        /// Its columns.
        width: u32,
        /// Its rows.
        height: u32,
        /// The reference's columns.
        expected_width: u32,
        /// The reference's rows.
        expected_height: u32,
    },
    /// A picture and a reference of one size that show different parts of the same whole.
    #[error("{name} shows {found}: expected the reference's {expected}")]
    Place {
        /// The picture.
        name: String,
        /// Its size and place.
        found: String,
        /// The reference's.
        expected: String,
    },
    /// Halves of different size.
    #[error("the two halves of the reference differ in size")]
    Halves,
}

/// Compares the main layers of named pictures with a reference, or with two halves of one.
///
/// A picture that is a crop of the reference's full image is compared with that part of it.
///
/// # Errors
/// No pictures, or sizes that do not fit.
pub fn compare(
    images: &[(&str, &Image)],
    reference: &Image,
    half: Option<&Image>,
) -> Result<Report, CompareError> {
    if images.is_empty() {
        return Err(CompareError::Nothing);
    }
    let whole = match half {
        None => Reference::exact(reference),
        Some(half) => Reference::halves(reference, half).ok_or(CompareError::Halves)?,
    };
    let reports: Result<_, _> = images
        .iter()
        .map(|(name, image)| report(name, image, &whole))
        .collect();
    let all: Vec<&Image> = images.iter().map(|(_, image)| *image).collect();
    Ok(Report {
        halves: half.is_some(),
        images: reports?,
        nsd: nsd(&all),
    })
}

fn report(name: &str, image: &Image, whole: &Reference<'_>) -> Result<ImageReport, CompareError> {
    if is_elsewhere(whole.image(), image) {
        return Err(CompareError::Place {
            name: name.to_owned(),
            found: image.shape(),
            expected: whole.image().shape(),
        });
    }
    let (a, b) = (
        part(whole.image(), image),
        whole.half().map(|half| part(half, image)),
    );
    let a = a.as_ref().unwrap_or(whole.image());
    let reference = match b {
        None => Some(Reference::exact(a)),
        Some(None) => whole.half().and_then(|half| Reference::halves(a, half)),
        Some(Some(ref b)) => Reference::halves(a, b),
    };
    let reference = reference.ok_or(CompareError::Halves)?;
    let size = || CompareError::Size {
        name: name.to_owned(),
        width: image.width(),
        height: image.height(),
        expected_width: whole.image().width(),
        expected_height: whole.image().height(),
    };
    let Measured {
        raw,
        trimmed,
        shares,
        non_finite,
    } = measure(image, &reference).ok_or_else(size)?;
    let tiles = tiles(image, &reference, TILE).ok_or_else(size)?;
    let worst_tile = tiles
        .into_iter()
        .max_by(|a, b| a.worst().total_cmp(&b.worst()));
    let (width, height) = (image.width(), image.height());
    Ok(ImageReport {
        name: name.to_owned(),
        width,
        height,
        non_finite,
        raw,
        trimmed,
        shares,
        worst_tile,
    })
}

/// Do both show as many pixels of the same whole, but others?
fn is_elsewhere(reference: &Image, image: &Image) -> bool {
    let same = (reference.width(), reference.height()) == (image.width(), image.height());
    same && reference.full_size() == image.full_size() && reference.origin() != image.origin()
}

/// The part of a reference that a cropped picture shows; `None` if it is no such crop, or all of it.
fn part(reference: &Image, image: &Image) -> Option<Image> {
    let same = (reference.width(), reference.height()) == (image.width(), image.height());
    if same || reference.full_size() != image.full_size() {
        return None;
    }
    let [x, y] = image.origin();
    let (x0, y0) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
    let (x1, y1) = (
        x0.checked_add(image.width())?,
        y0.checked_add(image.height())?,
    );
    reference.cropped(Window { x0, y0, x1, y1 }).ok()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for image in &self.images {
            image.fmt(f)?;
        }
        if let Some(nsd) = &self.nsd {
            writeln!(f, "NSD of {} images over {} pixels", nsd.images, nsd.pixels)?;
            writeln!(
                f,
                "  mean {:.4}  5 % {:.4}  median {:.4}  95 % {:.4}",
                nsd.mean, nsd.quantile_5, nsd.median, nsd.quantile_95
            )?;
        }
        if self.halves {
            writeln!(
                f,
                "Two halves of the reference: its own noise has cancelled."
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for ImageReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} ({} x {})", self.name, self.width, self.height)?;
        writeln!(
            f,
            "  {:<16} {:>12} {:>12}",
            "", "all pixels", "worst 0.1 % dropped"
        )?;
        let (raw, trimmed) = (&self.raw, &self.trimmed);
        let mut row = |name, raw: f64, trimmed: f64| {
            writeln!(f, "  {name:<16} {raw:>12.4e} {trimmed:>12.4e}")
        };
        row("RMSE", raw.rmse, trimmed.rmse)?;
        row("relative MSE", raw.relative_mse, trimmed.relative_mse)?;
        row("RMSE in XYZ", raw.rmse_xyz, trimmed.rmse_xyz)?;
        let (raw, trimmed) = (100.0 * raw.bias, 100.0 * trimmed.bias);
        writeln!(
            f,
            "  {:<16} {raw:>+10.3} % {trimmed:>+10.3} %",
            "brightness bias"
        )?;
        let shares = [
            self.shares.over_5_percent,
            self.shares.over_10_percent,
            self.shares.over_20_percent,
        ];
        let [five, ten, twenty] = shares.map(|share| 100.0 * share);
        writeln!(
            f,
            "  pixels off by more than 5 %: {five:.2} %, 10 %: {ten:.2} %, 20 %: {twenty:.2} %"
        )?;
        if let Some(tile) = &self.worst_tile {
            writeln!(
                f,
                "  worst tile of {TILE} x {TILE}: {:.2} % at {},{}",
                100.0 * tile.worst(),
                tile.x,
                tile.y
            )?;
        }
        if self.non_finite > 0 {
            writeln!(
                f,
                "  {} pixels are not finite and were left out",
                self.non_finite
            )?;
        }
        Ok(())
    }
}
