//! Which replicas there are: rows of class weights.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use kaustik_path::Class;

/// Weights of path classes in one replica's density: `d_{k,0}` to `d_{k,5}` (RELT eq. 19), of [`Class::L0`] to
/// [`Class::L5`].
pub type ClassWeights = [f64; WEIGHED];

/// Classes that a row gives a weight to: the paper's.
const WEIGHED: usize = 6;
/// Weights in a row that are not 0: what they make of light stays a number.
const WEIGHTS: RangeInclusive<f64> = 1e-30..=1e30;

/// The replicas of a run (RELT 4.2.3): the uniform one, then a row of class
/// weights each.
///
/// Each stands on a replica before it, by default the one just before, and its support lies
/// within the support of that one: a class that it weighs is weighed there. It exchanges states
/// with the replica that it stands on, and with the nearest before it that stands on the same.
/// The paper's replicas stand in a line; other sets are partially ordered (RELT sec. 6), such as
/// [`sides`](Self::sides).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplicaSet {
    rows: [ClassWeights; ReplicaSet::MOST],
    /// The replica that each stands on.
    below: [usize; ReplicaSet::MOST],
    /// Steps of each in a sweep.
    repeats: [u32; ReplicaSet::MOST],
    scouts: u32,
    /// Steps of a tour of the last; 0: it goes on none.
    tour: u32,
    /// No replica but the uniform one weighs [`Class::L0`].
    leaves_specular: bool,
    count: usize,
}

/// Replicas in a line, a step each.
const LINE: ReplicaSet = ReplicaSet {
    rows: [[0.0; WEIGHED]; ReplicaSet::MOST],
    below: [0, 0, 1, 2, 3, 4, 5, 6],
    repeats: [1; ReplicaSet::MOST],
    scouts: 0,
    tour: 0,
    leaves_specular: false,
    count: 1,
};

impl ReplicaSet {
    /// The fewest replicas.
    pub const FEWEST: usize = 2;
    /// The most replicas.
    pub const MOST: usize = 8;
    /// `delta` of the specific replica (RELT 4.2.3 gives no number).
    pub const DELTA: f64 = 0.05;

    /// The most steps of a replica in a sweep.
    pub const MOST_REPEATS: u32 = 64;
    /// The most scouts a sweep.
    pub const MOST_SCOUTS: u32 = 1024;
    /// The most steps of a tour.
    pub const MOST_TOUR: u32 = 1024;

