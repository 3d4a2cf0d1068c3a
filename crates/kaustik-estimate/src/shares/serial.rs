//! Shares written down and read again (feature `serde`).

use kaustik_mcmc::Mean;
use serde::{Deserialize, Serialize};

use super::ReplicaShares;

/// What a replica has: its samples, what its film holds and the squares of it, visits up and down, the replica below.
type Replica = (Mean, [f64; 2], [f64; 2], u8);

/// One entry a replica, and the mean over all.
#[derive(Serialize, Deserialize)]
pub(super) struct Written {
    replicas: Vec<Replica>,
    whole: Mean,
}

impl<const K: usize> From<ReplicaShares<K>> for Written {
    fn from(shares: ReplicaShares<K>) -> Self {
        let replica = |k: usize| {
            (
                shares.parts[k],
                [shares.held[k], shares.squares[k]],
                [shares.up[k], shares.down[k]],
                shares.below[k] as u8,
            )
        };
        Self {
            replicas: (0..K).map(replica).collect(),
            whole: shares.whole,
        }
    }
}

impl<const K: usize> TryFrom<Written> for ReplicaShares<K> {
    type Error = &'static str;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        let replicas: [Replica; K] =
            (written.replicas.try_into()).map_err(|_| "shares of another number of replicas")?;
        let below = replicas.map(|(.., below)| usize::from(below));
        let ordered = |(k, &below): (usize, &usize)| k == 0 || below < k;
        if !below.iter().enumerate().all(ordered) {
            return Err("a replica stands on one that is not before it");
        }
        Ok(Self {
            parts: replicas.map(|(mean, ..)| mean),
            whole: written.whole,
            held: replicas.map(|(_, [held, _], ..)| held),
            squares: replicas.map(|(_, [_, squares], ..)| squares),
            up: replicas.map(|(_, _, [up, _], _)| up),
            down: replicas.map(|(_, _, [_, down], _)| down),
            below,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_and_nothing_else() {
        let mut shares = ReplicaShares::<3>::on([0, 0, 0]);
        for i in 0..50 {
            shares.sample([1.0, f64::from(i) / 7.0, 0.0]);
            shares.scout(2, f64::from(i % 3));
            shares.hold(1, 0.3, 1.0 / 3.0);
            shares.visit(0, 1.0, &[1.0, 0.4, 0.7]);
            shares.visit(2, 0.2, &[1.0, 0.4, 0.7]);
        }
        let bytes = postcard::to_allocvec(&shares).expect("bytes");
        assert_eq!(postcard::from_bytes(&bytes), Ok(shares));
        assert!(postcard::from_bytes::<ReplicaShares<4>>(&bytes).is_err());
        let broken = |change: fn(&mut Written)| {
            let mut written = Written::from(shares);
            change(&mut written);
            ReplicaShares::<3>::try_from(written).is_err()
        };
        assert!(!broken(|_| ()));
        assert!(broken(|written| written.replicas[2].3 = 2));
        assert!(broken(|written| written.replicas[1].3 = 1));
        assert!(broken(|written| written.replicas.truncate(2)));
    }
}
