//! What is mounted in the bench for a case, with its effects at the wanted size.

use super::case::Case;
use super::design::{HYDRAULIC, Truth};
use super::size::{Sized, sized};
use super::strength::Strength;
use crate::error::EvidenceError;
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, Effect};
use identification::Control;
use scenario::source::Source;
use signal::random::Random;
use std::path::Path;
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::{Modelled, NullGenerator, Specimen};
use virtual_bench::hydraulic::HydraulicDamper;
use virtual_bench::series_model::neighbour::{Draw, NEIGHBOURS, NeighbourDamper, Reach};
use virtual_bench::series_model::outside::Outside;

/// Strength at which a search begins, as a share of the strongest.
const WEAKEST: f64 = 1e-5;
/// Strongest disturbance, as a share of the force.
const STRONGEST_OUTSIDE: f64 = 0.6;

/// A specimen and what is true of it.
pub(super) struct Mounted {
    /// The specimen.
    pub specimen: Box<dyn Specimen>,
    /// Names of what is missing in the nominal damper, where it is known.
    pub truth: Vec<&'static str>,
    /// Its damper in the terms of the core, where it is one.
    pub damper: Option<Damper>,
    /// The sizes that were reached, one for each name.
    pub sizes: Vec<Sized>,
}

/// Mounts the specimen of a case.
///
/// # Errors
/// There is no such damper, or the work is stopped.
pub(super) fn mount(case: &Case, control: Control<'_>) -> Result<Mounted, EvidenceError> {
    let mut random = Random::new(case.seed, 7);
    match case.of.truth {
        Truth::Hydraulic(which) => {
            let specimen = Box::new(hydraulic(which, &mut random)?);
            Ok(Mounted { specimen, truth: Vec::new(), damper: None, sizes: Vec::new() })
        }
        Truth::Outside(which) => outside(case, which, &mut random, control),
        Truth::Neighbour(which) => neighbour(case, which, &mut random, control),
        _ if case.effects.is_empty() => Ok(Mounted {
            specimen: Box::new(NullGenerator { model: case.series_model(), outside: Vec::new() }),
            truth: Vec::new(),
            damper: Damper::new(case.nominal, &[]).ok(),
            sizes: Vec::new(),
        }),
        _ => catalogue(case, &mut random, control),
    }
}

fn catalogue(
    case: &Case,
    random: &mut Random,
    control: Control<'_>,
) -> Result<Mounted, EvidenceError> {
    let (mut effects, mut sizes): (Vec<Effect>, Vec<Sized>) = (Vec::new(), Vec::new());
    for &effect in &case.effects {
        let strength = Strength::draw(effect, case.nominal, &case.extent, random);
        let strongest = strength.strongest();
        let make = |k: f64| -> Option<Box<dyn Specimen>> {
            let damper = Damper::new(case.nominal, &[strength.at(k)?]).ok()?;
            Some(Box::new(Modelled { damper }))
        };
        let found = sized(case, &make, [WEAKEST * strongest, strongest], control)
            .ok_or(EvidenceError::NotSimulated(strength.info.name))?;
        effects.extend(strength.at(found.strength));
        sizes.push(found);
    }
    let damper = Damper::new(case.nominal, &effects)?;
    Ok(Mounted {
        specimen: Box::new(Modelled { damper: damper.clone() }),
        truth: case.effects.iter().map(|effect| CATALOGUE[*effect].name).collect(),
        damper: Some(damper),
        sizes,
    })
}

fn outside(
    case: &Case,
    which: usize,
    random: &mut Random,
    control: Control<'_>,
) -> Result<Mounted, EvidenceError> {
    let disturbance = match which {
        0 => {
            Outside::SpeedSynchronousRipple { amplitude_n: 1.0, multiple: random.between(2.1, 7.9) }
        }
        1 => Outside::FrameResonance {
            participation: 0.1,
            frequency_hz: random.between(25.0, 80.0),
            damping_ratio: random.between(0.01, 0.05),
        },
        2 => Outside::WornBand {
            depth: 0.1,
            at_m: case.scale * random.between(-2e-3, 2e-3),
            width_m: case.scale * random.between(1e-3, 3e-3),
        },
        _ => Outside::ValveFlutter {
            amplitude_n: 1.0,
            frequency_hz: random.between(60.0, 150.0),
            threshold_m_per_s: case.scale * random.between(0.015, 0.05),
        },
    };
    let model = case.series_model();
    // Strength in terms of the force of one test.
    let reference = Excitation::sine(3.46e-3 * case.scale, 3.5);
    let at = |share: f64| disturbance.sized(share, &model, &reference).0;
    let make = |share: f64| -> Option<Box<dyn Specimen>> {
        Some(Box::new(NullGenerator { model, outside: vec![at(share)] }))
    };
    let found = sized(case, &make, [1e-4, STRONGEST_OUTSIDE], control)
        .ok_or(EvidenceError::NotSimulated("a disturbance"))?;
    Ok(Mounted {
        specimen: Box::new(NullGenerator { model, outside: vec![at(found.strength)] }),
        truth: vec![disturbance.name()],
        damper: None,
        sizes: vec![found],
    })
}

