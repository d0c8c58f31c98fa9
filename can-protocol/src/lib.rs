//! yawbench on the bus: the frames between the locomotive model and the damper rigs.
//!
//! # The protocol in one page
//!
//! One **host** computes a vehicle; up to four **rigs** (nodes 1 to 4) carry one damper each. Once
//! per cycle the host sends every rig a [`Command`] (where the damper's eyes should be) and every
//! rig answers with a [`Measurement`] (the force that it measured). Five slow messages accompany
//! them: [`Sync`], [`Heartbeat`], [`Fault`], [`Telemetry`] and [`Residual`]. Before a rig moves,
//! both sides exchange [`ArmMessage`]s ([`arming`]), and [`PressureOff`] asks a rig to drop the
//! pressure in any state. A locomotive on a board, which has no memory for its whole track, is
//! handed it sample by sample; no rig has to know of that ([`TrackRequest`]).
//!
//! | id | message | sender | bytes | when |
//! | --- | --- | --- | --- | --- |
//! | `0x040 + n` | [`PressureOff`], n = 0 is all rigs | host | 6 | on demand |
//! | `0x080` | [`Sync`] | host | 8 | 10 Hz |
//! | `0x100 + n` | [`Command`], classical | host | 8 | every cycle, 1 kHz |
//! | `0x110 + n` | [`Command`], FD | host | 16 | every cycle, 2 to 4 kHz |
//! | `0x200 + n` | [`Measurement`], classical | rig n | 8 | every cycle |
//! | `0x210 + n` | [`Measurement`], FD | rig n | 16 | every cycle |
//! | `0x300 + n` | [`Fault`], n = 0 is the host | both | 6 | on change |
//! | `0x400 + n` | [`Telemetry`] | rig n | 6 | 20 Hz |
//! | `0x500 + n` | [`Residual`] of rig n | host | 6 | 20 Hz, while it is watched |
//! | `0x540` | [`TrackRequest`] | a locomotive on a board | 8 | on demand |
//! | `0x541` | [`TrackOffer`] | track server | 8 | on demand |
//! | `0x542`, `0x543` | [`TrackSample`], one half each | track server | 8 | on demand |
//! | `0x600 + n` | [`ArmMessage`], a question | host | 8 | while arming |
//! | `0x610 + n` | [`ArmMessage`], an answer | rig n | 8 | while arming |
//! | `0x700 + n` | [`Heartbeat`], n = 0 is the host | both | 8 | 50 Hz |
//!
//! All ids are standard (11 bit); the lower id wins the bus, so nothing slow delays the loop by
//! more than the one frame already on the wire. Only the FD variants are FD frames, sent with
//! bit-rate switch; the slow messages stay classical on either bus.
//!
//! **Signals** are little-endian and fixed-point: `value = code x lsb`, rounded half to even. A
//! value beyond the range *saturates*, encoding says so ([`Saturated`]), and nothing wraps. The
//! most negative code means *invalid*: `None` here. Values are SI, as the names say; the
//! displacement is positive in extension from mid-stroke, the force positive in tension.
//!
//! | signal | classical | FD |
//! | --- | --- | --- |
//! | command displacement | i24 x 0.1 µm (±0.839 m) | i32 x 10 nm (±21.5 m) |
//! | command velocity | i16 x 0.01 mm/s (±327.67 mm/s) | i24 x 1 µm/s (±8.39 m/s) |
//! | measured force | i20 x 0.2 N (±104.9 kN) | i32 x 0.01 N (±21.5 MN) |
//! | irregularity of the track | i24 x 10 nm (±83.9 mm) | none |
//! | measured displacement | i20 x 0.2 µm (±104.9 mm) | i32 x 10 nm (±21.5 m) |
//! | time | none | u32 (command), u24 (measurement) x 1 µs, modulo, all ones = none |
//!
//! Why so fine: 1 µm of displacement on a damper of 15 MN/m is 15 N, and a velocity derived from
//! coarse displacement at 1 kHz would be useless, so velocity travels on its own.
//!
//! **Protection.** Every message starts with a CRC: CRC-8 SAE J1850 in 6- and 8-byte frames,
//! CRC-16/CCITT-FALSE in 16-byte frames, over the `DataID` (`0x5000 + id`, high byte first; it is
//! not sent) and all bytes behind the CRC ([`protection`]). A counter runs 0 to 14 in the 4-bit
//! profile (15 = invalid) and 0 to 254 in the FD profile (255 = invalid); the **echo** is the
//! counter last accepted from the peer, or the invalid code when there was none yet. The echo
//! paces lock-step runs and measures the loop's delay in cycles ([`Profile::counter_steps`]).
//!
//! **Arming.** A rig moves only after the exchange of [`arming`], in which it is given back a
//! number that it drew for this exchange. The numbers of both sides make a [`SessionCode`].
//! Commands and measurements of the session are *sealed*: the code and the upper bits of the cycle
//! number, which do not travel, are mixed into the CRC ([`Seal`]). So a frame of 15, 30 and so on
//! cycles ago fails in 255 of 256 cases (FD 65,535 of 65,536), and a foreign frame passes by
//! chance once in 256 (65,536). All other messages, and commands and measurements of a tool that
//! knows only the DBC, have the *plain* CRC.
//!
//! **Receiving.** [`Receiver`], plain or sealed, gives each frame one [`Status`]; only INITIAL, OK
//! and `SOME_LOST` deliver data, and only they feed a watchdog. CONFLICT, and a refused frame that
//! is a valid plain one ([`Reception::plain`]), are evidence of a second sender.
//!
//! **Bus load** is known before a run: [`BusPlan`] computes it from worst-case frame lengths, warns
//! above 50 % and refuses above 80 %.
//!
//! `yawbench.dbc` in this crate is the same contract for other tools, with the rules that a rig
//! keeps in its comments; it is generated from the constants here and checked against the codec by
//! two independent DBC implementations. To write a peer from these pages, read this one, then
//! [`protection`] (CRC and seal), [`SessionCode`] and [`arming`].
//!
//! # Example
//!
//! ```
//! use can_protocol::{Command, Mode, Node, Profile, RunState};
//!
//! let command = Command {
//!     node: Node::new(1)?,
//!     counter: 3,
//!     state: RunState::Run,
//!     mode: Mode::FollowWithVelocity,
//!     echo: Some(2),
//!     displacement_m: Some(3.46e-3),
//!     velocity_m_per_s: Some(-0.076),
//!     time_us: None,
//! };
//! let (frame, saturated) = command.encode(Profile::Classical);
//! assert!(saturated.is_empty());
//! assert_eq!(frame.to_string(), "101#184328870050E222");
//! assert_eq!(Command::decode(frame.id(), frame.data())?, command);
//! # Ok::<(), can_protocol::Error>(())
//! ```
//!
//! # Limits
//!
//! This is no safety function and claims no PL or SIL: emergency stop, guard door and pressure dump
//! are hard-wired. The CRC-8 misses one random corruption in 256 of those that pass CAN's own
//! check. There is no authentication: the seal keeps mistakes, old logs and strangers out, not an
//! attacker who listens to the arming exchange. No message loosens a limit or a guard of a rig:
//! those are the rig's own, arming agrees on the tighter ones, and telemetry reports what tripped.
#![no_std]
#![forbid(unsafe_code)]

