//! The four cases: mass and damping of the frame.

/// A case of the benchmark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Its number in the publication.
    pub number: u8,
    /// Mass of each floor, kg.
    pub floor_mass_kg: f64,
    /// Damping ratio of each mode.
    pub damping_ratio: f64,
}

/// All cases.
pub const CASES: [Case; 4] = [
    Case { number: 1, floor_mass_kg: 1000.0, damping_ratio: 0.05 },
    Case { number: 2, floor_mass_kg: 1100.0, damping_ratio: 0.04 },
    Case { number: 3, floor_mass_kg: 1300.0, damping_ratio: 0.03 },
    Case { number: 4, floor_mass_kg: 1000.0, damping_ratio: 0.03 },
];
