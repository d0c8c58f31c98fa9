//! One row of the record per control cycle: everything a replay needs, in full precision.
//!
//! The fields, their types and their order are listed once, below; the record's header and the
//! bytes of a row both follow that list.

use super::force_source::ForceSource;
use super::input_kind::InputKind;
use can_protocol::{RunState, Watch};
use firmware_core::vehicle::{AXLES_MAX, DAMPER_SLOTS};

/// Bytes of a kept frame: payload, zero behind it.
pub type FrameBytes = [u8; 16];

/// A value that `NumPy` knows.
pub(super) trait Field {
    /// Its type string.
    const KIND: &'static str;
    /// Its value before anything is known; arrays longer than 32 have no `Default`.
    const ZERO: Self;
    /// Its shape, empty for a single value.
    fn shape() -> Vec<usize> {
        Vec::new()
    }
    /// Appends its bytes, little-endian.
    fn put(&self, bytes: &mut Vec<u8>);
    /// Takes its bytes off the front; zero where there are none.
    fn get(bytes: &mut &[u8]) -> Self;
}

macro_rules! plain_field {
    ($($kind:ty => $name:literal),*) => { $(
        impl Field for $kind {
            const KIND: &'static str = $name;
            const ZERO: Self = 0 as $kind;
            fn put(&self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
            fn get(bytes: &mut &[u8]) -> Self {
                let Some((first, rest)) = bytes.split_first_chunk() else { return Self::ZERO };
                *bytes = rest;
                Self::from_le_bytes(*first)
            }
        }
    )* };
}

plain_field!(u8 => "|u1", u32 => "<u4", i32 => "<i4", u64 => "<u8", f64 => "<f8");

macro_rules! code_field {
    ($($kind:ty => $zero:expr),*) => { $(
        /// The record holds the code; one that no record holds is read as zero.
        impl Field for $kind {
            const KIND: &'static str = u8::KIND;
            const ZERO: Self = $zero;
            fn put(&self, bytes: &mut Vec<u8>) {
                bytes.push(self.code());
            }
            fn get(bytes: &mut &[u8]) -> Self {
                Self::from_code(u8::get(bytes)).unwrap_or(Self::ZERO)
            }
        }
    )* };
}

code_field!(
    InputKind => InputKind::NoRig,
    ForceSource => ForceSource::Nothing,
    Watch => Watch::None,
    RunState => RunState::Init
);

impl<T: Field, const N: usize> Field for [T; N] {
    const KIND: &'static str = T::KIND;
    const ZERO: Self = [T::ZERO; N];
    fn shape() -> Vec<usize> {
        let mut shape = vec![N];
        shape.extend(T::shape());
        shape
    }
    fn put(&self, bytes: &mut Vec<u8>) {
        for value in self {
            value.put(bytes);
        }
    }
    fn get(bytes: &mut &[u8]) -> Self {
        std::array::from_fn(|_| T::get(bytes))
    }
}

macro_rules! row {
    ($($(#[doc = $doc:literal])* $name:ident: $kind:ty,)*) => {
        /// A row.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Row { $($(#[doc = $doc])* pub $name: $kind,)* }

        impl Row {
            /// Appends the row's bytes.
            pub(super) fn put(&self, bytes: &mut Vec<u8>) {
                $(self.$name.put(bytes);)*
            }

            /// The row of these bytes.
            pub(super) fn get(mut bytes: &[u8]) -> Self {
                Self { $($name: <$kind as Field>::get(&mut bytes),)* }
            }

            /// What every field means, in order.
            pub(super) fn meanings() -> Vec<String> {
                vec![$(concat!($($doc),*).trim().to_owned(),)*]
            }

            /// Name, type and shape of every field, in order.
            pub(super) fn fields() -> Vec<(&'static str, &'static str, Vec<usize>)> {
                vec![$((stringify!($name), <$kind as Field>::KIND, <$kind as Field>::shape()),)*]
            }
        }

        impl Row {
            /// Where a field begins in the bytes of a row.
            pub(super) fn offset(name: &str) -> Option<usize> {
                let mut at = 0;
                for (field, kind, shape) in Self::fields() {
                    if field == name {
                        return Some(at);
                    }
                    at += bytes_of(kind, &shape);
                }
                debug_assert!(false, "a row has no field {name}");
                None
            }

            /// Bytes of a row.
            pub fn size() -> usize {
                let fields = Self::fields();
                fields.iter().map(|(_, kind, shape)| bytes_of(kind, shape)).sum()
            }
        }

        impl Default for Row {
            fn default() -> Self {
                Self { $($name: <$kind as Field>::ZERO,)* }
            }
        }
    };
}

/// Bytes of a field; the type string ends in those of one value.
fn bytes_of(kind: &str, shape: &[usize]) -> usize {
    let size = kind.chars().last().and_then(|digit| digit.to_digit(10)).unwrap_or(0) as usize;
    size * shape.iter().product::<usize>()
}

row! {
    /// Number of the cycle, from one.
    cycle: u64,
    /// Model time at the start of the cycle: zero in the first cycle of RUN (s).
    time_s: f64,
    /// State of the host.
    state: RunState,
    /// Extension of every damper slot at the end of the cycle, from mid-stroke (m).
    extension_m: [f64; DAMPER_SLOTS],
    /// Its rate (m/s).
    extension_m_per_s: [f64; DAMPER_SLOTS],
    /// Force of every slot as the vehicle felt it in the last substep (N).
    force_n: [f64; DAMPER_SLOTS],
    /// Where it comes from.
    force_source: [ForceSource; DAMPER_SLOTS],
    /// Displacement that the rig is wanted at: the extension with wear and fades, before
    /// compensation and limits; zero for a modelled damper (m).
    wanted_m: [f64; DAMPER_SLOTS],
    /// Displacement sent to the rig; zero for a modelled damper (m).
    command_m: [f64; DAMPER_SLOTS],
    /// Velocity sent to the rig (m/s).
    command_m_per_s: [f64; DAMPER_SLOTS],
    /// Displacement that the rig measured (m).
    measured_m: [f64; DAMPER_SLOTS],
    /// Force that the rig measured (N).
    measured_n: [f64; DAMPER_SLOTS],
    /// Force of the slot's own model, which acts while the measured one is faded in and out; zero
    /// for a modelled damper (N).
    model_n: [f64; DAMPER_SLOTS],
    /// What arrived for the slot.
    input: [InputKind; DAMPER_SLOTS],
    /// Payload of the frame that the input came from.
    frame: [FrameBytes; DAMPER_SLOTS],
    /// Age of the measurement that is believed, in cycles: it grows while nothing new comes. 255
    /// where there is none.
    age_cycles: [u8; DAMPER_SLOTS],
    /// State of the rig in its newest measurement; 255 where there is none.
    rig_state: [u8; DAMPER_SLOTS],
    /// Flags of its newest measurement.
    rig_flags: [u8; DAMPER_SLOTS],
    /// Temperature that the rig reports; not a number where it reports none (degC).
    temperature_degc: [f64; DAMPER_SLOTS],
    /// Share of the measured force in what the vehicle feels: that of the rig or of the one that
    /// stands for it.
    coupling: [f64; DAMPER_SLOTS],
    /// Force that the rig measured less that of the model that watches it; not a number, or zero
    /// for a modelled damper, without a watch (N).
    residual_n: [f64; DAMPER_SLOTS],
    /// Running rms of it (N).
    residual_rms_n: [f64; DAMPER_SLOTS],
    /// Where drift is raised (N).
    residual_limit_n: [f64; DAMPER_SLOTS],
    /// What the watch over the rig shows.
    drift: [Watch; DAMPER_SLOTS],
    /// Lateral and vertical acceleration of carbody, front bogie and first wheelset (m/s2).
    acceleration_m_per_s2: [f64; 6],
    /// Lateral and vertical acceleration of the rear bogie (m/s2).
    bogie_rear_m_per_s2: [f64; 2],
    /// Yaw acceleration of front and rear bogie (rad/s2).
    bogie_yaw_rad_per_s2: [f64; 2],
    /// Lateral and vertical acceleration of every wheelset, at its axleboxes (m/s2).
    wheelset_m_per_s2: [[f64; 2]; AXLES_MAX],
    /// Lateral force of the first axle's wheels on the rail, left and right, to the right (N).
    wheel_lateral_n: [f64; 2],
    /// Vertical force of the first axle's wheels on the rail, left and right (N).
    wheel_vertical_n: [f64; 2],
    /// Lateral position of every wheelset against the track (m).
    wheelset_lateral_m: [f64; AXLES_MAX],
    /// Distance run (m).
    distance_m: f64,
    /// Time for one vehicle step: vehicle, contact, modelled dampers (ns).
    compute_ns: u32,
    /// Time from the first received frame to the last sent one (ns).
    cycle_ns: u32,
    /// How late the cycle began (ns); zero without a clock.
    lateness_ns: u32,
    /// Ticks that were skipped before this cycle.
    skipped: u32,
    /// Trajectory hash after the cycle.
    hash: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_of_a_row_are_as_many_as_its_fields_say() {
        let mut bytes = Vec::new();
        Row::default().put(&mut bytes);
        let expected: usize = Row::fields()
            .iter()
            .map(|(_, kind, shape)| {
                let size = kind.chars().last().and_then(|c| c.to_digit(10)).unwrap() as usize;
                size * shape.iter().product::<usize>()
            })
            .sum();
        assert_eq!(bytes.len(), expected);
    }

    #[test]
    fn a_row_is_read_back_as_it_was_written() {
        let mut row = Row { cycle: 7, time_s: 0.25, hash: u64::MAX - 1, ..Row::default() };
        row.input = InputKind::ALL;
        row.drift[2] = Watch::Drift;
        row.force_source[1] = ForceSource::DroppedOut;
        row.frame[3][15] = 9;
        row.wheelset_lateral_m[5] = -1e-3;
        let mut bytes = Vec::new();
        row.put(&mut bytes);
        assert_eq!(Row::get(&bytes), row);
    }
}