    /// The paper's four: uniform, full, indirect, specific, a step each in a sweep. `delta` > 0 is the share
    /// of joined paths in the last, which lets it exchange with the one before.
    pub fn paper(delta: f64) -> Self {
        let mut set = Self { count: 4, ..LINE };
        set.rows[1] = [1.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        set.rows[2] = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        set.rows[3] = [1.0, 0.0, 0.0, 0.0, 0.0, delta];
        set
    }

    /// The paper's four with more steps for the specific one, whose light takes longest to explore, most of them by
    /// tours, and with scouts for what is hardest to find.
    pub fn standard(delta: f64) -> Self {
        let mut set = Self::paper(delta);
        set.repeats[3] = SPECIFIC_REPEATS;
        set.tour = TOUR;
        set.scouts = SCOUTS;
        set
    }

    /// What path tracers find beside what light tracers find, both on the uniform replica: neither support
    /// is nested in the other. Joined paths, which both weigh, are where these two meet.
    pub fn sides() -> Self {
        let mut set = Self { count: 3, ..LINE };
        set.rows[1] = [1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
        set.rows[2] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        set.below[2] = 0;
        set
    }

    /// How many replicas there are, the uniform one included.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The class weights by replica; those of the uniform one, which has none, are zero.
    pub fn rows(&self) -> &[ClassWeights] {
        &self.rows[..self.count]
    }

    /// The replica that each stands on; what stands at 0 is not used.
    pub fn below(&self) -> &[usize] {
        &self.below[..self.count]
    }

    /// The weights of all classes in a replica's density. [`Class::L0Joined`] has that of [`Class::L0`], but in a
    /// specific replica none: that one is there for what nothing else finds.
    pub fn weights(&self, replica: usize) -> [f64; Class::COUNT] {
        let row = &self.rows()[replica];
        let mut weights = [0.0; Class::COUNT];
        weights[..WEIGHED].copy_from_slice(row);
        if !(self.is_specific() && replica == self.count - 1) {
            weights[Class::L0Joined as usize] = row[Class::L0 as usize];
        }
        if self.leaves_specular {
            weights[Class::L0 as usize] = 0.0;
        }
        weights
    }

    /// The same replicas with [`Class::L0`] removed from every density, for use where independent samples
    /// find that light as well as a chain does. This leaves a specific replica nothing to do.
    #[must_use]
    pub fn leaving_specular(self) -> Self {
        Self {
            leaves_specular: true,
            ..self
        }
    }

    /// Steps of each in a sweep, at least one.
    pub fn repeats(&self) -> &[u32] {
        &self.repeats[..self.count]
    }

    /// Scouts a sweep: independent walks from the camera alone, which look for implicit specular paths for the
    /// specific replica.
    pub fn scouts(&self) -> u32 {
        self.scouts
    }

    /// Steps of a tour ([`Metropolis::step_by_tour`](kaustik_mcmc::Metropolis::step_by_tour)): all of the specific
    /// replica's [`repeats`](Self::repeats) but the first are by tours of so many steps. 0 if there are none.
    pub fn tour(&self) -> u32 {
        self.tour
    }

    /// Does each stand on the one just before?
    pub fn is_line(&self) -> bool {
        self.below() == &LINE.below[..self.count]
    }

    /// The first `count` replicas' pairs that exchange states: each with the one that it stands on, and with
    /// the one before it that stands on the same.
    pub fn pairs(&self, count: usize) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        for k in 1..count.min(self.count) {
            pairs.push((self.below[k], k));
            let sibling = (1..k).rev().find(|&j| self.below[j] == self.below[k]);
            pairs.extend(sibling.map(|sibling| (sibling, k)));
        }
        pairs
    }

    /// Is the last replica there for implicit specular paths: does it weigh them more than any
    /// other class? Then those that nothing else finds ([`Class::L0`]) go to its film alone (RELT 5.1.4).
    pub fn is_specific(&self) -> bool {
        let [specular, rest @ ..] = self.rows[self.count - 1];
        self.count > Self::FEWEST && rest.iter().all(|&weight| weight < specular)
    }

    /// Adds a replica, for which there is room: six numbers, then `*N` for N steps a sweep, `~T` for tours of T steps, and
    /// `@B` for the replica, counted from 1, that it stands on, if it is not the one before.
    fn add(&mut self, word: &str) -> Result<(), ReplicaSetError> {
        let (word, below) = match word.split_once('@') {
            Some((word, below)) => (word, number(below, self.count)? - 1),
            None => (word, self.count - 1),
        };
        let (word, tour) = with_tour(word)?;
        let (word, repeats) = with_repeats(word)?;
        let replica = self.count + 1;
        // Tours are the last one's.
        if self.tour > 0 || (tour > 0 && repeats < 2) {
            return Err(ReplicaSetError::Tours);
        }
        self.tour = tour;
        let row = row(word).ok_or_else(|| ReplicaSetError::Row {
            replica,
            found: word.to_owned(),
        })?;
        let outside = |class: &Class| {
            let class = *class as usize;
            row[class] > 0.0 && self.rows[below][class] <= 0.0
        };
        let mut weighed = Class::ALL.into_iter().take(WEIGHED);
        if let Some(class) = weighed.find(outside).filter(|_| below > 0) {
            return Err(ReplicaSetError::Nesting {
                replica,
                class,
                below: below + 1,
            });
        }
        self.rows[self.count] = row;
        self.below[self.count] = below;
        self.repeats[self.count] = repeats;
        self.count += 1;
        Ok(())
    }
}

/// Steps of the specific replica in a sweep of the standard set.
const SPECIFIC_REPEATS: u32 = 3;
/// Steps of a tour in the standard set.
const TOUR: u32 = 8;
/// Scouts a sweep of the standard set. Most turn round at the first surface.
const SCOUTS: u32 = 16;

impl fmt::Display for ReplicaSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("uniform")?;
        for (k, row) in self.rows().iter().enumerate() {
            if k > 0 {
                let words = row.map(|weight| weight.to_string());
                write!(f, ";{}", words.join(","))?;
            }
            if self.repeats[k] > 1 {
                write!(f, "*{}", self.repeats[k])?;
            }
            if k + 1 == self.count && self.tour > 0 {
                write!(f, "~{}", self.tour)?;
            }
            if k == 0 && self.scouts > 0 {
                write!(f, "+{}", self.scouts)?;
            }
            if k > 0 && self.below[k] + 1 != k {
                write!(f, "@{}", self.below[k] + 1)?;
            }
        }
        Ok(())
    }
}

