//! The track by messages: a locomotive on a board reads it, a track server has it.
//!
//! [`Reader`] keeps a window on the track ([`firmware_core::track::Window`]) and asks for what is
//! missing; [`Server`] answers from the whole track. Both are nodes: frames and ticks go in, frames
//! come out. The messages are those of [`can_protocol::TrackRequest`] and its relatives.
//!
//! A sample travels in steps of 10 nm. A track of samples that are rounded so ([`as_sent`]) gives a
//! locomotive the same bits whether it is in memory or came by messages.

mod identity;
mod reader;
mod server;

pub use identity::{Identity, Unservable, Ways, as_sent};
pub use reader::{Reader, Terms, TrackFault};
pub use server::{Counts, Server, Source, there_and_back};

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::WireFrame;
    use firmware_core::track::{Irregularity, IrregularitySample};
    use std::vec::Vec;

    /// Samples that all differ, as they travel.
    fn samples(count: usize) -> Vec<IrregularitySample> {
        let channel = |number: usize, factor| 20e-3 * libm::sin(factor * number as f64);
        let sample = |number| IrregularitySample {
            vertical_m: channel(number, 0.11),
            alignment_m: channel(number, 0.07),
            cross_level_m: channel(number, 0.05),
            gauge_m: channel(number, 0.03),
        };
        (0..count).filter_map(|number| as_sent(&sample(number))).collect()
    }

    /// 240 km in an hour and a half, in which the number of a sample on the wire and its mask wrap.
    #[test]
    fn a_window_of_25_m_runs_over_a_track_that_nobody_has_in_memory() {
        let samples = samples(1000);
        let track = Irregularity { samples: &samples, step_m: 0.1, ..Irregularity::default() };
        let mut server = Server::of(&track, Ways::ThereAndBack).unwrap();
        let mut reader = Reader::<256>::NEW;
        let expected = Some(server.identity().fingerprint);
        reader.begin(Terms { session: 0xFFFF, expected, reach_m: 10.0, ahead_m: 0.0444 });
        let (mut cycles, mut most_ticks) = (0_u32, 0);
        for tick in 0..5_500_000 {
            let at_m = 12.0 + f64::from(cycles) * 0.0444;
            if reader.tick(at_m) {
                if cycles % 997 == 0 {
                    let place = (at_m / 0.1) as usize;
                    let turn = |place| samples[there_and_back(place as u32, 1000) as usize];
                    let around = [place - 1, place, place + 1, place + 2].map(turn);
                    let expected = Irregularity { samples: &around, before: place - 1, ..track };
                    let expected = Irregularity { behind: usize::MAX - place - 3, ..expected };
                    assert_eq!(reader.view().at(at_m), expected.at(at_m), "{at_m}");
                }
                cycles += 1;
            }
            most_ticks = most_ticks.max(tick - cycles);
            if let Some(request) = reader.take_frame() {
                server.hear(&WireFrame::from(&request));
            }
            server.tick();
            while let Some(frame) = server.take_frame() {
                reader.hear(&WireFrame::from(&frame));
            }
        }
        assert!(cycles > 5_499_000 && most_ticks < 300, "{cycles}, {most_ticks}");
        let counts = server.counts();
        assert!(counts.end > 2_400_000 && counts.repeated == 0, "{counts:?}");
    }
}
