//! A bus log as a damper test.
//!
//! A rig's measurement frame holds displacement and force of one instant, so a log of the bus is a
//! record of a damper test. The sample's number comes from the frame's counter, which has no
//! jitter; the sync gives the length of a cycle. Measurements of an armed session are sealed: the
//! numbers that host and rig have exchanged in the log open them, so a log has to begin before
//! arming. Frames that the protocol would not use (wrong CRC, repeated, out of sequence, not in RUN
//! or a ramp, sensor invalid) are omitted and reported; up to three in a row are then filled by
//! interpolation like missing rows of any file, more are an error with its line. Lost frames beyond
//! one turn of the counter are placed by their time stamps where a clock sets the pace.

use super::empty;
use crate::record::log_reader::{LogFault, LogLine, LogReader};
use can_protocol::arming::FollowedExchange;
use can_protocol::{
    ArmMessage, Measurement, MeasurementFlags, MessageId, Node, Pace, Profile, Receiver,
    ReceiverState, RunState, Status, Sync,
};
use files::quoted;
use measurement::{MeasurementError, Series};
use std::path::Path;

/// Lost frames in a row that the receiver accepts; below half the 4-bit counter.
const MAX_DELTA: u8 = 5;

/// The measurements of one node in a candump log. `bus` names the interface where the node answers
/// on several.
///
/// # Errors
/// The log cannot be read, holds no measurements of the node, or those of two buses.
pub fn read_bus_log(
    path: &Path,
    node: Node,
    bus: Option<&str>,
) -> Result<Series, MeasurementError> {
    let mut log = LogReader::open(path).map_err(failed)?;
    let mut seen = Seen::new(path, node)?;
    while let Some(line) = log.next_line().map_err(failed)? {
        if bus.is_none_or(|bus| bus == line.bus) {
            seen.take(&line)?;
        }
    }
    seen.is_cut_off = log.is_cut_off();
    seen.series()
}

/// The rigs that measure in a candump log and their buses, in the order in which they appear. Every
/// rig of a run answers from its beginning, so the first part of a log shows all of them.
///
/// # Errors
/// The log cannot be read.
pub(super) fn rigs_in_log(path: &Path) -> Result<Vec<(Node, String)>, MeasurementError> {
    let mut log = LogReader::open(path).map_err(failed)?.of_first_part();
    let mut rigs: Vec<(Node, String)> = Vec::new();
    while let Some(line) = log.next_line().map_err(failed)? {
        if let Some(MessageId::Measurement(_, node)) = MessageId::from_raw(line.frame.id())
            && !rigs.iter().any(|(known, bus)| *known == node && *bus == line.bus)
        {
            rigs.push((node, line.bus));
        }
    }
    Ok(rigs)
}

/// Why a log cannot be read, as an error of a record.
fn failed(fault: LogFault) -> MeasurementError {
    match fault {
        LogFault::Input(why) => why.into(),
        LogFault::Disk(file, why) => MeasurementError::File {
            file,
            found: format!("no readable file ({why})"),
            expected: "a candump log".to_owned(),
        },
        LogFault::NoFrame(file, row, found) => MeasurementError::Cell {
            file,
            row,
            column: "frame".to_owned(),
            found: quoted(&found).to_string(),
            expected: "(time) bus id#data, as candump -L writes it".to_owned(),
        },
    }
}

/// What has been read of a log so far.
struct Seen {
    series: Series,
    node: Node,
    bus: Option<String>,
    receivers: [(Receiver<Measurement>, ReceiverState); 2],
    /// Number and counter of the last sample, and its stamp.
    last: Option<(u64, u8, u64)>,
    numbers: Vec<u64>,
    stamps_us: Vec<u64>,
    sync: Option<Sync>,
    /// The exchange that the log shows.
    exchange: FollowedExchange,
    is_cut_off: bool,
    unused: u64,
    not_running: u64,
    invalid: u64,
}

impl Seen {
    fn new(path: &Path, node: Node) -> Result<Self, MeasurementError> {
        let receiver = |profile| {
            let receiver = Receiver::new(profile, node, MAX_DELTA).map_err(|error| {
                MeasurementError::File {
                    file: path.to_owned(),
                    found: error.to_string(),
                    expected: "a receiver".to_owned(),
                }
            })?;
            Ok::<_, MeasurementError>((receiver, ReceiverState::default()))
        };
        Ok(Self {
            series: empty(path, &format!("node{node}")),
            node,
            bus: None,
            receivers: [receiver(Profile::Classical)?, receiver(Profile::Fd)?],
            last: None,
            numbers: Vec::new(),
            stamps_us: Vec::new(),
            sync: None,
            exchange: FollowedExchange::default(),
            is_cut_off: false,
            unused: 0,
            not_running: 0,
            invalid: 0,
        })
    }

