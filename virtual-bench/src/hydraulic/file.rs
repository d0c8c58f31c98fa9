//! A hydraulic damper from a TOML file: geometry, reservoir, oil, leakage, seals, attachment, heat
//! and a list of valves, each number with its unit in its key and its provenance next to it.
//!
//! ```toml
//! [[valve]]
//! name = "bleed hole of the piston"
//! from = "rod"
//! to = "cap"
//! orifice = { discharge = 0.7, area_m2 = 1.0e-6, transition_pa = 10e3 }
//! ```
//!
//! A valve has one of `orifice`, `slot`, `check`, `shim`, `relief`.

use super::attachment::Attachment;
use super::friction::Friction;
use super::oil::Oil;
use super::valve::{Chamber, Leakage, Throttle, Valve};
use super::{HydraulicDamper, Reservoir};
use files::quoted;
use firmware_core::damper::HeatBalance;
use scenario::quantity::Quantity;
use scenario::source::{ScenarioError, Source};
use serde::Deserialize;
use std::path::Path;

impl HydraulicDamper {
    /// Reads a damper.
    ///
    /// # Errors
    /// What does not fit, with file, line and key.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        Self::from_source(&Source::read(path)?)
    }

    /// Reads a damper from text in memory.
    ///
    /// # Errors
    /// What does not fit, with file, line and key.
    pub fn from_source(source: &Source) -> Result<Self, ScenarioError> {
        source.parse::<DamperTable>()?.build(source)
    }
}

/// Declares a table of quantities with what each may be, and its check.
macro_rules! tables {
    ($($table:ident { $($key:ident: $bound:ident,)+ })+) => {
        $(#[allow(clippy::struct_field_names, reason = "the unit is the end of a name")]
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $table { $($key: Quantity,)+ }

        impl $table {
            /// The values in the order of the declaration, checked.
            fn values(
                &self,
                source: &Source,
            ) -> Result<[f64; [$(stringify!($key)),+].len()], ScenarioError> {
                Ok([$($bound(&self.$key, source, stringify!($key))?,)+])
            }
        })+
    };
}

fn positive(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.positive(source, key)
}

fn zero_or_more(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.not_negative(source, key)
}

fn any(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.finite(source, key)
}

fn share(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.within(source, key, 0.0, 1.0, "0 to 1")
}

fn exponent(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.within(source, key, 1.0, 1.67, "1 (slow) to 1.67 (fast)")
}

fn angle(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.within(source, key, 1e-3, std::f64::consts::FRAC_PI_2, "above 0 and up to pi/2")
}

