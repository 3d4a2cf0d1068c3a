//! What a paper claims, what was measured here, and whether it holds.

use crate::Results;

/// A claim that results can be held against.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// In our words, with the place in the paper.
    pub text: &'static str,
    /// Measures it.
    pub check: fn(&Results) -> Finding,
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Measured so.
    Holds,
    /// Measured otherwise.
    Fails,
    /// Cannot be told from these results.
    Open,
}

/// What was measured, in words, and the verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The figures.
    pub measured: String,
    /// What follows.
    pub verdict: Verdict,
}

/// A claim with its finding.
#[derive(Clone, Debug)]
pub struct Judged {
    /// In our words.
    pub claim: &'static str,
    /// What was measured.
    pub finding: Finding,
}

impl Verdict {
    /// In a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "does not hold",
            Self::Open => "open",
        }
    }
}

impl From<bool> for Verdict {
    fn from(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

impl Finding {
    /// With a verdict.
    #[must_use]
    pub fn new(measured: String, verdict: impl Into<Verdict>) -> Self {
        Self {
            measured,
            verdict: verdict.into(),
        }
    }

    /// What was needed is not there.
    #[must_use]
    pub fn open(why: &str) -> Self {
        Self::new(why.to_owned(), Verdict::Open)
    }
}

/// Holds claims against results.
#[must_use]
pub fn judge(claims: &[Claim], results: &Results) -> Vec<Judged> {
    let judged = |claim: &Claim| Judged {
        claim: claim.text,
        finding: (claim.check)(results),
    };
    claims.iter().map(judged).collect()
}
