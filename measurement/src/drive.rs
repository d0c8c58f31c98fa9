//! How a body on a damper was driven: its force between two samples, and its motion before the
//! first one.

use serde::Deserialize;

/// The table `[on_mass]` of a mapping.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnMass {
    /// The force between two samples.
    #[serde(default)]
    pub inter_sample: InterSample,
    /// The motion before the first sample; found from the record where it is not stated.
    pub start: Option<BodyStart>,
    /// Samples of one period of a periodic record.
    pub period_samples: Option<usize>,
}

/// The force between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InterSample {
    /// Without content above half the sampling rate: a measured force, or a multisine.
    #[default]
    BandLimited,
    /// Constant until the next sample: the command of a converter.
    Hold,
}

/// The motion before the first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyStart {
    /// At rest at zero displacement.
    Rest,
    /// Any motion: displacement and velocity at the first sample are fitted.
    Moving,
    /// The motion of the same period before, and of the one before it.
    Periodic,
}

impl InterSample {
    /// As it is written in a mapping.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BandLimited => "band-limited",
            Self::Hold => "hold",
        }
    }
}

impl BodyStart {
    /// As it is written in a mapping.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Moving => "moving",
            Self::Periodic => "periodic",
        }
    }
}
