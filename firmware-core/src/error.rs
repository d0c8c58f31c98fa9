//! What a caller can get wrong when it builds a damper, a track or a vehicle: one closed list for
//! the crate. Nothing that happens in a step is an error.

use core::fmt;

use crate::damper::DamperError;
use crate::track::LayoutError;
use crate::vehicle::VehicleError;

/// Why a part of the model cannot be built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Error {
    /// A damper, an effect or an empirical map.
    Damper(DamperError),
    /// A track layout.
    Layout(LayoutError),
    /// A vehicle.
    Vehicle(VehicleError),
}

impl Error {
    /// Whether the user's input is at fault. Always so here: the numbers come from the user's
    /// files.
    ///
    /// ```
    /// use firmware_core::Error;
    /// use firmware_core::track::Layout;
    /// let error = Error::from(Layout::tangent().hold(-1.0).unwrap_err());
    /// assert!(error.is_bad_input());
    /// assert_eq!(error.to_string(), "length_m = -1, expected a positive number");
    /// ```
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Damper(_) | Self::Layout(_) | Self::Vehicle(_) => true,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damper(error) => error.fmt(f),
            Self::Layout(error) => error.fmt(f),
            Self::Vehicle(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Error {}

impl From<DamperError> for Error {
    fn from(error: DamperError) -> Self {
        Self::Damper(error)
    }
}

impl From<LayoutError> for Error {
    fn from(error: LayoutError) -> Self {
        Self::Layout(error)
    }
}

impl From<VehicleError> for Error {
    fn from(error: VehicleError) -> Self {
        Self::Vehicle(error)
    }
}
