//! What Linux knows of a CAN interface, as `ip -details -statistics -json link show` prints it.
//!
//! The same tool sets an interface up, so it is there where a bus is. Netlink would give the same
//! facts; the library for it costs a dozen crates.

use serde::Deserialize;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A CAN interface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BusFacts {
    /// Its name.
    pub interface: String,
    /// What it is.
    pub kind: InterfaceKind,
    /// Whether it is up.
    pub is_up: bool,
    /// Bytes of its longest frame as the kernel counts: 16 classical, 72 FD.
    pub mtu: Option<u64>,
    /// Frames that its transmit queue takes.
    pub queue_frames: Option<u64>,
    /// Counts since the interface was made that should be zero, with their names.
    pub losses: Vec<(String, u64)>,
    /// Its controller; empty for a virtual interface.
    pub controller: Controller,
}

/// What an interface is.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum InterfaceKind {
    /// There is none of this name.
    #[default]
    Absent,
    /// A CAN controller.
    Can,
    /// `vcan` or `vxcan`: frames go from socket to socket.
    Virtual,
    /// Something else, such as `ether`.
    Other(String),
    /// It is there, and nothing more is known.
    Unread(String),
}

/// What the driver tells of a CAN controller; `None` where it does not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Controller {
    /// `ERROR-ACTIVE`, `ERROR-WARNING`, `ERROR-PASSIVE`, `BUS-OFF`, `STOPPED` or `SLEEPING`.
    pub state: Option<String>,
    /// Of classical frames and of the slow parts of FD frames.
    pub nominal: Option<Timing>,
    /// Of the fast part of FD frames.
    pub data: Option<Timing>,
    /// Time after bus-off after which the controller restarts by itself (ms); 0 for never.
    pub restart_ms: Option<u64>,
    /// Error counters, transmit and receive.
    pub error_counters: Option<(u64, u64)>,
    /// Modes that are on, such as `FD` and `LISTEN-ONLY`.
    pub modes: Vec<String>,
    /// Modes that the driver knows.
    pub known_modes: Vec<String>,
    /// The switchable termination (ohm), 0 for off.
    pub termination_ohm: Option<u64>,
    /// Offset of the transmitter delay compensation, periods of the controller's clock.
    pub delay_offset: Option<u64>,
}

/// A bit rate and where in the bit it is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Bit rate (bit/s).
    pub bits_per_s: f64,
    /// Sample point, share of the bit; `None` for a controller with fixed bit rates.
    pub sample_point: Option<f64>,
}

/// The path of an ordinary user need not lead to the tools of an administrator.
const PLACES_OF_IP: [&str; 3] = ["ip", "/usr/sbin/ip", "/sbin/ip"];

impl BusFacts {
    /// Reads an interface.
    pub fn read(interface: &str) -> Self {
        let unread = |why: &str| Self {
            interface: interface.to_owned(),
            kind: InterfaceKind::Unread(why.to_owned()),
            ..Self::default()
        };
        if !Path::new("/sys/class/net").join(interface).exists() {
            return Self { interface: interface.to_owned(), ..Self::default() };
        }
        let output = PLACES_OF_IP.iter().find_map(|ip| {
            let mut ip = Command::new(ip);
            ip.args(["-details", "-statistics", "-json", "link", "show", "dev", interface]);
            ip.output().ok()
        });
        let Some(output) = output else {
            return unread("the tool `ip` cannot be started (Debian: package iproute2)");
        };
        Self::parse(interface, &String::from_utf8_lossy(&output.stdout))
            .unwrap_or_else(|| unread("`ip -details -json link show` prints no facts"))
    }