/// Why a text names no replicas. They are counted from 1, the uniform one.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReplicaSetError {
    /// The first is not `uniform`.
    NotUniform(String),
    /// Fewer than [`ReplicaSet::FEWEST`] or more than [`ReplicaSet::MOST`].
    Count(usize),
    /// A replica's weights are not one number for each class, 0 or from 1e-30 to 1e30, at least one of them positive.
    Row {
        /// The replica.
        replica: usize,
        /// What stands in place of weights.
        found: String,
    },
    /// A replica weighs a class that the one it stands on does not.
    Nesting {
        /// The replica.
        replica: usize,
        /// The class.
        class: Class,
        /// What it stands on.
        below: usize,
    },
    /// Steps a sweep that are no number from 1 to [`ReplicaSet::MOST_REPEATS`].
    Repeats(String),
    /// Scouts a sweep that are no number up to [`ReplicaSet::MOST_SCOUTS`].
    Scouts(String),
    /// Steps of a tour that are no number from 1 to [`ReplicaSet::MOST_TOUR`].
    Tour(String),
    /// Tours of another than a specific replica that has at least two steps a sweep.
    Tours,
    /// A replica stands on one that is not before it.
    Below {
        /// The replica.
        replica: usize,
        /// What it is said to stand on.
        found: String,
    },
}

impl fmt::Display for ReplicaSetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (fewest, most) = (ReplicaSet::FEWEST, ReplicaSet::MOST);
        match self {
            Self::NotUniform(found) => {
                write!(f, "the first replica is to be 'uniform', not '{found}'")
            }
            Self::Count(found) => write!(f, "{found} replicas, not {fewest} to {most}"),
            Self::Row { replica, found } => write!(
                f,
                "replica {replica} is '{found}', not {WEIGHED} numbers >= 0, one of them positive"
            ),
            Self::Nesting {
                replica,
                class,
                below,
            } => write!(
                f,
                "replica {replica} weighs class {class:?}, and replica {below}, on which it stands, does not"
            ),
            Self::Repeats(found) => {
                let most = ReplicaSet::MOST_REPEATS;
                write!(f, "'*{found}' is no number of steps from 1 to {most}")
            }
            Self::Scouts(found) => {
                let most = ReplicaSet::MOST_SCOUTS;
                write!(f, "'+{found}' is no number of scouts up to {most}")
            }
            Self::Tour(found) => {
                let most = ReplicaSet::MOST_TOUR;
                write!(f, "'~{found}' is no number of steps of a tour from 1 to {most}")
            }
            Self::Tours => f.write_str(
                "tours ('~T') are for the last replica, if it weighs class L0 more than any other and has two steps a \
                 sweep or more ('*2~T')",
            ),
            Self::Below { replica, found } => {
                write!(
                    f,
                    "replica {replica} stands on '@{found}', which is none before it"
                )
            }
        }
    }
}

