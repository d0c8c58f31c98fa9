//! The dampers of the problem.

use scenario::setting::Setting;
use serde::Serialize;

/// The state of all four yaw dampers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// As in the scenario: 2a = 0.2 mm, Ke = 12.5 MN/m.
    New,
    /// Worn to a clearance of 4 mm.
    Worn,
    /// New, in attachments of 3 MN/m.
    Soft,
}

/// All of them.
pub const CONDITIONS: [Condition; 3] = [Condition::New, Condition::Worn, Condition::Soft];

/// Clearance of a worn damper (m).
const WORN_2A_M: f64 = 4e-3;
/// Stiffness of soft attachments (N/m).
const SOFT_N_PER_M: f64 = 3e6;

impl Condition {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Worn => "worn",
            Self::Soft => "soft",
        }
    }

    /// Whether the aims are asked with it; the others are shown.
    pub const fn has_aims(self) -> bool {
        matches!(self, Self::New | Self::Worn)
    }

    /// Speed at which it hunts (km/h): so far above its critical speed that all runs settle in the
    /// same limit cycle. Nearer to it a cycle in which one bogie moves more than the other exists
    /// beside it, and cycles whose size varies slowly.
    pub const fn hunting_kmh(self) -> f64 {
        match self {
            Self::New => 265.0,
            Self::Worn => 280.0,
            Self::Soft => 255.0,
        }
    }

    /// Speed from which its hunting is followed down to the critical speed (km/h).
    pub const fn from_above_kmh(self) -> f64 {
        match self {
            Self::New => 260.0,
            Self::Worn => 200.0,
            Self::Soft => 225.0,
        }
    }

    /// What it changes in the scenario.
    pub fn settings(self) -> Vec<Setting> {
        match self {
            Self::New => Vec::new(),
            Self::Worn => vec![Setting::to("damper.clearance_2a_m", WORN_2A_M)],
            Self::Soft => vec![Setting::to("damper.ke_n_per_m", SOFT_N_PER_M)],
        }
    }
}
