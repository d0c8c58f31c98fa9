//! Random numbers for tests.

/// The next number of a linear congruential generator, 0 to 1, from its upper bits.
pub(super) fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}