impl std::error::Error for ReplicaSetError {}

impl FromStr for ReplicaSet {
    type Err = ReplicaSetError;

    /// `paper` (with the default delta), `sides`, or `uniform;1,0,1,1,1,1;...`, each with `*N` for N steps a
    /// sweep and `@B` for the replica that it stands on, the last one with `~T` for tours of T steps, and `uniform+N`
    /// with N scouts a sweep.
    fn from_str(text: &str) -> Result<Self, ReplicaSetError> {
        match text {
            "sides" => return Ok(Self::sides()),
            "paper" => return Ok(Self::paper(Self::DELTA)),
            _ => {}
        }
        let mut words = text.split(';').map(str::trim);
        let mut set = LINE;
        let mut first = words.next().unwrap_or_default();
        if let Some((word, scouts)) = first.split_once('+') {
            let known = (scouts.trim().parse().ok()).filter(|n| *n <= Self::MOST_SCOUTS);
            let unknown = || ReplicaSetError::Scouts(scouts.trim().to_owned());
            (first, set.scouts) = (word.trim(), known.ok_or_else(unknown)?);
        }
        let (first, repeats) = with_repeats(first)?;
        if first != "uniform" {
            return Err(ReplicaSetError::NotUniform(first.to_owned()));
        }
        set.repeats[0] = repeats;
        let count = text.split(';').count();
        if count > Self::MOST {
            return Err(ReplicaSetError::Count(count));
        }
        for word in words {
            set.add(word)?;
        }
        if set.count < Self::FEWEST {
            return Err(ReplicaSetError::Count(set.count));
        }
        if set.tour > 0 && !set.is_specific() {
            return Err(ReplicaSetError::Tours);
        }
        Ok(set)
    }
}

/// A word without its `*N`, and N.
fn with_repeats(word: &str) -> Result<(&str, u32), ReplicaSetError> {
    let Some((word, repeats)) = word.split_once('*') else {
        return Ok((word, 1));
    };
    let repeats = repeats.trim();
    let known = (repeats.parse().ok()).filter(|n| (1..=ReplicaSet::MOST_REPEATS).contains(n));
    let unknown = || ReplicaSetError::Repeats(repeats.to_owned());
    Ok((word.trim(), known.ok_or_else(unknown)?))
}

/// A word without its `~T`, and T; 0 without one.
fn with_tour(word: &str) -> Result<(&str, u32), ReplicaSetError> {
    let Some((word, tour)) = word.split_once('~') else {
        return Ok((word, 0));
    };
    let tour = tour.trim();
    let known = (tour.parse().ok()).filter(|n| (1..=ReplicaSet::MOST_TOUR).contains(n));
    let unknown = || ReplicaSetError::Tour(tour.to_owned());
    Ok((word.trim(), known.ok_or_else(unknown)?))
}

/// A replica counted from 1, of so many.
fn number(text: &str, count: usize) -> Result<usize, ReplicaSetError> {
    let known = (text.trim().parse().ok()).filter(|n| (1..=count).contains(n));
    known.ok_or_else(|| ReplicaSetError::Below {
        replica: count + 1,
        found: text.trim().to_owned(),
    })
}

fn row(text: &str) -> Option<ClassWeights> {
    let numbers: Option<Vec<f64>> = (text.split(','))
        .map(|word| word.trim().parse().ok())
        .collect();
    let row: ClassWeights = numbers?.try_into().ok()?;
    let sound = row
        .iter()
        .all(|weight| WEIGHTS.contains(weight) || *weight == 0.0);
    (sound && row.iter().any(|&weight| weight > 0.0)).then_some(row)
}

#[cfg(test)]
mod tests;
