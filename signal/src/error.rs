//! What a signal can lack.

use std::fmt;

/// Why a signal cannot be analysed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SignalError {
    /// Fewer samples than the analysis needs: given, least.
    TooShort(usize, usize),
    /// A parameter outside its bounds: name, value, what was expected.
    Parameter(&'static str, f64, &'static str),
    /// A sample that is not a number, by its index.
    NotFinite(usize),
}

impl fmt::Display for SignalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort(given, least) => {
                write!(f, "signal has {given} samples, expected at least {least}")
            }
            Self::Parameter(name, value, expected) => {
                write!(f, "{name} = {value}, expected {expected}")
            }
            Self::NotFinite(index) => write!(f, "sample {index} of the signal is not finite"),
        }
    }
}

impl std::error::Error for SignalError {}
