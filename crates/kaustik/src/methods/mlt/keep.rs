//! States of chains on paths.

use std::io;

use kaustik_estimate::RasterMap;
use kaustik_mcmc::Mean;
use kaustik_mutate::PathSpace;

use super::{Chain, Kept, MltEngine, density};
use crate::chains::check_counts;
use crate::state::{Keep, Reader, StateError, Writer};

/// Film and chains; the pool is filled again, and compared.
impl Keep for MltEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        if self.chains.is_empty() {
            return self.idle.clone();
        }
        let chains = self.chains.iter();
        chains.map(|c| c.metropolis.statistics().steps).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&self.pool)?;
        out.film(&self.film)?;
        self.besides.write(out)?;
        if self.chains.is_empty() {
            return out.value(&self.idle);
        }
        (self.chains.iter()).try_for_each(|chain| out.value(&chain.written()))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let pool: Mean = from.value()?;
        if pool != self.pool {
            return Err(StateError::pilot(pool.mean(), self.pool.mean()));
        }
        from.film(&mut self.film)?;
        let passes = self.besides.take_up(from)?;
        let ladders = from.ladders();
        let mut taken = 0;
        if self.chains.is_empty() {
            taken = self.take_up_idle(from)?;
        }
        for chain in (self.chains.iter_mut()).filter(|c| ladders.contains(&c.ladder)) {
            *chain = from
                .value::<Kept>()?
                .checked(chain.ladder, &self.space, &self.map)?;
            taken += chain.metropolis.statistics().steps;
        }
        self.besides.check(passes, taken)?;
        let steps = self.steps();
        self.besides.keep_up(steps);
        Ok(())
    }
}

impl MltEngine<'_> {
    /// Steps of ladders without chains, each with no more than any ladder takes; how many there are.
    fn take_up_idle(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError> {
        let idle: Vec<u64> = from.value()?;
        let ladders = from.ladders();
        if idle.len() != ladders.len() {
            return Err(StateError::damaged("a ladder's steps are missing"));
        }
        let mut taken = 0;
        for (ladder, steps) in ladders.zip(idle) {
            let at = ladder.wrapping_sub(self.ladders.start) as usize;
            if let Some(idle) = self.idle.get_mut(at) {
                *idle = Reader::count(steps)?;
                taken += steps;
            }
        }
        Ok(taken)
    }
}

impl Chain {
    fn written(&self) -> Kept {
        Chain {
            ladder: self.ladder,
            nonfinite: self.nonfinite,
            draws: self.draws.clone(),
            fresh: self.fresh.clone(),
            independent: self.independent,
            metropolis: (self.metropolis).with_value(self.metropolis.value().written()),
        }
    }
}

impl Kept {
    /// Refuses what no chain of this ladder can have written.
    fn checked(
        self,
        ladder: u32,
        space: &PathSpace<'_>,
        map: &RasterMap,
    ) -> Result<Chain, StateError> {
        check_counts(&self, ladder, self.independent.count())?;
        let path = space.read(self.metropolis.value());
        let kept = self.metropolis.density().to_bits();
        let path = path.filter(|path| density(map)(path)[0].to_bits() == kept);
        let path =
            path.ok_or_else(|| StateError::damaged("a chain's path is none of the scene"))?;
        Ok(Chain {
            ladder,
            nonfinite: self.nonfinite.checked()?,
            draws: self.draws,
            fresh: self.fresh,
            independent: self.independent,
            metropolis: self.metropolis.with_value(path),
        })
    }
}
