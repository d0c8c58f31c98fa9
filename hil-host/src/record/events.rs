//! `events.jsonl`: what happened in a run, one line of JSON per event, written when it happens.

use super::durable::{Appender, Durable};
use super::input_kind::InputKind;
use super::row::Row;
use super::storage::Storage;
use crate::control::{Notice, Stop};
use can_protocol::{RunState, Watch};
use files::{Limit, input};
use firmware_core::vehicle::DAMPER_SLOTS;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::Path;
use std::sync::Arc;

/// Something that happened in a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunEvent {
    /// Model time (s).
    pub time_s: f64,
    /// The control cycle, from one.
    pub cycle: u64,
    /// What it is.
    #[serde(rename = "event")]
    pub what: Cow<'static, str>,
    /// Number of the damper slot, from one; null for the whole run.
    pub slot: Option<usize>,
    /// The value, in the unit of the limit.
    pub value: Option<f64>,
    /// The limit.
    pub limit: Option<f64>,
    /// The rig that a cause is about.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub node: Option<u8>,
    /// Key of the signal of a cause.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub signal: Option<String>,
}

impl RunEvent {
    /// What stopped a run, or was noted, or a rig without which it goes on.
    pub(crate) fn of(notice: &Notice) -> Self {
        let (kind, slot, stop) = match notice {
            Notice::Cause(stop) => ("cause", None, stop),
            Notice::Noted(first) => ("noted", None, first),
            Notice::DroppedOut { slot, why } => {
                ("rig dropped out, its slot goes on with the model", Some(slot + 1), why)
            }
        };
        let Stop { cycle, time_s, node, cause, .. } = *stop;
        Self {
            time_s,
            cycle,
            what: format!("{kind}: {stop}").into(),
            slot,
            value: Some(cause.value),
            limit: cause.limit.is_finite().then_some(cause.limit),
            node,
            signal: Some(cause.signal.key().to_owned()),
        }
    }
}

/// Events that are read back: many more are in the file of a run that goes wrong all the time.
const EVENTS_MAX: usize = 1000;

/// The events of a run from its file, in the order of their cycles; a last line that is cut off is
/// left out, and so is what cannot be read.
pub(crate) fn read_events(file: &Path) -> Vec<RunEvent> {
    let Ok(file) = input::open(file, Limit::Stream) else { return Vec::new() };
    let lines = BufReader::new(file).lines().map_while(Result::ok);
    let events = lines.filter_map(|line| serde_json::from_str(&line).ok());
    let mut events: Vec<RunEvent> = events.take(EVENTS_MAX).collect();
    events.sort_by_key(|event| event.cycle);
    events
}

/// Cycles in a row without a force that are an event: the guard trips in the fifth.
const STALE_CYCLES: u32 = 5;

/// Time for which further skipped ticks are the same event (s).
const SKIPPED_S: f64 = 1.0;

/// Writes the events of a run.
#[derive(Debug)]
pub(crate) struct EventLog<S = File> {
    file: Appender<S>,
    state: Option<RunState>,
    drift: [Watch; DAMPER_SLOTS],
    /// Cycles in a row without a force.
    stale: [u32; DAMPER_SLOTS],
    /// Ticks skipped since the last event, and the time from which the next may come.
    skipped: (u64, f64),
}

impl<S: Storage> EventLog<S> {
    pub(crate) fn begin(file: S) -> Self {
        Self {
            file: Appender::new(file),
            state: None,
            drift: [Watch::None; DAMPER_SLOTS],
            stale: [0; DAMPER_SLOTS],
            skipped: (0, 0.0),
        }
    }

    /// The file, for the thread that has the disk hold it.
    pub(crate) fn file(&self) -> Arc<Durable<S>> {
        self.file.file()
    }

