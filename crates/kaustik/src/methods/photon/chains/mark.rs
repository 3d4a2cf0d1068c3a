//! Where an iteration began: one that is stopped is taken back to there.

use kaustik_estimate::PhotonValue;
use kaustik_mcmc::{Ladder, Pcg64Dxsm, Point, Power};

use super::PhotonChains;
use crate::mark::FilmMark;
use crate::methods::photon::targets;

/// What an iteration changes before it has come to its end, but for what the next one makes anew.
pub(super) struct Mark<const K: usize> {
    /// What is there is read anew in each iteration.
    ladders: Vec<(Pcg64Dxsm, Ladder<Point<Power>, (), K>)>,
    rough: [f64; K],
    revival: Pcg64Dxsm,
    targets: targets::Mark,
}

/// The film of the first chain, where it is not black between two iterations. Its memory is used again.
pub(super) type First = FilmMark;

impl<const K: usize> PhotonChains<K> {
    /// Where it is, between two iterations.
    pub(super) fn mark(&mut self) -> Mark<K> {
        if self.visible.is_some() {
            self.first.set(&self.films[0]);
        }
        let ladders = self.ladders.iter();
        Mark {
            ladders: ladders
                .map(|chains| (chains.draws.clone(), chains.ladder.with_values([(); K])))
                .collect(),
            rough: self.rough,
            revival: self.revival.clone(),
            targets: self.targets.mark(self.maps.is_some()),
        }
    }

    /// Goes back to there. Films are black between two iterations, but for those that stay.
    pub(super) fn take_back(&mut self, mark: Mark<K>) {
        for (chains, (draws, ladder)) in self.ladders.iter_mut().zip(mark.ladders) {
            chains.draws = draws;
            chains.ladder = ladder.with_values(std::array::from_fn(|_| PhotonValue::default()));
        }
        for (level, film) in self.films.iter_mut().enumerate() {
            if level == 0 && self.visible.is_some() {
                self.first.take_back(film);
            } else {
                film.clear();
            }
        }
        self.rough = mark.rough;
        self.revival = mark.revival;
        self.targets.take_back(mark.targets);
    }
}
