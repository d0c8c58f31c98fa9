//! Is the interface set up for the loop? From facts to checks.
//!
//! A virtual interface hands frames from socket to socket: it has no bit timing, no arbitration and
//! no errors, and the rows for these say so. The sample point of classical CAN at 1 Mbit/s lies
//! between the 75 % that Linux chooses above 800 kbit/s and the 87.5 % that `CiA` 301 recommends;
//! two nodes with different sample points tolerate less difference of their clocks and less cable.

use super::bus_facts::{BusFacts, InterfaceKind, Timing};
use super::check::Check;
use std::fmt::Write as _;

/// The bit rates that a bench is to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Nominal (bit/s).
    pub bits_per_s: f64,
    /// Behind the switch of FD frames (bit/s); `None` without FD.
    pub data_bits_per_s: Option<f64>,
}

/// Sample points that are good.
const SAMPLE_POINT: std::ops::RangeInclusive<f64> = 0.75..=0.875;

/// What a set-up asks for where the present sample point is not good.
const CHOSEN_SAMPLE_POINT: f64 = 0.8;

/// Frames that the transmit queue should take: what a host sends in one cycle to one rig (command,
/// sync, heartbeat, residual) and to four.
const QUEUE_FRAMES: std::ops::RangeInclusive<u64> = 4..=10;

/// Data bit rate above which a transmitter sees its own bits late (bit/s).
const COMPENSATED_BITS_PER_S: f64 = 1e6;

/// Bytes of an FD frame as the kernel counts.
const FD_MTU: u64 = 72;

/// Why a row has no answer on a virtual bus.
const VIRTUAL: &str = "does not apply to a virtual bus";

/// Why the driver's silence is no fault.
const SILENT: &str = "the driver does not tell";

/// Judges an interface: one check per row.
pub fn judge_bus(facts: &BusFacts, wanted: &Wanted) -> Vec<Check> {
    let bus = Judged { facts, wanted, command: set_up_command(facts, wanted) };
    let mut checks = vec![bus.interface()];
    match facts.kind {
        InterfaceKind::Absent | InterfaceKind::Other(_) | InterfaceKind::Unread(_) => {
            return checks;
        }
        InterfaceKind::Can | InterfaceKind::Virtual => {}
    }
    checks.extend([bus.kind(), bus.bit_rate(), bus.sample_point()]);
    if let Some(data_bits_per_s) = wanted.data_bits_per_s {
        checks.extend([bus.fd(), bus.data_bit_rate(data_bits_per_s), bus.data_sample_point()]);
        if data_bits_per_s > COMPENSATED_BITS_PER_S {
            checks.push(bus.delay_compensation());
        }
    }
    checks.extend([
        bus.modes(),
        bus.restart(),
        bus.state(),
        bus.error_counters(),
        bus.losses(),
        bus.termination(),
        bus.queue(),
    ]);
    checks
}

/// The command that sets a controller up as it is wanted.
fn set_up_command(facts: &BusFacts, wanted: &Wanted) -> String {
    let (name, controller) = (&facts.interface, &facts.controller);
    let good = |timing: Option<Timing>| {
        let point = timing.and_then(|timing| timing.sample_point);
        point.filter(|point| SAMPLE_POINT.contains(point)).unwrap_or(CHOSEN_SAMPLE_POINT)
    };
    let mut parameters =
        format!("bitrate {} sample-point {:.3}", wanted.bits_per_s, good(controller.nominal));
    // Writing to a string cannot fail.
    if let Some(data_bits_per_s) = wanted.data_bits_per_s {
        let point = good(controller.data);
        let _ = write!(parameters, " dbitrate {data_bits_per_s} dsample-point {point:.3} fd on");
        if controller.known_modes.iter().any(|mode| mode == "TDC-AUTO") {
            parameters += " tdc-mode auto";
        }
    }
    for (mode, option) in WRONG_MODES {
        if controller.modes.iter().any(|on| on == mode) {
            let _ = write!(parameters, " {option} off");
        }
    }
    if controller.restart_ms.is_some_and(|ms| ms > 0) {
        parameters += " restart-ms 0";
    }
    format!(
        "sudo ip link set {name} down; sudo ip link set {name} type can {parameters} && \
         sudo ip link set {name} up"
    )
}

