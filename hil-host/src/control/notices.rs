//! What the loop hands to the events of a run, in the cycle in which it finds it.

use super::session::{Session, SessionState};
use super::stop::Notice;
use crate::record::Recorder;
use firmware_core::supervision::Signal;
use firmware_core::vehicle::DAMPER_SLOTS;

/// What has been handed over: each cause and each note goes once.
#[derive(Debug, Clone, Copy, Default)]
pub struct Notices {
    has_cause: bool,
    /// By port, one bit for each signal.
    noted: [u64; DAMPER_SLOTS],
    /// By port: whether its slot goes on without the rig.
    dropped_out: [bool; DAMPER_SLOTS],
}

const _: () = assert!(Signal::ALL.len() <= u64::BITS as usize, "a bit for each signal");

impl Session<'_> {
    /// Hands over what was found since the last call: the cause of a stop, rigs that have dropped
    /// out, and what a check has noted of a rig for the first time. Neither allocates nor locks.
    pub fn notify(&self, state: &SessionState, notices: &mut Notices, recorder: &mut Recorder<'_>) {
        let ports = self.ports.iter().zip(&state.ports).zip(&mut notices.noted);
        for ((port, memory), handed_over) in ports {
            for noted in memory.belief.noted() {
                let bit = 1_u64 << noted.first.signal as u32;
                if *handed_over & bit == 0 {
                    *handed_over |= bit;
                    let node = port.node.number();
                    recorder.notice(Notice::Noted(self.first_of(state, node, &noted)));
                }
            }
        }
        let ports = self.ports.iter().zip(&state.ports).zip(&mut notices.dropped_out);
        for ((port, memory), handed_over) in ports {
            if let (Some(why), false) = (memory.dropped_out, *handed_over) {
                *handed_over = true;
                recorder.notice(Notice::DroppedOut { slot: port.slot, why });
            }
        }
        if let (Some(stop), false) = (state.stop, notices.has_cause) {
            notices.has_cause = true;
            recorder.notice(Notice::Cause(stop));
        }
    }
}
