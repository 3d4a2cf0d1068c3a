//! Which of a light path's meetings are its first at a point, and its first in a leaf.

use crate::photon_target::Meeting;

/// Paths of no more meetings are looked through each time: most have a few.
const FEW: usize = 64;

/// Room for the answers of one path after the other.
#[derive(Debug, Default)]
pub(crate) struct FirstMeetings {
    /// Numbers of the meetings: by point, then as they come.
    order: Vec<u32>,
    /// Where each stands in that order.
    places: Vec<u32>,
    of_point: Vec<bool>,
    of_leaf: Vec<bool>,
}

/// The answers for one path.
pub(crate) enum Firsts<'a> {
    /// By looking through the meetings before.
    Few,
    /// By tables.
    Many(&'a FirstMeetings),
}

impl FirstMeetings {
    /// For meetings that lie in these leaves.
    pub(crate) fn of(&mut self, meetings: &[Meeting], leaves: &[u32]) -> Firsts<'_> {
        if meetings.len() <= FEW {
            return Firsts::Few;
        }
        let Self {
            order,
            places,
            of_point,
            of_leaf,
        } = self;
        order.clear();
        order.extend(0..meetings.len() as u32);
        let point = |at: u32| meetings[at as usize].point;
        mark(order, of_leaf, |at| leaves[point(at) as usize]);
        // last, as this is the order that is kept
        mark(order, of_point, point);
        places.resize(order.len(), 0);
        for (place, &at) in (0..).zip(order.iter()) {
            places[at as usize] = place;
        }
        Firsts::Many(self)
    }
}

/// Marks the first of those that have a key in common.
fn mark(order: &mut [u32], firsts: &mut Vec<bool>, key: impl Fn(u32) -> u32) {
    order.sort_unstable_by_key(|&at| (key(at), at));
    firsts.clear();
    firsts.resize(order.len(), true);
    for pair in order.windows(2) {
        firsts[pair[1] as usize] = key(pair[0]) != key(pair[1]);
    }
}

impl Firsts<'_> {
    /// Is the meeting of this number the path's first at its point? Those of its photon begin at `own`: a photon meets no
    /// point twice.
    #[inline]
    pub(crate) fn at_point(&self, meetings: &[Meeting], at: usize, own: usize) -> bool {
        match self {
            Self::Few => {
                let point = meetings[at].point;
                !meetings[..own].iter().any(|other| other.point == point)
            }
            Self::Many(firsts) => firsts.of_point[at],
        }
    }

    /// Tells of the meeting of this number and of all later ones at its point, in their order.
    #[inline]
    pub(crate) fn each_at_its_point(
        &self,
        meetings: &[Meeting],
        at: usize,
        mut tell: impl FnMut(&Meeting),
    ) {
        let point = meetings[at].point;
        match self {
            Self::Few => {
                let there = meetings[at..]
                    .iter()
                    .filter(|meeting| meeting.point == point);
                there.for_each(tell);
            }
            Self::Many(firsts) => {
                let place = firsts.places[at] as usize;
                (firsts.order[place..].iter())
                    .map(|&at| &meetings[at as usize])
                    .take_while(|meeting| meeting.point == point)
                    .for_each(&mut tell);
            }
        }
    }

    /// Is it the first in its leaf?
    #[inline]
    pub(crate) fn in_leaf(&self, meetings: &[Meeting], at: usize, leaves: &[u32]) -> bool {
        match self {
            Self::Few => {
                let leaf = |meeting: &Meeting| leaves[meeting.point as usize];
                let here = leaf(&meetings[at]);
                !(meetings[..at].iter().rev()).any(|other| leaf(other) == here)
            }
            Self::Many(firsts) => firsts.of_leaf[at],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables say what looking through says, for photons that meet each point once at most.
    #[test]
    fn many_are_told_as_few_are() {
        let leaves: Vec<u32> = (0..40).map(|point| point % 7).collect();
        let meetings: Vec<Meeting> = (0..9_u32)
            .flat_map(|photon| {
                (0..12_u32).map(move |i| Meeting {
                    photon,
                    point: (photon * 5 + i * 3) % 40,
                })
            })
            .collect();
        assert!(meetings.len() > FEW);
        let mut room = FirstMeetings::default();
        let many = room.of(&meetings, &leaves);
        assert!(matches!(many, Firsts::Many(_)));
        for at in 0..meetings.len() {
            let own = at / 12 * 12;
            assert_eq!(
                many.at_point(&meetings, at, own),
                Firsts::Few.at_point(&meetings, at, own)
            );
            let later = |firsts: &Firsts<'_>| {
                let mut photons = Vec::new();
                firsts.each_at_its_point(&meetings, at, |meeting| photons.push(meeting.photon));
                photons
            };
            assert_eq!(later(&many), later(&Firsts::Few));
            assert_eq!(
                many.in_leaf(&meetings, at, &leaves),
                Firsts::Few.in_leaf(&meetings, at, &leaves)
            );
        }
    }
}
