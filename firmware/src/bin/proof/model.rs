//! Every entry point of `firmware-core`.
//!
//! A value whose address has gone through `black_box` holds whatever its type allows: any number of
//! bodies, any creep law, any effect, NaN anywhere. So one call stands for all of them, and an
//! effect or a law that is added later is covered without a line here.
//!
//! Nothing is inlined into its caller, so that the map of the image shows what each costs.

use core::hint::black_box;

use firmware_core::command::Command;
use firmware_core::compensation::{
    Adaptive, Answer, Compensator, Feedforward, Series, damping_energy_lost, delay_that_costs,
};
use firmware_core::damper::effects::{CATALOGUE, EffectInfo};
use firmware_core::damper::{
    Curve, Damper, DamperState, Effect, EmpiricalMap, Factors, HeatBalance, MapCoordinate, MapKnot,
    Motion, Nominal, Parts, attachment_force_n,
};
use firmware_core::guard::{ForceInput, Guard};
use firmware_core::lanes::Lanes;
use firmware_core::line::{Fade, Line, RigSlot, Slot, SlotState};
use firmware_core::supervision::{CommandLimits, Event, Growth};
use firmware_core::track::{Irregularity, IrregularitySample, Layout, Track, Window};
use firmware_core::vehicle::{BodyId, DAMPER_SLOTS, Running, Vehicle, VehicleState};
use firmware_core::virtual_wear::loop_gain;
use firmware_core::wheel_rail::creep::{ConicalPrescribed, CreepLaw, Creepage, Fastsim, Patch};
use firmware_core::wheel_rail::geometry::{ContactGeometry, ContactZones, TABLE_ROWS};
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::ContactTable;

/// Vehicles side by side, to have more than the one lane of the line.
const LANES: usize = 4;

/// All of it once.
pub(crate) fn run() {
    let samples = black_box([IrregularitySample::default(); 8]);
    let mut track = Track {
        layout: Layout::tangent(),
        irregularity: Irregularity {
            samples: black_box(&samples),
            before: black_box(0),
            behind: 0,
            first_m: 0.0,
            step_m: 1.0,
        },
    };
    curve(&mut track);
    window();
    let table = table();
    let mut vehicle = Vehicle::default();
    black_box(&mut vehicle);
    black_box((BodyId::new(black_box(0)), vehicle.mass_kg(), vehicle.degrees_of_freedom()));
    if vehicle.check().is_ok() {
        line(&vehicle, &track, &table);
        lanes(&vehicle, &track, &table);
    }
    damper();
    laws();
    compensation();
    wear();
}

/// The control cycle with every kind of slot and of input.
#[expect(clippy::large_stack_arrays, reason = "dampers are kept in a static where they are run")]
#[inline(never)]
fn line(vehicle: &Vehicle, track: &Track<'_>, table: &ContactTable) {
    let mut line = Line {
        vehicle,
        track,
        contact: Some(table),
        speed_m_per_s: 0.0,
        cycle_s: 0.0,
        substeps: 0,
        slots: [const { Slot::Empty }; DAMPER_SLOTS],
        fade: black_box(Fade::default()),
    };
    black_box(&mut line);
    let mut state = line.start(black_box(VehicleState::default()));
    black_box(&mut state);
    black_box(state.on(black_box(Event::Agreed)));
    black_box(line.couple(&mut state, black_box([0.0; DAMPER_SLOTS])).is_ok());
    state.delay_run(black_box(0));
    state.drop_out(black_box(0));
    line.step(&mut state, &black_box([ForceInput::Missing; DAMPER_SLOTS]));
    let answers = black_box([None; DAMPER_SLOTS]);
    line.step_on(track, &mut state, &black_box([ForceInput::Missing; DAMPER_SLOTS]), &answers);
    black_box(state.is_measuring());
    black_box((line.is_faded_out(&state), state.run_cycles(), state.time_s(line.cycle_s)));
    black_box(Growth::default().take(black_box(0.0), black_box(0.1)));
    let snapshot = state.clone();
    black_box((snapshot == state, state.vehicle.is_finite()));
    black_box(&state);
    let mut guard = black_box(Guard::default());
    black_box(guard.take(black_box(ForceInput::Missing)));
}

/// Several vehicles side by side.
#[inline(never)]
fn lanes(vehicle: &Vehicle, track: &Track<'_>, table: &ContactTable) {
    let mut state = VehicleState::<LANES>::default();
    black_box(&mut state);
    let running = black_box(Running {
        speed_m_per_s: Lanes([0.0; LANES]),
        tracks: [track; LANES],
        contact: Some(table),
        substep_s: 0.0,
    });
    vehicle.start(&mut state, &running);
    vehicle.step(&mut state, &running, &mut (), black_box(4));
    black_box(vehicle.damper_motions(&state, &running));
    black_box(state.velocity(black_box(0), black_box(0), running.substep_s));
    black_box(state.kinetic_energy_j(&vehicle.bodies, black_box(0)));
}