    /// The facts in what `ip` prints; `None` where it is something else.
    pub(super) fn parse(interface: &str, json: &str) -> Option<Self> {
        let links: Vec<Link> = serde_json::from_str(json).ok()?;
        let link = links.into_iter().find(|link| link.ifname == interface)?;
        let info = link.linkinfo.unwrap_or_default();
        let kind = match (&*link.of_type, info.kind.as_deref()) {
            ("can", Some("vcan" | "vxcan")) => InterfaceKind::Virtual,
            ("can", _) => InterfaceKind::Can,
            (other, _) => InterfaceKind::Other(other.to_owned()),
        };
        let statistics = link.stats64.unwrap_or_default();
        let (rx, tx, bus) = (statistics.rx, statistics.tx, info.statistics.unwrap_or_default());
        let losses = [
            ("receive errors", rx.errors),
            ("receive overruns", rx.over_errors),
            ("transmit errors", tx.errors),
            ("error-passive", bus.error_passive),
            ("bus-off", bus.bus_off),
        ];
        let losses = losses.into_iter().filter_map(|(name, count)| Some((name.to_owned(), count?)));
        Some(Self {
            interface: interface.to_owned(),
            kind,
            is_up: link.flags.iter().any(|flag| flag == "UP"),
            mtu: link.mtu,
            queue_frames: link.txqlen,
            losses: losses.collect(),
            controller: info.data.map(Controller::from).unwrap_or_default(),
        })
    }
}

#[derive(Debug, Deserialize)]
struct Link {
    ifname: String,
    #[serde(default)]
    flags: Vec<String>,
    mtu: Option<u64>,
    txqlen: Option<u64>,
    #[serde(rename = "link_type")]
    of_type: String,
    linkinfo: Option<LinkInfo>,
    stats64: Option<Statistics>,
}

#[derive(Debug, Default, Deserialize)]
struct LinkInfo {
    #[serde(rename = "info_kind")]
    kind: Option<String>,
    #[serde(rename = "info_data")]
    data: Option<InfoData>,
    #[serde(rename = "info_xstats")]
    statistics: Option<BusStatistics>,
}

#[derive(Debug, Deserialize)]
struct InfoData {
    #[serde(default)]
    ctrlmode: Vec<String>,
    #[serde(default)]
    ctrlmode_supported: Vec<String>,
    state: Option<String>,
    berr_counter: Option<Counters>,
    restart_ms: Option<u64>,
    bittiming: Option<BitTiming>,
    bittiming_bitrate: Option<f64>,
    data_bittiming: Option<BitTiming>,
    data_bittiming_bitrate: Option<f64>,
    tdc: Option<Compensation>,
    termination: Option<u64>,
}

#[derive(Debug, Deserialize)]
struct Counters {
    tx: u64,
    rx: u64,
}