fn neighbour(
    case: &Case,
    which: usize,
    random: &mut Random,
    control: Control<'_>,
) -> Result<Mounted, EvidenceError> {
    let model = case.series_model();
    let reach = Reach {
        speed_m_per_s: case.extent.speed_m_per_s,
        stroke_m: case.extent.stroke_m,
        extension_m: case.extent.extension_m,
        compression_m: case.extent.compression_m,
    };
    let draw = Draw::new(which, model, reach, random);
    let make = |strength: f64| -> Option<Box<dyn Specimen>> {
        Some(Box::new(NeighbourDamper { model, neighbour: Some(draw.at(strength)) }))
    };
    let name = NEIGHBOURS[which].name;
    let found = sized(case, &make, [WEAKEST * Draw::STRONGEST, Draw::STRONGEST], control)
        .ok_or(EvidenceError::NotSimulated(name))?;
    let specimen = make(found.strength).ok_or(EvidenceError::NotSimulated(name))?;
    Ok(Mounted { specimen, truth: vec![name], damper: None, sizes: vec![found] })
}

/// One of the hydraulic dampers that come with the project, its numbers moved.
fn hydraulic(which: usize, random: &mut Random) -> Result<HydraulicDamper, EvidenceError> {
    let texts = [
        include_str!("../../../scenarios/dampers/hydraulic-yaw-damper.toml"),
        include_str!("../../../scenarios/dampers/hydraulic-yaw-damper-unidirectional.toml"),
    ];
    let which = which % HYDRAULIC.len();
    let source = Source::from_text(Path::new(HYDRAULIC[which]), texts[which]);
    let mut damper = HydraulicDamper::from_source(&source)?;
    damper.attachment.clearance_2a_m = random.between(0.1e-3, 1.2e-3);
    damper.attachment.rubber_n_per_m *= random.between(0.7, 1.4);
    damper.oil.air_share *= random.between(0.3, 2.0);
    damper.oil.viscosity_pa_s *= random.between(0.8, 1.2);
    damper.friction.coulomb_n *= random.between(0.5, 2.0);
    damper.friction.breakaway_n = damper.friction.breakaway_n.max(1.1 * damper.friction.coulomb_n);
    Ok(damper)
}

#[cfg(test)]
mod tests {
    use super::super::design::{Combination, Motion, Noise};
    use super::super::size::records;
    use super::*;
    use firmware_core::damper::effects::CATALOGUE;
    use identification::{TestSet, nominal_fit};

    fn case(name: &str, motion: Motion, size: f64) -> Case {
        let effect = CATALOGUE.iter().position(|info| info.name == name).unwrap();
        let truth = Truth::Effect(effect);
        Case::of(Combination { motion, noise: Noise::White, truth, size }, 5, 0, true)
    }

    #[test]
    fn sizes_reach_their_multiple() {
        for (name, motion, size) in [
            ("seal_friction", Motion::Sines, 3.0),
            ("asymmetric_damping", Motion::Earthquake, 10.0),
        ] {
            let case = case(name, motion, size);
            let mounted = mount(&case, Control::QUIET).unwrap();
            // By a way of its own: noisy records, of which the noise is removed in squares.
            let stop = Control::QUIET.stop;
            let train =
                records(&case, &*mounted.specimen, &case.sensors, &case.tests.train, stop).unwrap();
            let tests = TestSet::new(train);
            let fit = nominal_fit(&tests, None, Control::QUIET).unwrap().fit;
            let square = fit.total_n2() / tests.counted_samples() as f64;
            let noise_n = case.noise_n();
            let found = (square - noise_n * noise_n).sqrt() / noise_n;
            println!("{name}: {size} wanted, {found:.3} found, {:?}", mounted.sizes);
            assert!(mounted.sizes[0].reached, "{:?}", mounted.sizes);
            assert!((found / size - 1.0).abs() < 0.1, "{name}: {found} {:?}", mounted.sizes);
        }
    }

    #[test]
    fn what_cannot_be_reached_is_said() {
        // A spring in series is a lower Ke: no residual remains.
        let sizes =
            mount(&case("fixture_compliance", Motion::Sines, 10.0), Control::QUIET).unwrap().sizes;
        assert!(!sizes[0].reached && sizes[0].size < 1.0, "{sizes:?}");
    }
}
