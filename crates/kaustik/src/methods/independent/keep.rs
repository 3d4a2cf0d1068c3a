//! What a state holds of independent samples.

use std::io;

use kaustik_path::RayCounts;

use super::IndependentEngine;
use crate::engine::Nonfinite;
use crate::methods::erpt_pss::{Chains, Kept};
use crate::state::{Keep, Reader, StateError, Writer};

/// Samples follow from their number: the film, and where each stream is.
impl Keep for IndependentEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        self.streams.iter().map(|stream| stream.step).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.film(&self.film)?;
        let streams = self.streams.iter();
        let streams: Vec<(u64, Nonfinite, RayCounts)> =
            streams.map(|s| (s.step, s.nonfinite, s.rays)).collect();
        out.value(&streams)?;
        let Some(redistribution) = &self.redistribution else {
            return Ok(());
        };
        if let Some(held) = &redistribution.held {
            out.film(held)?;
        }
        let chains: Vec<Kept> = self.chains().map(Chains::kept).collect();
        out.value(&(redistribution.pilot(), chains))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        from.film(&mut self.film)?;
        let kept: Vec<(u64, Nonfinite, RayCounts)> = from.value()?;
        let ladders = from.ladders();
        if kept.len() != ladders.len() {
            return Err(StateError::damaged("a stream of samples is missing"));
        }
        let streams = self.streams.iter_mut();
        let streams = streams.filter(|stream| ladders.contains(&stream.ladder));
        for (stream, (step, nonfinite, rays)) in streams.zip(kept) {
            stream.step = Reader::count(step)?;
            stream.nonfinite = nonfinite.checked()?;
            (stream.rays.closest, stream.rays.any) =
                (Reader::count(rays.closest)?, Reader::count(rays.any)?);
        }
        self.take_up_chains(from)
    }
}

impl IndependentEngine<'_> {
    /// The chains of the streams that were taken up just now, where the method has any.
    fn take_up_chains(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let Some(redistribution) = &mut self.redistribution else {
            return Ok(());
        };
        if let Some(held) = &mut redistribution.held {
            from.film(held)?;
        }
        let (pilot, kept): (f64, Vec<Kept>) = from.value()?;
        let (ladders, here) = (from.ladders(), redistribution.pilot());
        if pilot.to_bits() != here.to_bits() {
            return Err(StateError::pilot(pilot, here));
        }
        if kept.len() != ladders.len() {
            return Err(StateError::damaged("a ladder's chains are missing"));
        }
        let streams = self.streams.iter_mut();
        let streams = streams.filter(|stream| ladders.contains(&stream.ladder));
        for (stream, kept) in streams.zip(kept) {
            if let Some(chains) = &mut stream.chains {
                chains.take_up(kept, stream.step)?;
            }
        }
        Ok(())
    }
}