#[derive(Debug, Deserialize)]
struct BitTiming {
    bitrate: f64,
    /// A number, or a number as text, by the version of `ip`.
    sample_point: Option<Value>,
    tdc: Option<Compensation>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
struct Compensation {
    tdco: Option<u64>,
}

#[derive(Debug, Default, Deserialize)]
struct BusStatistics {
    error_passive: Option<u64>,
    bus_off: Option<u64>,
}

#[derive(Debug, Default, Deserialize)]
struct Statistics {
    #[serde(default)]
    rx: Direction,
    #[serde(default)]
    tx: Direction,
}

#[derive(Debug, Default, Deserialize)]
struct Direction {
    errors: Option<u64>,
    over_errors: Option<u64>,
}

impl From<InfoData> for Controller {
    fn from(data: InfoData) -> Self {
        let compensation = data.tdc.or(data.data_bittiming.as_ref().and_then(|timing| timing.tdc));
        Self {
            state: data.state,
            nominal: timing(data.bittiming, data.bittiming_bitrate),
            data: timing(data.data_bittiming, data.data_bittiming_bitrate),
            restart_ms: data.restart_ms,
            error_counters: data.berr_counter.map(|counters| (counters.tx, counters.rx)),
            modes: data.ctrlmode,
            known_modes: data.ctrlmode_supported,
            termination_ohm: data.termination,
            delay_offset: compensation.and_then(|compensation| compensation.tdco),
        }
    }
}

/// The timing that is set; a rate of zero is none.
fn timing(timing: Option<BitTiming>, fixed_rate: Option<f64>) -> Option<Timing> {
    let set = timing.map(|timing| {
        let sample_point = match &timing.sample_point {
            Some(Value::Number(number)) => number.as_f64(),
            Some(Value::String(text)) => text.parse().ok(),
            _ => None,
        };
        Timing { bits_per_s: timing.bitrate, sample_point }
    });
    let fixed = fixed_rate.map(|bits_per_s| Timing { bits_per_s, sample_point: None });
    set.or(fixed).filter(|timing| timing.bits_per_s > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_controller_with_fd_is_read_whole() {
        let json = r#"[{"ifname":"can0","flags":["NOARP","UP","LOWER_UP","ECHO"],"mtu":72,
            "txqlen":10,"link_type":"can","linkinfo":{"info_kind":"can","info_data":{
            "ctrlmode":["FD","TDC-AUTO"],"ctrlmode_supported":["LOOPBACK","FD","TDC-AUTO"],
            "state":"ERROR-ACTIVE","berr_counter":{"tx":3,"rx":1},"restart_ms":0,
            "bittiming":{"bitrate":1000000,"sample_point":0.800,"tq":12,"prop_seg":31},
            "data_bittiming":{"bitrate":5000000,"sample_point":"0.750","tdc":{"tdco":12}},
            "termination":120,"termination_const":[0,120],"clock":80000000},
            "info_xstats":{"restarts":0,"bus_error":0,"error_passive":2,"bus_off":0}},
            "stats64":{"rx":{"errors":0,"over_errors":7},"tx":{"errors":0}}}]"#;
        let facts = BusFacts::parse("can0", json).unwrap();
        assert_eq!((&facts.kind, facts.is_up, facts.mtu), (&InterfaceKind::Can, true, Some(72)));
        assert_eq!(facts.queue_frames, Some(10));
        assert!(facts.losses.contains(&("receive overruns".to_owned(), 7)));
        assert!(facts.losses.contains(&("error-passive".to_owned(), 2)));
        let controller = &facts.controller;
        let at = |bits_per_s, point| Some(Timing { bits_per_s, sample_point: Some(point) });
        assert_eq!((controller.nominal, controller.data), (at(1e6, 0.8), at(5e6, 0.75)));
        assert_eq!(controller.error_counters, Some((3, 1)));
        assert_eq!((controller.termination_ohm, controller.delay_offset), (Some(120), Some(12)));
        assert_eq!(controller.modes, ["FD", "TDC-AUTO"]);
    }

    #[test]
    fn what_is_not_a_can_controller_is_distinguished() {
        let kind = |json: &str| BusFacts::parse("x", json).map(|facts| facts.kind);
        let link = |kind: &str, info: &str| {
            format!(r#"[{{"ifname":"x","link_type":"{kind}","linkinfo":{{{info}}}}}]"#)
        };
        assert_eq!(kind(&link("can", r#""info_kind":"vcan""#)), Some(InterfaceKind::Virtual));
        assert_eq!(kind(&link("can", r#""info_kind":"vxcan""#)), Some(InterfaceKind::Virtual));
        assert_eq!(kind(&link("can", "")), Some(InterfaceKind::Can));
        let ether = Some(InterfaceKind::Other("ether".to_owned()));
        assert_eq!(kind(&link("ether", "")), ether);
        for nothing in ["", "[]", "{}", r#"[{"ifname":"y","link_type":"can"}]"#] {
            assert_eq!(kind(nothing), None, "{nothing}");
        }
    }

    #[test]
    fn fixed_bit_rates_and_rates_of_zero_are_understood() {
        let json = r#"[{"ifname":"x","link_type":"can","linkinfo":{"info_data":{
            "bittiming_bitrate":500000,"bitrate_const":[125000,500000],
            "data_bittiming":{"bitrate":0,"sample_point":0.0}}}}]"#;
        let controller = BusFacts::parse("x", json).unwrap().controller;
        let fixed = Timing { bits_per_s: 500e3, sample_point: None };
        assert_eq!((controller.nominal, controller.data), (Some(fixed), None));
    }
}
