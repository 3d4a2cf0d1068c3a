//! States of chains on primary samples.

use std::io;

use kaustik_mcmc::{Family, Mean, checked_densities};
use kaustik_path::Contributions;

use super::{Chain, PssmltEngine};
use crate::chains::{LadderChain, check_counts};
use crate::state::{Keep, Reader, StateError, Writer};

/// Films and chains; what the pilots found is found again, and compared.
impl<F: Family<Contributions, 1> + Send + Sync> Keep for PssmltEngine<'_, F> {
    fn taken(&self) -> Vec<u64> {
        let chains = self.chains.iter();
        chains.map(|c| c.metropolis.statistics().steps).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.b0, self.pool))?;
        out.film(&self.chain_film)?;
        if let Some(film) = &self.large_film {
            out.film(film)?;
        }
        self.besides.write(out)?;
        self.chains.iter().try_for_each(|chain| out.value(chain))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let (b0, pool): (f64, Mean) = from.value()?;
        if b0.to_bits() != self.b0.to_bits() || pool != self.pool {
            let (b, here) = (pool.mean(), self.pool.mean());
            return Err(StateError::Other(format!(
                "the pilot found {b0:e} and {b:e} for the state, {:e} and {here:e} here: this program computes other numbers",
                self.b0
            )));
        }
        from.film(&mut self.chain_film)?;
        if let Some(film) = &mut self.large_film {
            from.film(film)?;
        }
        let passes = self.besides.take_up(from)?;
        let ladders = from.ladders();
        let chains = self.chains.iter_mut();
        let mut taken = 0;
        for chain in chains.filter(|chain| ladders.contains(&chain.ladder)) {
            let kept: Chain = from.value()?;
            kept.check(chain.ladder, &self.family)?;
            taken += kept.metropolis.statistics().steps;
            *chain = kept;
        }
        self.besides.check(passes, taken)?;
        let steps = self.statistics().steps;
        self.besides.keep_up(steps);
        Ok(())
    }
}

impl Chain {
    /// Refuses what no chain of this ladder can have written.
    fn check(&self, ladder: u32, family: &impl Family<Contributions, 1>) -> Result<(), StateError> {
        let independent = self.statistics().independent[0].count();
        check_counts(self, ladder, independent)?;
        self.nonfinite.checked()?;
        for rays in [self.rays.closest, self.rays.any] {
            Reader::count(rays)?;
        }
        let density = checked_densities(family, self.metropolis.value());
        let [density] = density.unwrap_or_default();
        if self.metropolis.density().to_bits() != density.to_bits() {
            return Err(StateError::damaged(
                "a chain's density is not that of its path",
            ));
        }
        Ok(())
    }
}
