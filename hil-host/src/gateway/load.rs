//! The load of a bus with the messages of a rig's own.
//!
//! A classical frame of `n` bytes with a 29-bit id has at most `8 n + 67 + floor((54 + 8 n - 1) /
//! 4)` bits: 20 more than one with an 11-bit id, all of them stuffed. In an FD frame the same 20
//! bits and their stuff bits go at the nominal rate.

use super::plan::GatewayPlan;
use can_protocol::{classical_frame_bits, fd_frame_bits};
use dbc::Message;

/// Further bits of an extended identifier, and the stuff bits that they may have.
const EXTENDED_BITS: u32 = 20;
const EXTENDED_STUFF_BITS: u32 = EXTENDED_BITS / 4;

/// Worst-case share of the bus that commands and measurements take, each once in a cycle.
pub(crate) fn load(plan: &GatewayPlan, rate_hz: f64, (nominal, data): (f64, f64)) -> f64 {
    rate_hz * plan.messages().map(|message| time_s(message, nominal, data)).sum::<f64>()
}

/// Longest time of a frame (s).
fn time_s(message: &Message, nominal_bits_per_s: f64, data_bits_per_s: f64) -> f64 {
    let bytes = message.len as u32;
    let more = if message.id.is_extended() { EXTENDED_BITS + EXTENDED_STUFF_BITS } else { 0 };
    if message.is_fd {
        let (slow, fast) = fd_frame_bits(bytes);
        f64::from(slow + more) / nominal_bits_per_s + f64::from(fast) / data_bits_per_s
    } else {
        f64::from(classical_frame_bits(bytes) + more) / nominal_bits_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dbc::CanId;

    #[test]
    fn an_extended_identifier_costs_25_bits() {
        let message = |id| Message { id, name: String::new(), len: 8, is_fd: false };
        let time_s = |id| time_s(&message(id), 1e6, 5e6);
        assert!((time_s(CanId::Standard(1)) - 135e-6).abs() < 1e-12);
        assert!((time_s(CanId::Extended(1)) - 160e-6).abs() < 1e-12);
    }
}
