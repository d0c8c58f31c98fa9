//! Oil with free air: how its volume, density and viscosity follow pressure and temperature.
//!
//! ```text
//! s(p) = 1 - (p - p0)/K_l + eps (p0/p)^(1/n)          volume over that of the liquid at p0
//! beta = -s/s' = K_l [~1 + eps (p0/p)^(1/n)] / [1 + eps (p0/p)^(1/n) K_l/(n p)]
//! rho = rho0 (1 - 7e-4 (T - T0))     mu = mu0 exp(-k (T - T0))     K_l(T) = K0 - 6 MPa/K (T - T0)
//! ```
//!
//! A chamber that holds the liquid volume W (measured at p0) has the pressure at which
//! W s(p) = V. Where V is larger than that at the vapour pressure, the pressure stays there and the
//! rest is void: cavitation is the end of the curve, and the oil must come back before the pressure
//! does. Air is free, never dissolved: no memory of foaming.
//!
//! Sources: the modulus of a liquid with polytropic bubbles is textbook hydraulics; 7e-4 /K, 6
//! MPa/K and k of 0.02 to 0.035 /K are usual for mineral oil (estimated).

/// Pressure at which volumes and air are measured, Pa absolute.
pub(super) const P0_PA: f64 = 100e3;

/// Parameters of the oil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oil {
    /// Bulk modulus of the liquid at the reference temperature, Pa.
    pub bulk_modulus_pa: f64,
    /// Its change with temperature, Pa/K.
    pub bulk_modulus_pa_per_k: f64,
    /// Free air, volume share at one bar.
    pub air_share: f64,
    /// Polytropic exponent of the bubbles, 1 to 1.4.
    pub air_exponent: f64,
    /// Density at the reference temperature, kg/m3.
    pub density_kg_per_m3: f64,
    /// Thermal expansion, 1/K.
    pub expansion_per_k: f64,
    /// Dynamic viscosity at the reference temperature, Pa s.
    pub viscosity_pa_s: f64,
    /// Its exponential fall with temperature, 1/K.
    pub viscosity_per_k: f64,
    /// Reference temperature, degrees Celsius.
    pub reference_degc: f64,
    /// Vapour pressure, Pa absolute.
    pub vapour_pa: f64,
}

/// Oil at one temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OilAt {
    /// Bulk modulus of the liquid, Pa.
    pub bulk_modulus_pa: f64,
    /// Density, kg/m3.
    pub density_kg_per_m3: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity_pa_s: f64,
    air_share: f64,
    per_exponent: f64,
    vapour_pa: f64,
}

impl Oil {
    /// The oil at a temperature.
    pub fn at(&self, degc: f64) -> OilAt {
        let above_k = degc - self.reference_degc;
        let modulus = self.bulk_modulus_pa + self.bulk_modulus_pa_per_k * above_k;
        OilAt {
            // Far outside of any damper's life the line would cross zero.
            bulk_modulus_pa: modulus.max(0.1 * self.bulk_modulus_pa),
            density_kg_per_m3: self.density_kg_per_m3 * (1.0 - self.expansion_per_k * above_k),
            viscosity_pa_s: self.viscosity_pa_s * libm::exp(-self.viscosity_per_k * above_k),
            air_share: self.air_share,
            per_exponent: 1.0 / self.air_exponent,
            vapour_pa: self.vapour_pa,
        }
    }
}

/// A point on the curve of volume over pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filling {
    /// Pressure, Pa absolute.
    pub pressure_pa: f64,
    /// Volume over that of the liquid at one bar, void included.
    pub swell: f64,
    /// Change of it per Pa of the unknown, below zero.
    pub swell_per_pa: f64,
    /// Share of it that is void.
    pub void: f64,
}

