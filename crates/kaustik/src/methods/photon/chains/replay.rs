//! A step of a chain of photons, shown once more.

use kaustik_estimate::PhotonValue;
use kaustik_film::Film;
use kaustik_mcmc::{Recorder, Statistics, Visit};
use kaustik_path::{Event, Role, note, trace};

use super::iteration::{Iteration, Kernels, Step, Sweeps, Unheard};
use super::{Chains, PhotonChains};
use crate::StepId;
use crate::methods::photon::stage::Stage;

impl<const K: usize> PhotonChains<K> {
    /// Where a place lies; `None` of a ladder without chains.
    pub(super) fn step(&self, stage: &Stage<'_>, StepId { ladder, step }: StepId) -> Option<Step> {
        let course = self.course(stage, self.ladders.len());
        course.step(u64::from(ladder), step)
    }

    /// Tells what happens in the step at this place, of the iteration that the stage has begun: the path
    /// where the chain is, the one that it may go to unless it rests there, and what either brings to the
    /// picture in the sweep of this step. Other ladders stay where they are: nobody learns from them before
    /// the iteration ends.
    pub(super) fn show(
        &mut self,
        stage: &Stage<'_>,
        spare: &mut Film,
        place: StepId,
    ) -> Vec<Event> {
        let Some(step) = self.step(stage, place) else {
            return Vec::new();
        };
        self.begin(stage);
        self.read_anew(stage);
        let mut ladders = std::mem::take(&mut self.ladders);
        self.renew_films(spare);
        let iteration = self.shared(stage, spare, ladders.len());
        let mut heard = Heard {
            sweep: step.sweep,
            level: step.level,
            events: [
                ("iteration", step.iteration),
                ("sweep", step.sweep),
                ("chain", step.level as u64),
            ]
            .map(|(of, number)| Event::Index { of, number })
            .to_vec(),
        };
        let index = place.ladder as usize;
        iteration.run(index, &mut ladders[index], &mut heard);
        heard.events
    }
}

/// Listens to one chain in one sweep.
struct Heard {
    sweep: u64,
    level: usize,
    events: Vec<Event>,
}

impl Heard {
    fn listen<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (result, events) = trace(work);
        self.events.extend(events);
        result
    }
}

impl<const K: usize> Sweeps<K> for Heard {
    fn end(&mut self, sweep: u64) -> bool {
        sweep > self.sweep
    }

    /// As of a render: a step of every chain that takes one, then exchanges.
    fn sweep<R: Recorder<PhotonValue, K>>(
        &mut self,
        number: u64,
        chains: &mut Chains<K>,
        of: (&Iteration<'_, K>, &Kernels<'_, K>),
        recorder: &mut R,
    ) {
        if number != self.sweep {
            Unheard { stop: None }.sweep(number, chains, of, recorder);
            return;
        }
        let (Iteration { course, levels, .. }, kernels) = of;
        let Chains { ladder, draws, .. } = chains;
        for (level, kernel) in kernels.iter().enumerate() {
            let (steps, heard) = (course.steps(level, number), level == self.level);
            if heard {
                let mut chain = ladder.replicas()[level].clone();
                self.listen(|| {
                    note(|| Event::LightPath {
                        role: Role::Current,
                    });
                    // Of a chain that goes no further: what it draws is drawn by nobody else.
                    chain.evaluate_again(
                        &kernel.target,
                        &mut PhotonValue::default(),
                        &mut draws.clone(),
                    );
                });
            }
            if !steps {
                continue;
            }
            if !heard {
                ladder.step_at(level, kernel, *levels, draws, recorder);
                continue;
            }
            let before = accepted(ladder.replicas()[level].statistics());
            self.listen(|| {
                note(|| Event::LightPath {
                    role: Role::Proposed,
                });
                ladder.step_at(level, kernel, *levels, draws, recorder);
            });
            let accepted = accepted(ladder.replicas()[level].statistics()) > before;
            self.events.push(Event::Decision { accepted });
        }
        if course.exchanges(number) {
            ladder.exchange(kernels, draws, &mut Filtered { recorder, to: self });
        }
    }

    fn flush<R: Recorder<PhotonValue, K>>(
        &mut self,
        number: u64,
        chains: &mut Chains<K>,
        recorder: &mut R,
    ) {
        if number == self.sweep {
            (chains.ladder).flush(&mut Filtered { recorder, to: self });
        } else {
            chains.ladder.flush(recorder);
        }
    }
}

/// Listens to the visits of one chain alone.
struct Filtered<'a, R> {
    recorder: &'a mut R,
    to: &'a mut Heard,
}

impl<R: Recorder<PhotonValue, K>, const K: usize> Recorder<PhotonValue, K> for Filtered<'_, R> {
    fn record(&mut self, visit: Visit<'_, PhotonValue, K>) {
        let Self { recorder, to } = self;
        if visit.level == to.level {
            to.listen(|| recorder.record(visit));
        } else {
            recorder.record(visit);
        }
    }
}

/// Proposals of a chain that were accepted.
fn accepted<const K: usize>(statistics: &Statistics<K>) -> u64 {
    statistics.moves.iter().map(|kind| kind.accepted).sum()
}
