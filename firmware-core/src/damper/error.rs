//! What can be wrong with a damper's description.

use core::fmt;

/// Why a damper, or one of its effects, cannot be built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DamperError {
    /// A parameter is not finite or lies outside what is possible.
    Parameter {
        /// The part it belongs to: `damper`, or the effect's name.
        owner: &'static str,
        /// The parameter, with its unit at the end of the name.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// Smallest value accepted.
        lower: f64,
        /// Largest value accepted.
        upper: f64,
    },
    /// An effect was given the wrong number of values.
    ValueCount {
        /// The effect.
        effect: &'static str,
        /// How many values were given.
        given: usize,
        /// How many its parameter table has.
        expected: usize,
    },
    /// No effect has this name.
    UnknownEffect,
    /// The same effect was given twice.
    RepeatedEffect {
        /// The effect.
        effect: &'static str,
    },
    /// More effects than a damper holds.
    TooManyEffects {
        /// How many were given.
        given: usize,
        /// How many fit.
        limit: usize,
    },
    /// The effects together bend a law at more points than its table holds.
    TooManyKnots {
        /// `attachment` or `body`.
        law: &'static str,
        /// How many fit.
        limit: usize,
    },
    /// The effects together make the attachment or the body softer than nothing: the law would
    /// fall where it has to rise.
    NotMonotone {
        /// `attachment` or `body`.
        law: &'static str,
    },
    /// An empirical map has too few or too many knots.
    MapKnots {
        /// How many were given.
        given: usize,
        /// How many it takes.
        fewest: usize,
        /// How many fit.
        most: usize,
    },
    /// A knot of an empirical map does not lie beyond the one before it.
    MapNotRising {
        /// Where it lies.
        at: f64,
        /// Where the one before it lies.
        after: f64,
    },
}

impl fmt::Display for DamperError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter { owner, parameter, value, lower, upper } => {
                write!(f, "{owner}: {parameter} = {value} is outside {lower} to {upper}")
            }
            Self::ValueCount { effect, given, expected } => {
                write!(f, "{effect}: {given} values given, {expected} expected")
            }
            Self::UnknownEffect => write!(f, "no effect has this name"),
            Self::RepeatedEffect { effect } => write!(f, "{effect}: given twice"),
            Self::TooManyEffects { given, limit } => {
                write!(f, "{given} effects given, at most {limit}")
            }
            Self::TooManyKnots { law, limit } => {
                write!(f, "the law of the {law} has more than {limit} knots")
            }
            Self::NotMonotone { law } => write!(f, "the law of the {law} is not rising"),
            Self::MapKnots { given, fewest, most } => {
                write!(f, "empirical: {given} knots given, {fewest} to {most} expected")
            }
            Self::MapNotRising { at, after } => {
                write!(f, "empirical: a knot at {at} after one at {after}, expected rising places")
            }
        }
    }
}

impl core::error::Error for DamperError {}