    fn take(&mut self, line: &LogLine) -> Result<(), MeasurementError> {
        let LogLine { line, stamp_us, ref bus, ref frame, .. } = *line;
        let (id, data) = (frame.id(), frame.data());
        let profile = match MessageId::from_raw(id) {
            Some(MessageId::Sync) => {
                // The first one stands for the run; a change of period would be another run.
                self.sync = self.sync.or(Sync::decode(id, data).ok());
                return Ok(());
            }
            Some(MessageId::Measurement(profile, node)) if node == self.node => profile,
            Some(MessageId::ArmRequest(node) | MessageId::ArmAnswer(node)) if node == self.node => {
                if let Ok(message) = ArmMessage::decode(id, data) {
                    self.follow_arming(&message);
                }
                return Ok(());
            }
            _ => return Ok(()),
        };
        let known = self.bus.get_or_insert_with(|| bus.clone());
        if known != bus {
            return Err(MeasurementError::Cell {
                file: self.series.file.clone(),
                row: line,
                column: "bus".to_owned(),
                found: format!("node {} on {} after {}", self.node, quoted(bus), quoted(known)),
                expected: "one bus, or its name".to_owned(),
            });
        }
        let [classical, fd] = &mut self.receivers;
        let (receiver, state) = if profile == Profile::Fd { fd } else { classical };
        let Some(reception) = receiver.accept(state, id, data) else { return Ok(()) };
        let Some(measurement) = reception.data else {
            self.unused += 1;
            return Ok(());
        };
        let number = self.number(profile, reception.status, measurement.counter, stamp_us);
        self.last = Some((number, measurement.counter, stamp_us));
        match measurement.state {
            state if state.moves() => {}
            // Every session begins with these.
            RunState::Armed => return Ok(()),
            _ => {
                self.not_running += 1;
                return Ok(());
            }
        }
        match (measurement.displacement_m, measurement.force_n) {
            (Some(displacement_m), Some(force_n))
                if !measurement.flags.contains(MeasurementFlags::SENSOR_INVALID) =>
            {
                self.numbers.push(number);
                self.stamps_us.push(stamp_us);
                self.series.lines.push(line);
                self.series.displacement_m.push(displacement_m);
                self.series.force_n.push(force_n);
            }
            _ => self.invalid += 1,
        }
        Ok(())
    }

    /// Follows an exchange into the session that begins with it.
    fn follow_arming(&mut self, message: &ArmMessage) {
        let Some(code) = self.exchange.hear(message) else { return };
        for (receiver, state) in &mut self.receivers {
            *receiver = receiver.clone().sealed(code);
            *state = ReceiverState::default();
        }
    }

    /// Number of a sample: counted by the counter, by the clock where that has turned over.
    fn number(&self, profile: Profile, status: Status, counter: u8, stamp_us: u64) -> u64 {
        let Some((last, from, last_us)) = self.last else { return 0 };
        let steps = u64::from(profile.counter_steps(from, counter));
        let Some(sync) = self.sync.filter(|sync| sync.pace == Pace::Clock) else {
            return last + steps.max(1);
        };
        let cycle_us = u64::from(sync.period_us.get()) * u64::from(sync.slow_down.get());
        let turn = u64::from(profile.counter_modulus());
        let passed = (stamp_us.saturating_sub(last_us) + cycle_us / 2) / cycle_us;
        // A frame may be late by half a turn before it counts as one of the next turn.
        let turns = (passed + turn / 2).saturating_sub(steps) / turn;
        // The counter of a sequence that begins anew carries no information.
        if status == Status::Initial { last + passed.max(1) } else { last + steps + turns * turn }
    }

    fn series(mut self) -> Result<Series, MeasurementError> {
        let first = self.numbers.first().copied().unwrap_or(0);
        if self.numbers.is_empty() {
            return Err(MeasurementError::File {
                file: self.series.file,
                found: format!("no measurement of node {} in state RUN", self.node),
                expected: "a log of a run with that rig".to_owned(),
            });
        }
        let period_s = if let Some(sync) = self.sync {
            f64::from(sync.period_us.get()) * 1e-6
        } else {
            let span_us = self.stamps_us.last().zip(self.stamps_us.first());
            let span_us = span_us.map_or(0, |(last, first)| last.saturating_sub(*first));
            let cycles = self.numbers.last().map_or(0, |last| last - first).max(1);
            let period_s = span_us as f64 * 1e-6 / cycles as f64;
            self.series
                .repairs
                .push(format!("no sync in the log: a cycle is {period_s:.6} s by the time stamps"));
            period_s
        };
        self.series.time_s =
            self.numbers.iter().map(|number| (number - first) as f64 * period_s).collect();
        for (count, what) in [
            (self.unused, "frames with a wrong CRC, repeated or out of sequence left out"),
            (self.not_running, "frames outside of RUN left out"),
            (self.invalid, "frames without valid force and displacement left out"),
        ] {
            if count > 0 {
                self.series.repairs.push(format!("{count} {what}"));
            }
        }
        if self.is_cut_off {
            self.series.repairs.push("the last line is cut off and left out".to_owned());
        }
        Ok(self.series)
    }
}
