//! The methods by name.

use std::fmt;
use std::str::FromStr;

use crate::settings::key::{KEYS, Key};
use crate::settings::photon_options::PHOTONS;

/// A way to compute the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Path tracing from the camera.
    Path,
    /// Light tracing to the camera.
    Light,
    /// Bidirectional path tracing.
    Bdpt,
    /// Primary sample space Metropolis light transport (Kelemen 2002).
    Pssmlt,
    /// Multiplexed Metropolis light transport (Hachisuka 2014).
    Mmlt,
    /// Replica exchange light transport (Kitaoka 2009).
    #[default]
    Relt,
    /// Energy redistribution on primary samples (Cline 2005).
    ErptPss,
    /// Population annealing alone (Kitaoka 2009, section 6).
    Annealing,
    /// Metropolis light transport on paths (Veach and Guibas 1997).
    Mlt,
    /// Energy redistribution on paths (Cline 2005).
    Erpt,
    /// Stochastic progressive photon mapping (Hachisuka and Jensen 2009).
    Sppm,
    /// Photons of chains that follow visibility (Hachisuka and Jensen 2011).
    PhotonVisibility,
    /// Photons of chains that follow the inverse of a pilot's density (Chen 2011).
    PhotonDensity,
    /// Photons of chains that follow the spatial target function (Gruson 2016).
    PhotonSpatial,
    /// Photons of chains that follow the spatial target function over regions of the image (Gruson 2016).
    PhotonImage,
    /// [`Mlt`](Self::Mlt) in stages that even out the relative error (Hoberock and Hart 2010).
    MltMultistage,
    /// [`Pssmlt`](Self::Pssmlt) in stages that even out the relative error (Hoberock and Hart 2010).
    PssmltMultistage,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 17] = [
        Self::Path,
        Self::Light,
        Self::Bdpt,
        Self::Pssmlt,
        Self::Mmlt,
        Self::Relt,
        Self::ErptPss,
        Self::Annealing,
        Self::Mlt,
        Self::Erpt,
        Self::Sppm,
        Self::PhotonVisibility,
        Self::PhotonDensity,
        Self::PhotonSpatial,
        Self::PhotonImage,
        Self::MltMultistage,
        Self::PssmltMultistage,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Light => "light",
            Self::Bdpt => "bdpt",
            Self::Pssmlt => "pssmlt",
            Self::Mmlt => "mmlt",
            Self::Relt => "relt",
            Self::ErptPss => "erpt-pss",
            Self::Annealing => "annealing",
            Self::Mlt => "mlt",
            Self::Erpt => "erpt",
            Self::Sppm => "sppm",
            Self::PhotonVisibility => "photon-visibility",
            Self::PhotonDensity => "photon-density",
            Self::PhotonSpatial => "photon-spatial",
            Self::PhotonImage => "photon-image",
            Self::MltMultistage => "mlt-multistage",
            Self::PssmltMultistage => "pssmlt-multistage",
        }
    }

    /// One line about it.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Path => {
                "path tracing with next-event estimation and multiple importance sampling"
            }
            Self::Light => {
                "light tracing: walks from the emitters, every vertex joined to the lens"
            }
            Self::Bdpt => {
                "bidirectional path tracing: walks from emitters and camera, joined in every way (Veach 1997)"
            }
            Self::Pssmlt => {
                "Metropolis light transport on primary samples (Kelemen, Szirmay-Kalos 2002)"
            }
            Self::Mmlt => {
                "Metropolis light transport over one strategy of bidirectional paths at a time (Hachisuka et al. 2014)"
            }
            Self::Relt => {
                "replica exchange: chains of rising difficulty that swap states (Kitaoka et al. 2009)"
            }
            Self::ErptPss => {
                "energy redistribution: path samples spread over their neighbours by short chains (Cline et al. 2005)"
            }
            Self::Annealing => {
                "population annealing: fresh populations climb from easy to hard paths (Kitaoka et al. 2009, 6)"
            }
            Self::Mlt => {
                "Metropolis light transport on paths: mutations trace what they change alone (Veach, Guibas 1997)"
            }
            Self::Erpt => {
                "energy redistribution on paths: path tracing whose light short chains of perturbations spread (Cline et al. 2005)"
            }
            Self::Sppm => {
                "photon mapping: photons counted at points that the camera sees, new ones an iteration (Hachisuka, Jensen 2009)"
            }
            Self::PhotonVisibility => {
                "photon mapping with chains that follow what the camera sees (Hachisuka, Jensen 2011)"
            }
            Self::PhotonDensity => {
                "photon mapping with chains that go where a pilot found few photons (Chen, Wang, Yong 2011)"
            }
            Self::PhotonSpatial => {
                "photon mapping with chains that even out the relative error, by regions of space (Gruson et al. 2016)"
            }
            Self::PhotonImage => {
                "photon mapping with chains that even out the relative error, by regions of the image (Gruson et al. 2016)"
            }
            Self::MltMultistage => {
                "mlt in stages, each evened out by the picture of those before it (Hoberock, Hart 2010)"
            }
            Self::PssmltMultistage => {
                "pssmlt in stages, each evened out by the picture of those before it (Hoberock, Hart 2010)"
            }
        }
    }

    /// What the steps of a render are, in the plural: what `--spp` counts, but for photon methods, where it counts
    /// iterations.
    pub fn steps(self) -> &'static str {
        match self {
            // of `erpt` with all that its chains take
            Self::Path | Self::Light | Self::Bdpt | Self::Erpt | Self::ErptPss => "samples",
            Self::Annealing => "paths",
            Self::Pssmlt
            | Self::Mmlt
            | Self::Mlt
            | Self::MltMultistage
            | Self::PssmltMultistage => "mutations",
            Self::Relt => "samples and mutations",
            Self::Sppm
            | Self::PhotonVisibility
            | Self::PhotonDensity
            | Self::PhotonSpatial
            | Self::PhotonImage => "light paths",
        }
    }

    /// Does it trace light paths toward measurement points?
    pub fn traces_photons(self) -> bool {
        PHOTONS.contains(&self)
    }

    /// Are its ladders independent, so that processes can each run a share of them? Those of photon methods learn
    /// from each other in every iteration, those of multi-stage methods in every stage.
    pub fn has_shares(self) -> bool {
        !(self.traces_photons() || matches!(self, Self::MltMultistage | Self::PssmltMultistage))
    }

    /// The settings that it reads.
    pub fn keys(self) -> impl Iterator<Item = &'static Key> {
        KEYS.iter().filter(move |key| key.methods.contains(&self))
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no method '{wanted}'; known are: {}", Method::ALL.map(Method::name).join(", "))]
pub struct UnknownMethod {
    /// The name.
    pub wanted: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        Self::ALL
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| UnknownMethod {
                wanted: name.to_owned(),
            })
    }
}
