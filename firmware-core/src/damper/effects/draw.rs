//! What a campaign draws for an effect: the tests in which it acts, and its shape.
//!
//! An effect turns a draw and one strength into its parameters ([`DamperEffect::drawn`]): one
//! parameter grows with the strength from vanishing to [`DamperEffect::STRONGEST`], the others are
//! given by the shape. The draw is made elsewhere; nothing here is random.
//!
//! [`DamperEffect::drawn`]: super::DamperEffect::drawn
//! [`DamperEffect::STRONGEST`]: super::DamperEffect::STRONGEST

use super::parameter::Scale;
use crate::damper::nominal::Nominal;

/// The tests and the shape of an effect whose strength is still open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// The damper that has the effect.
    pub nominal: Nominal,
    /// The relief force, and the greatest velocity, stroke and positions of the tests.
    pub scale: Scale,
    /// Three numbers between 0 and 1 that give the effect its shape.
    pub shape: [f64; 3],
    /// 1 or -1: the direction of an effect that has one.
    pub sign: f64,
}

/// The value at a share of the way between two values.
pub(super) fn between(share: f64, from: f64, to: f64) -> f64 {
    from + share * (to - from)
}

/// The same, evenly over decades.
pub(super) fn decades(share: f64, from: f64, to: f64) -> f64 {
    from * libm::pow(to / from, share)
}