    /// Waits until the disk holds the events.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub(crate) fn finish(&self) -> io::Result<()> {
        self.file.finish()
    }

    /// Writes an event.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub(crate) fn write(&mut self, event: &RunEvent) -> io::Result<()> {
        let line = serde_json::to_string(event)?;
        self.file.append(format!("{line}\n").as_bytes())
    }

    /// Writes what happened in a cycle.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub(crate) fn take(&mut self, row: &Row) -> io::Result<()> {
        let before = self.state.replace(row.state);
        if before.is_none() {
            self.write(&of(row, "run begun"))?;
        }
        let is_entered = before != Some(row.state);
        self.skipped.0 += u64::from(row.skipped);
        // What comes before a change of the state may be its cause.
        if self.skipped.0 > 0 && (is_entered || row.time_s >= self.skipped.1) {
            self.write(&RunEvent {
                value: Some(self.skipped.0 as f64),
                ..of(row, "ticks skipped")
            })?;
            self.skipped = (0, row.time_s + SKIPPED_S);
        }
        if is_entered {
            self.write(&of(row, entered(row.state)))?;
        }
        for slot in 0..DAMPER_SLOTS {
            self.watch(row, slot)?;
            self.input(row, slot)?;
        }
        Ok(())
    }

    fn watch(&mut self, row: &Row, slot: usize) -> io::Result<()> {
        let (before, now) = (self.drift[slot], row.drift[slot]);
        self.drift[slot] = now;
        let what = match (before == Watch::Drift, now == Watch::Drift) {
            (false, true) => "drift raised",
            (true, false) => "drift cleared",
            _ => return Ok(()),
        };
        let (value, limit) = (row.residual_rms_n[slot], row.residual_limit_n[slot]);
        self.write(&RunEvent {
            slot: Some(slot + 1),
            value: Some(value),
            limit: Some(limit),
            ..of(row, what)
        })
    }

    fn input(&mut self, row: &Row, slot: usize) -> io::Result<()> {
        let before = self.stale[slot];
        let is_stale = row.input[slot].is_stale() && row.cycle > 1;
        self.stale[slot] = if is_stale { before.saturating_add(1) } else { 0 };
        let event = |what, cycles: u32| RunEvent {
            slot: Some(slot + 1),
            value: Some(f64::from(cycles)),
            limit: Some(f64::from(STALE_CYCLES)),
            ..of(row, what)
        };
        match () {
            () if self.stale[slot] == STALE_CYCLES => {
                self.write(&event("no valid force", STALE_CYCLES))
            }
            () if row.input[slot] == InputKind::Fresh && before >= STALE_CYCLES => {
                self.write(&event("valid force again", before))
            }
            () => Ok(()),
        }
    }
}

/// A state of the host that has been entered, as an event.
const fn entered(state: RunState) -> &'static str {
    match state {
        RunState::Init => "state INIT",
        RunState::Standby => "state STANDBY",
        RunState::Armed => "state ARMED",
        RunState::RampIn => "state RAMP_IN",
        RunState::Run => "state RUN",
        RunState::RampOut => "state RAMP_OUT",
        RunState::Safe => "state SAFE",
        RunState::Fault => "state FAULT",
        RunState::OpenLoop => "state OPEN_LOOP",
    }
}

fn of(row: &Row, what: &'static str) -> RunEvent {
    RunEvent { time_s: row.time_s, cycle: row.cycle, what: what.into(), ..RunEvent::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_lost_force_and_skipped_ticks_are_events_with_their_cycles() {
        let name = format!("hil-host-events-{}.jsonl", std::process::id());
        let path = std::env::temp_dir().join(name);
        let mut log = EventLog::begin(File::create(&path).unwrap());
        for cycle in 1..=3000 {
            let mut row = Row { cycle, time_s: (cycle - 1) as f64 / 1e3, ..Row::default() };
            row.state = RunState::Run;
            row.input[1] = InputKind::Fresh;
            // Four are no event, seven are one.
            if matches!(cycle, 101..=104 | 201..=207) {
                row.input[1] = InputKind::Missing;
            }
            row.drift[0] = if (500..600).contains(&cycle) { Watch::Drift } else { Watch::Steady };
            (row.residual_rms_n[0], row.residual_limit_n[0]) = (30.0, 20.0);
            row.skipped = u32::from(matches!(cycle, 1000..=1009));
            log.take(&row).unwrap();
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let read = read_events(&path);
        let lines: Vec<String> =
            read.iter().map(|event| serde_json::to_string(event).unwrap()).collect();
        assert_eq!(lines.join("\n") + "\n", text);
        std::fs::write(&path, &text[..text.len() - 9]).unwrap();
        assert_eq!(read_events(&path), read[..read.len() - 1]);
        std::fs::remove_file(path).unwrap();
        let expected = r#"{"time_s":0.0,"cycle":1,"event":"run begun","slot":null,"value":null,"limit":null}
{"time_s":0.0,"cycle":1,"event":"state RUN","slot":null,"value":null,"limit":null}
{"time_s":0.204,"cycle":205,"event":"no valid force","slot":2,"value":5.0,"limit":5.0}
{"time_s":0.207,"cycle":208,"event":"valid force again","slot":2,"value":7.0,"limit":5.0}
{"time_s":0.499,"cycle":500,"event":"drift raised","slot":1,"value":30.0,"limit":20.0}
{"time_s":0.599,"cycle":600,"event":"drift cleared","slot":1,"value":30.0,"limit":20.0}
{"time_s":0.999,"cycle":1000,"event":"ticks skipped","slot":null,"value":1.0,"limit":null}
{"time_s":1.999,"cycle":2000,"event":"ticks skipped","slot":null,"value":9.0,"limit":null}
"#;
        assert_eq!(text, expected);
    }
}