/// Modes that a bench must not have, and what `ip` calls them when it sets them.
const WRONG_MODES: [(&str, &str); 5] = [
    ("LISTEN-ONLY", "listen-only"),
    ("LOOPBACK", "loopback"),
    ("ONE-SHOT", "one-shot"),
    ("PRESUME-ACK", "presume-ack"),
    ("FD-NON-ISO", "fd-non-iso"),
];

/// An interface, what it should be, and how it would become that.
struct Judged<'a> {
    facts: &'a BusFacts,
    wanted: &'a Wanted,
    command: String,
}

impl Judged<'_> {
    /// A row that only a real bus has.
    fn of_controller(
        &self,
        what: &str,
        expected: &str,
        judge: impl FnOnce() -> Option<Check>,
    ) -> Check {
        if self.facts.kind == InterfaceKind::Virtual {
            return Check::unknown(what, VIRTUAL, expected, VIRTUAL);
        }
        judge().unwrap_or_else(|| Check::unknown(what, "-", expected, SILENT))
    }

    fn interface(&self) -> Check {
        let name = &self.facts.interface;
        let (what, expected) = ("interface", "up");
        let change = |found: String, advice: &str, command: &str| {
            Check::good(what, found, expected).or_change(false, advice, command)
        };
        match &self.facts.kind {
            InterfaceKind::Absent => {
                let advice = "look for it with `ip link`; a USB adapter or PCI card needs its \
                              driver (`dmesg | grep -i can`). A virtual bus, for an emulated rig:";
                // Nothing virtual is to be called can0.
                let other = if name.starts_with("vcan") { name } else { "vcan0" };
                let command = format!(
                    "sudo modprobe vcan && sudo ip link add dev {other} type vcan && sudo ip link \
                     set {other} up"
                );
                change(format!("no {name}"), advice, &command)
            }
            InterfaceKind::Other(kind) => {
                let advice = "name a CAN interface: `ip link show type can` lists them";
                change(format!("{name} is of type {kind}"), advice, "")
            }
            InterfaceKind::Unread(why) => Check::unknown(what, name, expected, why),
            InterfaceKind::Can | InterfaceKind::Virtual if self.facts.is_up => {
                Check::good(what, format!("{name} is up"), expected)
            }
            InterfaceKind::Virtual => {
                let command = format!("sudo ip link set {name} up");
                change(format!("{name} is down"), "bring it up", &command)
            }
            InterfaceKind::Can => change(format!("{name} is down"), "set it up", &self.command),
        }
    }

    fn kind(&self) -> Check {
        let (what, expected) = ("kind", "CAN controller");
        if self.facts.kind == InterfaceKind::Virtual {
            let why = "frames go from socket to socket: right for an emulated rig; nothing here \
                       says anything about a CAN bus";
            return Check::unknown(what, "virtual (no bus, no timing)", expected, why);
        }
        Check::good(what, expected, expected)
    }

    fn bit_rate(&self) -> Check {
        let (what, expected) = ("bit rate", rate(self.wanted.bits_per_s));
        self.of_controller(what, &expected, || {
            let found = self.facts.controller.nominal.map(|timing| timing.bits_per_s);
            let shown = found.map_or_else(|| "none set".to_owned(), rate);
            let advice = "all nodes of a bus need the same bit rate; a node with another one \
                          destroys every frame";
            let is_good = found == Some(self.wanted.bits_per_s);
            Some(Check::good(what, shown, &*expected).or_change(is_good, advice, &self.command))
        })
    }

    fn sample_point(&self) -> Check {
        self.point("sample point", self.facts.controller.nominal)
    }

    fn data_sample_point(&self) -> Check {
        self.point("data sample point", self.facts.controller.data)
    }

    fn point(&self, what: &str, timing: Option<Timing>) -> Check {
        let expected = "75 to 87.5 %, the same on all nodes";
        self.of_controller(what, expected, || {
            let point = timing?.sample_point?;
            let advice = "choose the sample point of the other nodes";
            let found = format!("{:.1} %", 100.0 * point);
            let is_good = SAMPLE_POINT.contains(&point);
            Some(Check::good(what, found, expected).or_change(is_good, advice, &self.command))
        })
    }

    fn fd(&self) -> Check {
        let (what, expected) = ("CAN FD", "on");
        let name = &self.facts.interface;
        let takes = self.facts.mtu.is_some_and(|mtu| mtu >= FD_MTU);
        let advice = "the interface takes no FD frames";
        if self.facts.kind == InterfaceKind::Virtual {
            let command = format!("sudo ip link set {name} mtu {FD_MTU}");
            let found = if takes { "on" } else { "off" };
            return Check::good(what, found, expected).or_change(takes, advice, &command);
        }
        let modes = &self.facts.controller.modes;
        let is_on = takes && modes.iter().any(|mode| mode == "FD");
        let found = if is_on { "on" } else { "off" };
        Check::good(what, found, expected).or_change(is_on, advice, &self.command)
    }

    fn data_bit_rate(&self, wanted: f64) -> Check {
        let (what, expected) = ("data bit rate", rate(wanted));
        self.of_controller(what, &expected, || {
            let found = self.facts.controller.data.map(|timing| timing.bits_per_s);
            let shown = found.map_or_else(|| "none set".to_owned(), rate);
            let advice = "all nodes need the same data bit rate";
            let is_good = found == Some(wanted);
            Some(Check::good(what, shown, &*expected).or_change(is_good, advice, &self.command))
        })
    }

    fn delay_compensation(&self) -> Check {
        let what = "transmitter delay compensation";
        let expected = "on above 1 Mbit/s";
        self.of_controller(what, expected, || {
            let controller = &self.facts.controller;
            let modes = ["TDC-AUTO", "TDC-MANUAL"];
            let mode = modes.into_iter().find(|mode| controller.modes.iter().any(|on| on == mode));
            if let Some(mode) = mode {
                let offset = controller
                    .delay_offset
                    .map_or_else(String::new, |offset| format!(", offset {offset} clock periods"));
                return Some(Check::good(what, format!("{mode}{offset}"), expected));
            }
            let is_known = controller.known_modes.iter().any(|known| modes.contains(&&**known));
            let advice = "without it a transmitter samples its own bits too early, sees bit errors \
                          and goes to bus-off";
            is_known
                .then(|| Check::good(what, "off", expected).or_change(false, advice, &self.command))
        })
    }

    fn modes(&self) -> Check {
        let (what, expected) = ("special modes", "none");
        self.of_controller(what, expected, || {
            let on = &self.facts.controller.modes;
            let wrong: Vec<&str> = WRONG_MODES
                .iter()
                .map(|(mode, _)| *mode)
                .filter(|mode| on.iter().any(|on| on == mode))
                .collect();
            let found = if wrong.is_empty() { "none".to_owned() } else { wrong.join(", ") };
            let advice = "listen-only sends nothing, loopback and presume-ack hide a missing rig, \
                          one-shot drops a frame that lost arbitration, and FD-NON-ISO has another \
                          CRC than ISO 11898-1";
            let is_good = wrong.is_empty();
            Some(Check::good(what, found, expected).or_change(is_good, advice, &self.command))
        })
    }

    fn restart(&self) -> Check {
        let (what, expected) = ("restart after bus-off", "never by itself");
        self.of_controller(what, expected, || {
            let ms = self.facts.controller.restart_ms?;
            let found =
                if ms == 0 { expected.to_owned() } else { format!("by itself after {ms} ms") };
            let advice = "bus-off is a fault that a person looks into before the bench moves again";
            Some(Check::good(what, found, expected).or_change(ms == 0, advice, &self.command))
        })
    }

    fn state(&self) -> Check {
        let (what, expected) = ("controller state", "ERROR-ACTIVE");
        self.of_controller(what, expected, || {
            let state = self.facts.controller.state.as_deref()?;
            let name = &self.facts.interface;
            let (advice, command) = match state {
                "BUS-OFF" => (
                    "the controller has left the bus; find the cause (bit rate, cable, \
                     termination), then restart it",
                    format!("sudo ip link set {name} type can restart"),
                ),
                "STOPPED" | "SLEEPING" => ("set it up", self.command.clone()),
                _ => (
                    "frames are destroyed, or nobody acknowledges them: check bit rate, sample \
                     point, cable, termination, and that the other node is on",
                    format!("ip -details -statistics link show {name}"),
                ),
            };
            Some(Check::good(what, state, expected).or_change(state == expected, advice, &command))
        })
    }

    fn error_counters(&self) -> Check {
        let (what, expected) = ("error counters", "0 and 0");
        self.of_controller(what, expected, || {
            let (tx, rx) = self.facts.controller.error_counters?;
            let found = format!("transmit {tx}, receive {rx}");
            let advice = "there are errors now: transmit alone is a missing acknowledge or a \
                          broken driver, both are bit rate, cable or termination";
            let command = format!("candump -e {},0:0,#FFFFFFFF", self.facts.interface);
            let is_good = (tx, rx) == (0, 0);
            Some(Check::good(what, found, expected).or_change(is_good, advice, &command))
        })
    }

    fn losses(&self) -> Check {
        let (what, expected) = ("errors and losses so far", "none");
        self.of_controller(what, expected, || {
            if self.facts.losses.is_empty() {
                return None;
            }
            let counted: Vec<String> = self
                .facts
                .losses
                .iter()
                .filter(|(_, count)| *count > 0)
                .map(|(name, count)| format!("{name} {count}"))
                .collect();
            let found = if counted.is_empty() { "none".to_owned() } else { counted.join(", ") };
            let advice = "look again while the bus is in use: a count that grows is a fault of \
                          today (overruns: the kernel is too slow for the controller; the others: \
                          cable or other nodes), one that stays is the past";
            let command = format!("ip -details -statistics link show {}", self.facts.interface);
            Some(Check::good(what, found, expected).or_change(counted.is_empty(), advice, &command))
        })
    }

    fn termination(&self) -> Check {
        let (what, expected) = ("termination", "120 ohm at both ends of the cable");
        self.of_controller(what, expected, || {
            let why = "measure between CAN-H and CAN-L with everything switched off: 60 ohm is \
                       right, 120 ohm lacks one end, 40 ohm has a third one";
            Some(match self.facts.controller.termination_ohm {
                Some(0) => Check::unknown(what, "off in this controller", expected, why),
                Some(ohm) => {
                    Check::unknown(what, &format!("{ohm} ohm in this controller"), expected, why)
                }
                None => Check::unknown(what, "-", expected, why),
            })
        })
    }

    fn queue(&self) -> Check {
        let (what, expected) = ("transmit queue", "4 to 10 frames");
        self.of_controller(what, expected, || {
            let frames = self.facts.queue_frames?;
            let advice = "it should take what one cycle sends and no more: in a long queue commands \
                          wait behind old ones, a shorter one drops them";
            let command = format!("sudo ip link set {} txqueuelen 10", self.facts.interface);
            let is_good = QUEUE_FRAMES.contains(&frames);
            let found = format!("{frames} frames");
            Some(Check::good(what, found, expected).or_change(is_good, advice, &command))
        })
    }
}

/// A bit rate as it is written on a bench.
fn rate(bits_per_s: f64) -> String {
    if bits_per_s >= 1e6 {
        format!("{} Mbit/s", bits_per_s / 1e6)
    } else {
        format!("{} kbit/s", bits_per_s / 1e3)
    }
}

#[cfg(test)]
mod tests;
