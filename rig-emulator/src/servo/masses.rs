//! The two moving masses: the ram, and the end mass on the fixture.
//!
//! ```text
//! M (v+ - v-) = h (F - C (v+ + v-) / 2)        C = [b + d, -d; -d, d]
//! ```
//!
//! Velocities stand in the middle of the substeps and forces at their ends, so that springs neither
//! gain nor lose energy; friction `b` and the damping `d` of the fixture act on the mean of both
//! velocities and are solved exactly.

/// Ram and end mass for one length of substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Masses {
    friction_n_s_per_m: f64,
    fixture_n_s_per_m: f64,
    /// `h (M + h C / 2)^-1`, symmetric: its diagonal and its other element (s/kg).
    gain: [f64; 3],
}

impl Masses {
    /// Ram and end mass (kg), friction of the ram and damping of the fixture (N s/m), for substeps
    /// of this length (s).
    pub(crate) fn new(
        [ram_kg, end_kg]: [f64; 2],
        [friction_n_s_per_m, fixture_n_s_per_m]: [f64; 2],
        step_s: f64,
    ) -> Self {
        debug_assert!(ram_kg > 0.0 && end_kg > 0.0, "masses of {ram_kg} kg and {end_kg} kg");
        let half_s = 0.5 * step_s;
        let ram = ram_kg + half_s * (friction_n_s_per_m + fixture_n_s_per_m);
        let end = end_kg + half_s * fixture_n_s_per_m;
        let coupling = -half_s * fixture_n_s_per_m;
        let scale = step_s / (ram * end - coupling * coupling);
        Self {
            friction_n_s_per_m,
            fixture_n_s_per_m,
            gain: [scale * end, scale * ram, -scale * coupling],
        }
    }

    /// Velocities (m/s) after a substep in which these forces (N) push the masses.
    pub(crate) fn advance(&self, velocities: [f64; 2], forces_n: [f64; 2]) -> [f64; 2] {
        let [ram_m_per_s, end_m_per_s] = velocities;
        let [ram_n, end_n] = forces_n;
        let fixture_n = self.fixture_n_s_per_m * (ram_m_per_s - end_m_per_s);
        let ram_n = ram_n - self.friction_n_s_per_m * ram_m_per_s - fixture_n;
        let end_n = end_n + fixture_n;
        let [of_ram, of_end, coupling] = self.gain;
        [
            ram_m_per_s + of_ram * ram_n + coupling * end_n,
            end_m_per_s + coupling * ram_n + of_end * end_n,
        ]
    }
}
