//! Arming: the exchange after which a rig may move.
//!
//! Host and rig exchange [`ArmMessage`]s, an item and its 32-bit value each: `0x600 + n` asks,
//! `0x610 + n` answers. The host sends one item at a time, repeats it until the answer comes, and
//! gives up by name ([`Patience`]). Both state machines are pure: messages and cycles in, messages
//! and an outcome out, no clock, no bus and no source of numbers of their own.
//!
//! # The exchange
//!
//! With `h` and `r` for the numbers of host and rig and `c` for the hash of the [`Configuration`]
//! with the agreed limits:
//!
//! | item | code | host sends | rig answers |
//! | --- | --- | --- | --- |
//! | `HOST_NUMBER` | `0x0101` | `h` | `RIG_NUMBER` (`0x0102`) with a fresh `r`; the same `r` while `h` stays |
//! | `STROKE_UM` | `0x0201` | the limit that it asks for | the tighter of that and its own |
//! | `VELOCITY_UM_PER_S` | `0x0202` | likewise | likewise |
//! | `ACCELERATION_MM_PER_S2` | `0x0203` | likewise | likewise |
//! | `FORCE_N` | `0x0204` | likewise | likewise |
//! | `ALIVE` | `0x0301` | 0 | its boot number |
//! | `ENABLED` | `0x0302` | 0 | 1 when its key switch enables motion, else 0 |
//! | `ZERO_AGE_S` | `0x0303` | 0 | age of the load cell's zero in s, all ones: none |
//! | `SHUNT_CHECK` | `0x0304` | 0 | 1 when the shunt check passed, else 0 |
//! | `FORCE_AT_REST_N` | `0x0305` | 0 | magnitude in N, all ones: unknown |
//! | `STROKE_LEFT_OUT_UM` | `0x0306` | 0 | stroke left in extension, µm |
//! | `STROKE_LEFT_IN_UM` | `0x0307` | 0 | stroke left in compression, µm |
//! | `CONFIGURATION_HASH` | `0x0401` | `c` | its own `c`, when equal |
//! | `ARM` | `0x0501` | `r xor c` | `ARMED` (`0x0502`) with `h xor c` |
//!
//! Instead of `ARMED` a rig answers `QUIET_CYCLES` (`0x0503`) with the cycles after which the host
//! may ask again. To any item it may answer `REFUSED` (`0x0504`) with the code of the item that
//! stands against it: a limit, an item of readiness, `CONFIGURATION_HASH`, `RIG_NUMBER` (no
//! exchange is open, or no new number was found), `ARM` (a wrong value) or `STATE` (`0x0505`, not
//! STANDBY). A refused exchange is over, and the next one has another `r`. A host that refuses
//! sends `REFUSED` as well.
//!
//! A latched rig is reset by `HOST_NUMBER` and then `RESET` (`0x0601`) with `r`; it answers `RESET`
//! with `h`. It does so in SAFE or FAULT only, and only where its own conditions allow a reset.
//!
//! # Why nothing else arms
//!
//! - The value of `ARM` holds the fresh number of this rig and this exchange: no single frame and
//!   no old log has it, but by a chance of 1 in 2^32, and a wrong one costs the exchange.
//! - The same value holds the configuration: sides that disagree in a limit, the period, the pace
//!   or the frames themselves disagree in `c`.
//! - A rig that rebooted has no open exchange.
//! - Before ARM either side counts 300 cycles without a foreign frame ([`Quiet`]), and the host
//!   compares the boot number of `ALIVE` with that of the heartbeat.
//!
//! # After it
//!
//! Commands and measurements are sealed with [`Agreement::code`], each side from its cycle 0
//! ([`SessionCode`](crate::SessionCode)). The host commands as soon as it has ARMED. The rig sends
//! its first measurement, cycle 0, after it has accepted a command; its watchdog rules from then
//! on. A rig that accepts no command within 500 cycles of arming, or hears `REFUSED` before the
//! first one, goes back to STANDBY ([`RigEvent::Lapsed`]).
//!
//! # A worked exchange
//!
//! `h` is `0x12345678`, `r` is `0xDEADBEEF`, `c` that of the example at [`Configuration`]:
//!
//! ```text
//! 601#9210010178563412 HOST_NUMBER 0x12345678
//! 611#7B100201EFBEADDE RIG_NUMBER 0xdeadbeef
//! 601#53110102204E0000 STROKE_UM 0x00004e20
//! 611#CA110102204E0000 STROKE_UM 0x00004e20
//! 601#CF120202E0930400 VELOCITY_UM_PER_S 0x000493e0
//! 611#56120202E0930400 VELOCITY_UM_PER_S 0x000493e0
//! 601#2C13030228230000 ACCELERATION_MM_PER_S2 0x00002328
//! 611#B513030228230000 ACCELERATION_MM_PER_S2 0x00002328
//! 601#A914040230750000 FORCE_N 0x00007530
//! 611#3014040230750000 FORCE_N 0x00007530
//! 601#7315010300000000 ALIVE 0x00000000
//! 611#F615010307B00000 ALIVE 0x0000b007
//! 601#5E16020300000000 ENABLED 0x00000000
//! 611#5A16020301000000 ENABLED 0x00000001
//! 601#4517030300000000 ZERO_AGE_S 0x00000000
//! 611#611703033C000000 ZERO_AGE_S 0x0000003c
//! 601#D618040300000000 SHUNT_CHECK 0x00000000
//! 611#D218040301000000 SHUNT_CHECK 0x00000001
//! 601#CD19050300000000 FORCE_AT_REST_N 0x00000000
//! 611#861905030C000000 FORCE_AT_REST_N 0x0000000c
//! 601#E01A060300000000 STROKE_LEFT_OUT_UM 0x00000000
//! 611#451A0603A8610000 STROKE_LEFT_OUT_UM 0x000061a8
//! 601#FB1B070300000000 STROKE_LEFT_IN_UM 0x00000000
//! 611#3E1B0703C05D0000 STROKE_LEFT_IN_UM 0x00005dc0
//! 601#B11C0104ED3B20B7 CONFIGURATION_HASH 0xb7203bed
//! 611#281C0104ED3B20B7 CONFIGURATION_HASH 0xb7203bed
//! 601#3D1D010502858D69 ARM 0x698d8502
//! 611#D41D0205956D14A5 ARMED 0xa5146d95
//! ```
//!
//! ARM is `0xDEADBEEF xor 0xB7203BED`, ARMED is `0x12345678 xor 0xB7203BED`. The session code is
//! `0x49C5`, and the first command is sealed with the mask `0xC5`.
//!
//! # Example
//!
//! ```
//! use can_protocol::arming::{
//!     Configuration, HostArming, HostOutcome, HostPlan, Limits, Listener, Patience, Quiet,
//!     Readiness, Requirements, RigArming, RigEvent, RigStatus,
//! };
//! use can_protocol::{Heartbeat, Node, Pace, Profile, RunState, Sender, SessionHistory};
//!
//! let node = Node::new(1)?;
//! let limits = Limits {
//!     stroke_um: 20_000, velocity_um_per_s: 300_000,
//!     acceleration_mm_per_s2: 9000, force_n: 30_000,
//! };
//! let configuration = Configuration {
//!     profile: Profile::Classical,
//!     pace: Pace::Clock,
//!     period_us: 1000.try_into()?,
//!     slow_down: 1.try_into()?,
//!     watchdog_cycles: 5,
//!     limits,
//! };
//! let requirements = Requirements {
//!     enabled: true, zero_age_s: 3600, shunt_passed: true, force_at_rest_n: 200, stroke_um: 5000,
//! };
//! let plan = HostPlan {
//!     node, number: 0x1234_5678, asked: limits, needed: limits, requirements, configuration,
//!     patience: Patience::default(),
//! };
//! let status = RigStatus {
//!     state: RunState::Standby,
//!     may_reset: false,
//!     readiness: Readiness {
//!         boot: 7, enabled: true, zero_age_s: Some(60), shunt_passed: true,
//!         force_at_rest_n: Some(12), stroke_out_um: 25_000, stroke_in_um: 24_000,
//!     },
//!     requirements,
//!     configuration,
//! };
//!
//! let mut host = HostArming::new(plan, SessionHistory::default());
//! let mut host_hears = Quiet::new(Listener::Host);
//! let mut rig = RigArming::new(node, SessionHistory::default());
//! let mut rig_hears = Quiet::new(Listener::Rig(node));
//! let (heartbeat, _) = Heartbeat::new(Sender::Rig(node), 0, RunState::Standby, 7).encode();
//! host_hears.hear(heartbeat.id(), heartbeat.data());
//! let mut event = None;
//! while let HostOutcome::Pending(_) = host.outcome() {
//!     host_hears.cycle();
//!     rig_hears.cycle();
//!     rig.cycle();
//!     if let Some(request) = host.cycle(&host_hears) {
//!         let answer;
//!         (answer, event) = rig.receive(&request, &status, &mut rig_hears, || 0xDEAD_BEEF);
//!         if let Some(answer) = answer {
//!             host.receive(&answer);
//!         }
//!     }
//! }
//! let HostOutcome::Armed(agreement) = host.outcome() else { panic!() };
//! assert_eq!(event, Some(RigEvent::Armed(agreement)));
//! assert_eq!(agreement.code().bits(), 0x49C5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod agreement;
mod configuration;
mod followed_exchange;
mod host;
mod item;
mod limits;
mod message;
mod quiet;
mod readiness;
mod refusal;
mod rig;

pub use agreement::Agreement;
pub use configuration::{Configuration, DBC_HASH};
pub use followed_exchange::FollowedExchange;
pub use host::{HostArming, HostOutcome, HostPlan, Patience};
pub use item::ArmItem;
pub use limits::Limits;
pub use message::{ArmMessage, ArmSide};
pub use quiet::{Foreign, Heard, Listener, Quiet};
pub use readiness::{Readiness, Requirements};
pub use refusal::{Refusal, Shortfall};
pub use rig::{RigArming, RigEvent, RigStatus};