tables! {
    GeometryTable {
        bore_m: positive,
        rod_m: positive,
        half_stroke_m: positive,
        rod_dead_m3: positive,
        cap_dead_m3: positive,
        moving_kg: positive,
    }
    ReservoirTable { gas_m3: positive, gas_pa: positive, exponent: exponent, }
    OilTable {
        bulk_modulus_pa: positive,
        bulk_modulus_pa_per_k: any,
        air_share: share,
        air_exponent: exponent,
        density_kg_per_m3: positive,
        expansion_per_k: zero_or_more,
        viscosity_pa_s: positive,
        viscosity_per_k: any,
        reference_degc: any,
        vapour_pa: positive,
    }
    LeakageTable { gap_m: zero_or_more, length_m: positive, eccentricity: share, }
    SealTable {
        coulomb_n: zero_or_more,
        breakaway_n: zero_or_more,
        stribeck_m_per_s: positive,
        creep_m_per_s: positive,
        pressed_m2: zero_or_more,
    }
    AttachmentTable {
        seat_n_per_m: positive,
        clearance_2a_m: zero_or_more,
        rubber_n_per_m: positive,
        branch_n_per_m: zero_or_more,
        branch_s: positive,
    }
    HeatTable { capacity_j_per_k: positive, cooling_w_per_k: zero_or_more, }
    OrificeTable { discharge: share, area_m2: positive, transition_pa: positive, }
    SlotTable { width_m: positive, height_m: positive, length_m: positive, }
    CheckTable { discharge: share, area_m2: positive, crack_pa: zero_or_more, transition_pa: positive, }
    ShimTable {
        discharge: share,
        edge_m: positive,
        pressed_m2: positive,
        stiffness_n_per_m: positive,
        preload_n: zero_or_more,
        area_max_m2: positive,
    }
    ReliefTable {
        discharge: share,
        seat_m: positive,
        half_angle_rad: angle,
        set_pa: zero_or_more,
        stiffness_n_per_m: positive,
        lift_max_m: positive,
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum ChamberName {
    Rod,
    Cap,
    Reservoir,
}

impl ChamberName {
    fn chamber(&self) -> Chamber {
        match self {
            Self::Rod => Chamber::Rod,
            Self::Cap => Chamber::Cap,
            Self::Reservoir => Chamber::Reservoir,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ValveTable {
    name: String,
    from: ChamberName,
    to: ChamberName,
    orifice: Option<OrificeTable>,
    slot: Option<SlotTable>,
    check: Option<CheckTable>,
    shim: Option<ShimTable>,
    relief: Option<ReliefTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DamperTable {
    #[serde(rename = "title")]
    _title: String,
    geometry: GeometryTable,
    reservoir: ReservoirTable,
    oil: OilTable,
    leakage: LeakageTable,
    seals: SealTable,
    attachment: AttachmentTable,
    heat: HeatTable,
    valve: Vec<ValveTable>,
}

impl DamperTable {
    fn build(&self, source: &Source) -> Result<HydraulicDamper, ScenarioError> {
        let [bore_m, rod_m, half_stroke_m, rod_dead_m3, cap_dead_m3, moving_kg] =
            self.geometry.values(source)?;
        if rod_m >= bore_m {
            let message = format!("rod_m = {rod_m}, expected less than bore_m = {bore_m}");
            return Err(self.geometry.rod_m.error(source, message));
        }
        let [gas_m3, gas_pa, exponent] = self.reservoir.values(source)?;
        let rod_way_m3 = 0.25 * std::f64::consts::PI * rod_m * rod_m * half_stroke_m;
        if gas_m3 <= rod_way_m3 {
            let message = format!(
                "gas_m3 = {gas_m3}, expected more than the rod pushes aside: {rod_way_m3:.2e}"
            );
            return Err(self.reservoir.gas_m3.error(source, message));
        }
        let oil = self.oil.values(source)?;
        let [gap_m, length_m, eccentricity] = self.leakage.values(source)?;
        let [coulomb_n, breakaway_n, stribeck_m_per_s, creep_m_per_s, pressed_m2] =
            self.seals.values(source)?;
        if breakaway_n < coulomb_n {
            let message =
                format!("breakaway_n = {breakaway_n}, expected at least coulomb_n = {coulomb_n}");
            return Err(self.seals.breakaway_n.error(source, message));
        }
        let [seat_n_per_m, clearance_2a_m, rubber_n_per_m, branch_n_per_m, branch_s] =
            self.attachment.values(source)?;
        let [capacity_j_per_k, cooling_w_per_k] = self.heat.values(source)?;
        Ok(HydraulicDamper {
            bore_m,
            rod_m,
            half_stroke_m,
            rod_dead_m3,
            cap_dead_m3,
            moving_kg,
            reservoir: Reservoir { gas_m3, gas_pa, exponent },
            oil: Oil {
                bulk_modulus_pa: oil[0],
                bulk_modulus_pa_per_k: oil[1],
                air_share: oil[2],
                air_exponent: oil[3],
                density_kg_per_m3: oil[4],
                expansion_per_k: oil[5],
                viscosity_pa_s: oil[6],
                viscosity_per_k: oil[7],
                reference_degc: oil[8],
                vapour_pa: oil[9],
            },
            leakage: Leakage { gap_m, length_m, eccentricity },
            friction: Friction {
                coulomb_n,
                breakaway_n,
                stribeck_m_per_s,
                creep_m_per_s,
                pressed_m2,
            },
            attachment: Attachment {
                seat_n_per_m,
                clearance_2a_m,
                rubber_n_per_m,
                branch_n_per_m,
                branch_s,
            },
            heat: HeatBalance { capacity_j_per_k, cooling_w_per_k },
            valves: self.valve.iter().map(|valve| valve.build(source)).collect::<Result<_, _>>()?,
        })
    }
}

impl ValveTable {
    fn build(&self, source: &Source) -> Result<Valve, ScenarioError> {
        let mut throttles = Vec::new();
        if let Some(table) = &self.orifice {
            let [discharge, area_m2, transition_pa] = table.values(source)?;
            throttles.push(Throttle::Orifice { discharge, area_m2, transition_pa });
        }
        if let Some(table) = &self.slot {
            let [width_m, height_m, length_m] = table.values(source)?;
            throttles.push(Throttle::Slot { width_m, height_m, length_m });
        }
        if let Some(table) = &self.check {
            let [discharge, area_m2, crack_pa, transition_pa] = table.values(source)?;
            throttles.push(Throttle::Check { discharge, area_m2, crack_pa, transition_pa });
        }
        if let Some(table) = &self.shim {
            let [discharge, edge_m, pressed_m2, stiffness_n_per_m, preload_n, area_max_m2] =
                table.values(source)?;
            throttles.push(Throttle::Shim {
                discharge,
                edge_m,
                pressed_m2,
                stiffness_n_per_m,
                preload_n,
                area_max_m2,
            });
        }
        if let Some(table) = &self.relief {
            let [discharge, seat_m, half_angle_rad, set_pa, stiffness_n_per_m, lift_max_m] =
                table.values(source)?;
            throttles.push(Throttle::Relief {
                discharge,
                seat_m,
                half_angle_rad,
                set_pa,
                stiffness_n_per_m,
                lift_max_m,
            });
        }
        let (from, to) = (self.from.chamber(), self.to.chamber());
        if from == to {
            let message =
                format!("valve \"{}\" leads from a chamber to itself", quoted(&self.name));
            return Err(source.whole_error(message));
        }
        match throttles[..] {
            [throttle] => Ok(Valve { from, to, throttle }),
            _ => Err(source.whole_error(format!(
                "valve \"{}\" has {} throttles, expected one of orifice, slot, check, shim, relief",
                quoted(&self.name),
                throttles.len()
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = include_str!("../../../scenarios/dampers/hydraulic-yaw-damper.toml");

    fn refused(from: &str, to: &str) -> String {
        assert!(GOOD.contains(from), "{from}");
        let text = GOOD.replacen(from, to, 1);
        let source = Source::from_text(Path::new("damper.toml"), &text);
        HydraulicDamper::from_source(&source).unwrap_err().to_string()
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_line() {
        let text = refused("rod_m = { value = 0.035", "rod_m = { value = 0.35");
        assert!(text.starts_with("damper.toml:") && text.contains("bore_m"), "{text}");
        let text = refused("eccentricity = { value = 0.3", "eccentricity = { value = 3.0");
        assert!(text.contains("eccentricity = 3, expected 0 to 1"), "{text}");
        let text = refused("from = \"rod\"", "from = \"rood\"");
        assert!(text.starts_with("damper.toml:") && text.contains("rood"), "{text}");
        let text = refused("[valve.orifice]", "[valve.hole]");
        assert!(text.contains("hole"), "{text}");
    }
}
