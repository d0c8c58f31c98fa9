//! A rig's own messages: a DBC, a map of it and what came over the bus, with a zero byte between
//! them.
//!
//! A value that was read from a payload and is written back is read again, to the resolution of its
//! signal. Nothing goes to a rig that no host asks for.

use crate::toml_files::check;
use can_protocol::{Node, Profile};
use dbc::{CanId, Database, Fit, Value};
use hil_host::Draw;
use hil_host::bus::{Bus as _, BusCounters, RawFrame, Sent};
use hil_host::gateway::{Gateway, GatewayPlan, Loss, Wire};
use scenario::source::Source;
use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

/// Frames of one input that are looked at.
const FRAMES: usize = 100;

pub(crate) fn own_messages(bytes: &[u8]) {
    let mut parts = bytes.splitn(3, |byte| *byte == 0);
    let mut text = || std::str::from_utf8(parts.next().unwrap_or_default());
    let (Ok(dbc), Ok(map)) = (text(), text()) else { return };
    let frames = parts.next().unwrap_or_default();
    let database = match Database::from_text(Path::new("rig.dbc"), dbc) {
        Ok(database) => database,
        Err(why) => return check::<(), _>(Err(why)),
    };
    let names = dbc.split("SG_ ").skip(1).filter_map(|rest| rest.split_whitespace().next());
    names.for_each(|name| signal(&database, name, frames));
    let source = Source::from_text(Path::new("map.toml"), map);
    match GatewayPlan::new(&database, &source, Loss::ALL) {
        Ok(plan) => gateway(plan, frames),
        Err(why) => check::<(), _>(Err(why)),
    }
}

/// Reads a signal from a payload, writes it into another and reads it again.
fn signal(database: &Database, name: &str, payload: &[u8]) {
    let signal = match database.signal(name) {
        Ok((_, named)) => named.signal,
        Err(why) => return check::<(), _>(Err(why)),
    };
    let mut data = [0; 64];
    let Value::Valid(value) = signal.read(payload) else { return };
    assert!(value.is_finite(), "{name}: {value} counts as valid");
    match signal.write(&mut data, value) {
        Fit::Fits => {}
        // Half a step beyond the limits is still read.
        Fit::Saturated => return,
        Fit::NotANumber => panic!("{name}: {value} is a number"),
    }
    let Value::Valid(again) = signal.read(&data) else { panic!("{name}: {value} is lost") };
    let rounding = 1e-12 * value.abs();
    assert!((again - value).abs() <= signal.resolution() + rounding, "{name}: {value}, {again}");
}

/// A gateway whose host is silent, next to a rig that sends anything.
fn gateway(plan: GatewayPlan, frames: &[u8]) {
    let node = Node::ALL[0];
    let wire = Script::of(frames);
    let mut gateway = Gateway::new(plan, wire, node, Profile::Classical, Draw::seeded(1, 1));
    for _ in 0..FRAMES {
        gateway.wait(Duration::ZERO);
        while gateway.receive().is_some() {}
    }
    assert_eq!(gateway.wire().sent, 0, "frames to a rig whose host is silent");
}

/// Frames that come one after the other; what is sent is counted.
struct Script {
    frames: VecDeque<RawFrame>,
    sent: u64,
    waits: u32,
}

impl Script {
    /// From an id of four bytes, the length and the payload of each.
    fn of(bytes: &[u8]) -> Self {
        let (mut rest, mut frames) = (bytes, VecDeque::new());
        while let Some((&[a, b, c, d, length], after)) = rest.split_first_chunk::<5>() {
            let id = u32::from_le_bytes([a, b, c, d]);
            let (data, after) = after.split_at(usize::from(length % 9).min(after.len()));
            rest = after;
            let id = if id > 0x7FF {
                CanId::Extended(id & 0x1FFF_FFFF)
            } else {
                CanId::Standard(id as u16)
            };
            frames.extend(RawFrame::new(id, false, data));
        }
        Self { frames, sent: 0, waits: 0 }
    }
}

impl Wire for Script {
    fn send(&mut self, _: &RawFrame) -> Sent {
        self.sent += 1;
        Sent::Away
    }

    fn receive(&mut self) -> Option<RawFrame> {
        self.frames.pop_front()
    }

    fn wait(&mut self, _: Duration) -> bool {
        self.waits += 1;
        !self.frames.is_empty()
    }

    fn counters(&self) -> BusCounters {
        BusCounters::default()
    }

    fn time(&self) -> Duration {
        Duration::from_millis(u64::from(self.waits))
    }
}
