//! The row of a cycle: everything that a replay needs.

use super::cycle::{Inputs, Timing};
use super::session::{Session, SessionState};
use crate::record::{ForceSource, Row};
use core::time::Duration;
use firmware_core::line::Slot;
use firmware_core::vehicle::{AXLES_MAX, LATERAL, VERTICAL, YAW};
use nodes::wire_state;

/// Where a rig has said nothing yet.
const UNKNOWN: u8 = u8::MAX;

impl Session<'_> {
    /// Record: the row of the cycle that has just been sent.
    pub(super) fn row(&self, state: &SessionState, inputs: &Inputs, timing: &Timing) -> Row {
        let mut row = Row {
            cycle: state.line.cycle,
            time_s: state.line.time_s(self.line.cycle_s),
            state: wire_state(state.line.state),
            input: inputs.kind,
            frame: inputs.frame,
            distance_m: state.line.vehicle.distance_m.lane(0),
            compute_ns: nanoseconds(timing.compute),
            cycle_ns: nanoseconds(timing.cycle),
            lateness_ns: timing.tick.lateness_ns.try_into().unwrap_or(u32::MAX),
            skipped: timing.tick.skipped.try_into().unwrap_or(u32::MAX),
            hash: state.hash,
            ..Row::default()
        };
        dampers(&mut row, state);
        self.sources(&mut row, state);
        self.rigs(&mut row, state);
        self.motion(&mut row, state);
        row
    }

    /// Where the force of every slot comes from.
    fn sources(&self, row: &mut Row, state: &SessionState) {
        for (slot, kind) in self.line.slots.iter().enumerate() {
            row.force_source[slot] = match kind {
                Slot::Empty => ForceSource::Nothing,
                Slot::Modelled(_) => ForceSource::Model,
                Slot::Rig(_) if state.line.slots[slot].has_dropped_out => ForceSource::DroppedOut,
                Slot::Rig(_) => ForceSource::Rig,
                Slot::StandIn(own) => {
                    row.model_n[slot] = state.line.slots[slot].damper.force_n();
                    row.coupling[slot] = state.line.slots[own.of].coupling.gain();
                    let is_out = state.line.slots[own.of].has_dropped_out;
                    if is_out { ForceSource::DroppedOut } else { ForceSource::StandIn }
                }
            };
        }
    }

    /// What was sent to the rigs and what they returned.
    fn rigs(&self, row: &mut Row, state: &SessionState) {
        for (port, memory) in self.ports.iter().zip(&state.ports) {
            let (slot, view) = (port.slot, memory.watch.view);
            row.residual_n[slot] = view.residual_n.unwrap_or(f64::NAN);
            row.residual_rms_n[slot] = view.residual_rms_n.unwrap_or(f64::NAN);
            row.residual_limit_n[slot] = view.limit_n.unwrap_or(f64::NAN);
            row.drift[slot] = view.verdict;
            row.wanted_m[slot] = state.line.slots[slot].wanted.displacement_m;
            let command = state.line.slots[slot].command;
            row.command_m[slot] = command.displacement_m;
            row.command_m_per_s[slot] = command.velocity_m_per_s;
            let believed = memory.belief.age_cycles().filter(|_| !memory.has_dropped_out());
            row.age_cycles[slot] = believed.unwrap_or(UNKNOWN);
            row.rig_state[slot] = memory.used.map_or(UNKNOWN, |used| used.state.code());
            row.rig_flags[slot] = memory.used.map_or(0, |used| used.flags.bits());
            row.temperature_degc[slot] = memory.temperature_degc.unwrap_or(f64::NAN);
            row.model_n[slot] = state.line.slots[slot].damper.force_n();
            row.coupling[slot] = state.line.slots[slot].coupling.gain();
            if let Some(used) = memory.used {
                row.measured_m[slot] = used.displacement_m.unwrap_or(f64::NAN);
                row.measured_n[slot] = used.force_n.unwrap_or(f64::NAN);
            }
        }
    }

    /// Accelerations, wheel forces and positions.
    fn motion(&self, row: &mut Row, state: &SessionState) {
        let vehicle = &state.line.vehicle;
        let of = |body: Option<usize>, axis: usize| {
            let acceleration = body.and_then(|body| vehicle.acceleration.get(body));
            acceleration.map_or(f64::NAN, |a| a[axis].lane(0))
        };
        for (number, body) in self.watched.into_iter().enumerate() {
            row.acceleration_m_per_s2[2 * number] = of(body, LATERAL);
            row.acceleration_m_per_s2[2 * number + 1] = of(body, VERTICAL);
        }
        let bogies = [self.watched[1], self.rear_bogie];
        row.bogie_rear_m_per_s2 = [LATERAL, VERTICAL].map(|axis| of(bogies[1], axis));
        row.bogie_yaw_rad_per_s2 = bogies.map(|bogie| of(bogie, YAW));
        for (number, axle) in self.line.vehicle.axles.iter().enumerate().take(AXLES_MAX) {
            let body = Some(axle.body.index());
            row.wheelset_m_per_s2[number] = [LATERAL, VERTICAL].map(|axis| of(body, axis));
        }
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let wheel = &vehicle.wheels[0][side][0];
            row.wheel_lateral_n[side] = -sign * wheel.lateral_n;
            row.wheel_vertical_n[side] = -wheel.vertical_n;
        }
        for (number, axle) in self.line.vehicle.axles.iter().enumerate().take(AXLES_MAX) {
            row.wheelset_lateral_m[number] = vehicle.position[axle.body.index()][LATERAL].lane(0);
        }
    }
}

/// Motion and force of every damper slot.
fn dampers(row: &mut Row, state: &SessionState) {
    let vehicle = &state.line.vehicle;
    for (number, slot) in state.line.slots.iter().enumerate() {
        row.extension_m[number] = vehicle.extension_m[number].lane(0) - slot.mid_stroke_m;
        row.extension_m_per_s[number] = vehicle.extension_m_per_s[number].lane(0);
        row.force_n[number] = vehicle.damper_n[number].lane(0);
    }
}

fn nanoseconds(time: Duration) -> u32 {
    time.as_nanos().try_into().unwrap_or(u32::MAX)
}