/// A damper made from names and numbers, then one with whatever effects there are.
#[inline(never)]
fn damper() {
    let row = black_box(0);
    let name = CATALOGUE.get(row).map_or("", |info| info.name);
    if let Some(shorter) = CATALOGUE.get(row).and_then(EffectInfo::shorter) {
        black_box(black_box(shorter).effect(black_box(&[0.0; 4])).is_ok());
    }
    let Ok(effect) = Effect::from_values(black_box(name), black_box(&[0.0; 4])) else { return };
    let given = [effect; 2];
    let Ok(damper) = Damper::new(black_box(Nominal::NEW), black_box(&given)) else { return };
    let coordinate = black_box(MapCoordinate::Displacement);
    let knot = MapKnot { at: 0.0, upper_n: 0.0, lower_n: 0.0 };
    let map = EmpiricalMap::new(coordinate, black_box(&[knot; 2]), black_box(0.0));
    let Ok(map) = map else { return };
    let mut damper = damper.with_empirical(map).prepared(black_box(1e-3));
    black_box(&mut damper);
    let state = DamperState::starting(Motion::default());
    let mut state = black_box(state.with_piston_m(black_box(0.0)));
    black_box(damper.advance(&mut state, black_box(Motion::default()), black_box(1e-3)));
    black_box(damper.steady_force_n(black_box(0.0)));
    let heat = HeatBalance::of(&damper);
    black_box(heat.step(black_box(0.0), black_box(0.0), black_box(0.0), black_box(1e-3)));
    let parts = Parts { hydraulic: Curve::ZERO, dry: Curve::ZERO, attachment: Curve::ZERO };
    let parts = black_box(parts);
    black_box(attachment_force_n(&parts, &black_box(Factors::NONE), black_box(0.0)));
    black_box(&state);
}

/// The creep laws by themselves.
#[inline(never)]
fn laws() {
    let patch = black_box(Patch {
        normal_n: 0.0,
        along_m: 0.0,
        across_m: 0.0,
        c11: 0.0,
        c22: 0.0,
        c23: 0.0,
        shear_modulus_pa: 0.0,
        friction: 0.0,
    });
    let prescribed = ConicalPrescribed { shear_force_n: 0.0, psi: 0.0, phi: 0.0 };
    let mut laws =
        [CreepLaw::LinearSaturated, CreepLaw::Polach, CreepLaw::ConicalPrescribed(prescribed)];
    if let (Some(grid), Some(law)) = (Fastsim::new(black_box(10), black_box(10)), laws.first_mut())
    {
        *law = CreepLaw::Fastsim(grid);
    }
    for law in black_box(laws) {
        black_box(law.force(&patch, black_box(Creepage::default())));
    }
}

/// Every compensator, with and without an answer.
#[inline(never)]
fn compensation() {
    let series = black_box(Series::IDENTITY).with_delay(black_box(0.0));
    let fixed = black_box(Feedforward::polynomial(black_box(2), black_box(0.0)));
    let adaptive = Adaptive::new(series, black_box(1.0)).with_known_delay(black_box(0.0));
    for compensator in black_box([
        Compensator::None,
        Compensator::Feedforward(fixed),
        Compensator::Adaptive(adaptive),
    ]) {
        let mut state = compensator.start();
        black_box(&mut state);
        let answer = Some(Answer { displacement_m: 0.0, force_n: 0.0, age_cycles: 0 });
        let (wanted, answer) = (black_box(Command::default()), black_box(answer));
        let command = compensator.step(&mut state, wanted, answer, black_box(1e-3));
        state.sent(black_box(command));
        let series = compensator.series(&state);
        black_box((state.has_run_away(), series.delay_s(black_box(1.0)), series.gain(1.0)));
    }
    black_box(black_box(Compensator::None).with_known_delay(black_box(0.0)));
    black_box(damping_energy_lost(black_box(0.0), black_box(1.0), black_box(0.0)));
    black_box(delay_that_costs(black_box(0.0), black_box(1.0), black_box(0.0)));
}

/// Wear before a damper on a rig, with what decides whether it is accepted.
#[inline(never)]
fn wear() {
    let Ok(damper) = Damper::new(black_box(Nominal::NEW), &[]) else { return };
    let limits = black_box(CommandLimits::default());
    let rig = RigSlot::new(damper.clone(), black_box(Compensator::None), limits, black_box(1e-3));
    let rig = rig.behind_wear(black_box(0.0), black_box(0.0), &damper, black_box(1e-3));
    let mut memory = SlotState::coupled(&rig);
    black_box(&mut memory);
    let arrived = black_box((ForceInput::Missing, None));
    black_box(memory.follow(&rig, black_box(Command::default()), arrived, black_box(1e-3)));
    if let Some(wear) = &rig.wear {
        black_box(memory.wear.found(wear).is_some_and(|found| found.is_accepted()));
        black_box(wear.rounding_m(black_box(0.0), black_box(1e-3)));
    }
    memory.wear.clear();
    black_box(loop_gain(black_box(0.0), black_box(1.0), black_box(0.0)));
}

/// Look-ups on a track with a curve.
#[inline(never)]
fn curve(track: &mut Track<'_>) {
    black_box(track.layout.hold(black_box(50.0)).is_ok());
    black_box(track.layout.ramp(black_box(60.0), 0.0025, 0.08, 6.0).is_ok());
    black_box(&mut *track);
    black_box(track.layout.at(black_box(0.0)));
    black_box(track.irregularity.at(black_box(0.0)));
}

/// A track that is handed over sample by sample.
#[inline(never)]
fn window() {
    let mut window = black_box(Window::<32>::new(black_box(0), black_box(0.0), black_box(0.1)));
    while window.push(black_box(IrregularitySample::default())) {}
    window.pass(black_box(0.0));
    black_box((window.room(), window.reaches(black_box(0.0))));
    black_box(window.view().at(black_box(0.0)));
}

/// A contact table from geometry.
#[inline(never)]
fn table() -> ContactTable {
    let point = ContactGeometry {
        touch_m: 0.0,
        slope: 0.0,
        radius_deviation_m: 0.0,
        lateral_m: 0.0,
        curvature_lateral_per_m: 0.0,
        rail_radius_m: 0.0,
    };
    let mut zones = ContactZones { tread: [point; TABLE_ROWS], flange: [point; TABLE_ROWS] };
    black_box(&mut zones);
    let mut table = ContactTable::new(&zones, black_box(0.625), Material::STEEL);
    black_box(&mut table);
    table
}