pub mod arming;
mod bus_load;
mod command;
mod embedded;
mod error;
mod fault;
mod frame;
mod heartbeat;
mod id;
mod measurement;
mod message;
mod pressure_off;
mod profile;
pub mod protection;
mod receiver;
mod reception;
mod residual;
mod session;
pub mod signal;
mod state;
mod sync;
mod telemetry;
mod track;
mod wire_enum;

pub use arming::{ArmItem, ArmMessage, ArmSide};
pub use bus_load::{
    BusPlan, Verdict, classical_extended_frame_bits, classical_frame_bits, fd_extended_frame_bits,
    fd_frame_bits,
};
pub use command::{Command, CommandLayout, Mode};
pub use embedded::{from_embedded, to_embedded};
pub use error::Error;
pub use fault::{Fault, FaultCode};
pub use frame::Frame;
pub use heartbeat::{Heartbeat, HeartbeatFlags};
pub use id::{MessageId, Node, Sender};
pub use measurement::{Measurement, MeasurementFlags, MeasurementLayout};
pub use message::Message;
pub use pressure_off::PressureOff;
pub use profile::Profile;
pub use receiver::{Cyclic, Receiver, ReceiverState};
pub use reception::{Counts, Reception, Status};
pub use residual::{Residual, Watch};
pub use session::{Seal, SessionCode, SessionHistory};
pub use signal::Saturated;
pub use state::RunState;
pub use sync::{PROTOCOL_VERSION, Pace, Sync};
pub use telemetry::{Pressure, Telemetry, Trips};
pub use track::{
    TrackFingerprint, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample, TrackSeal,
};