impl OilAt {
    /// The curve at an unknown that is the pressure down to the vapour pressure, and below it goes
    /// on as void at that pressure.
    pub fn filling(&self, unknown_pa: f64) -> Filling {
        let pressure = unknown_pa.max(self.vapour_pa);
        let air = if self.air_share > 0.0 {
            self.air_share * libm::pow(P0_PA / pressure, self.per_exponent)
        } else {
            0.0
        };
        let swell = 1.0 - (pressure - P0_PA) / self.bulk_modulus_pa + air;
        let slope = -1.0 / self.bulk_modulus_pa - air * self.per_exponent / pressure;
        if unknown_pa >= self.vapour_pa {
            return Filling { pressure_pa: pressure, swell, swell_per_pa: slope, void: 0.0 };
        }
        // The void grows as steeply as the oil would have swollen, at least 1 % per vapour
        // pressure.
        let void_slope = slope.min(-0.01 / self.vapour_pa);
        let void = void_slope * (unknown_pa - self.vapour_pa);
        Filling { pressure_pa: pressure, swell: swell + void, swell_per_pa: void_slope, void }
    }

    /// Bulk modulus with air at a pressure, Pa.
    ///
    /// ```
    /// use virtual_bench::hydraulic::Oil;
    /// let oil = Oil {
    ///     bulk_modulus_pa: 1.5e9, bulk_modulus_pa_per_k: -6e6, air_share: 0.01, air_exponent: 1.4,
    ///     density_kg_per_m3: 870.0, expansion_per_k: 7e-4, viscosity_pa_s: 0.02,
    ///     viscosity_per_k: 0.025, reference_degc: 40.0, vapour_pa: 2e3,
    /// };
    /// // 14 MPa at one bar, 1.33 GPa at fifty.
    /// assert!((oil.at(40.0).modulus_pa(100e3) / 14e6 - 1.0).abs() < 0.02);
    /// assert!((oil.at(40.0).modulus_pa(5e6) / 1.33e9 - 1.0).abs() < 0.01);
    /// ```
    pub fn modulus_pa(&self, pressure_pa: f64) -> f64 {
        let at = self.filling(pressure_pa);
        -at.swell / at.swell_per_pa
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A usual mineral oil.
    pub(in super::super) const OIL: Oil = Oil {
        bulk_modulus_pa: 1.5e9,
        bulk_modulus_pa_per_k: -6e6,
        air_share: 0.01,
        air_exponent: 1.4,
        density_kg_per_m3: 870.0,
        expansion_per_k: 7e-4,
        viscosity_pa_s: 0.02,
        viscosity_per_k: 0.025,
        reference_degc: 40.0,
        vapour_pa: 2e3,
    };

    #[test]
    fn the_printed_moduli_come_out() {
        let oil = OIL.at(40.0);
        for (bar, gpa) in [(1.0, 0.014), (10.0, 0.49), (50.0, 1.33), (100.0, 1.44)] {
            let found = oil.modulus_pa(bar * 1e5) * 1e-9;
            assert!((found / gpa - 1.0).abs() < 0.03, "{bar} bar: {found} and {gpa}");
        }
    }

    #[test]
    fn the_curve_falls_without_a_jump_into_the_void() {
        for air_share in [0.0, 1e-3, 0.03] {
            let oil = Oil { air_share, ..OIL }.at(40.0);
            let mut before = oil.filling(-50e3);
            for step in 1..2000 {
                let unknown = -50e3 + 100.0 * f64::from(step);
                let here = oil.filling(unknown);
                assert!(here.swell < before.swell && here.swell_per_pa < 0.0, "{unknown}");
                assert!(before.swell - here.swell < 150.0 * -before.swell_per_pa, "{unknown}");
                assert!(here.pressure_pa >= 2e3);
                assert_eq!(here.void > 0.0, unknown < 2e3);
                before = here;
            }
        }
    }

    #[test]
    fn warm_oil_is_thin_light_and_soft() {
        let (cold, warm) = (OIL.at(40.0), OIL.at(60.0));
        assert!((warm.viscosity_pa_s / cold.viscosity_pa_s - libm::exp(-0.5)).abs() < 1e-12);
        assert!((warm.density_kg_per_m3 / 870.0 - 0.986).abs() < 1e-12);
        assert!((warm.bulk_modulus_pa - 1.38e9).abs() < 1.0);
    }
}
