//! What a run measured on a damper, read back as a test: from its bus log or from its record.
//!
//! A rig's measurement frame holds displacement and force of one instant, so a log of the bus is a
//! record of a damper test. The sample's number comes from the frame's counter, which does not jitter;
//! the sync says how long a cycle is. Frames that the protocol would not use (wrong CRC, repeated, out of
//! sequence, not in RUN, sensor invalid) are left out and told; up to three in a row are then filled
//! by interpolation like missing rows of any file, more are an error with its line. Lost frames beyond
//! one turn of the counter are placed by their time stamps where a clock rules.

use super::npy;
use super::row::Row;
use can_protocol::{
    Measurement, MeasurementFlags, MessageId, Node, Pace, Profile, Receiver, ReceiverState,
    RunState, Status, Sync,
};
use firmware_core::vehicle::DAMPER_SLOTS;
use measurement::mapping::Extension;
use measurement::{MeasurementError, Series};
use socketcan::dump::{ParseError, Reader};
use socketcan::{CanAnyFrame, EmbeddedFrame, Frame as _};
use std::path::{Path, PathBuf};

/// Lost frames in a row that the receiver accepts; below half the 4-bit counter.
const MAX_DELTA: u8 = 5;

/// The measurements of one node in a candump log. `bus` names the interface where the node answers on
/// several.
///
/// # Errors
/// The log cannot be read, holds no measurements of the node, or those of two buses.
pub fn read_bus_log(
    path: &Path,
    node: Node,
    bus: Option<&str>,
) -> Result<Series, MeasurementError> {
    let fail = |found: String, expected: &str| MeasurementError::File {
        file: path.to_owned(),
        found,
        expected: expected.to_owned(),
    };
    let mut reader = Reader::from_file(path)
        .map_err(|error| fail(format!("no readable file ({error})"), "a candump log"))?;
    let mut seen = Seen::new(path, node)?;
    let mut line = 0;
    loop {
        line += 1;
        let record = match reader.next_record() {
            Ok(Some(record)) => record,
            Ok(None) => break,
            Err(ParseError::Io(error)) => {
                return Err(fail(format!("a read that failed ({error})"), "a candump log"));
            }
            Err(error) => {
                return Err(MeasurementError::Cell {
                    file: path.to_owned(),
                    row: line,
                    column: "frame".to_owned(),
                    found: error.to_string(),
                    expected: "(time) bus id#data, as candump -L writes it".to_owned(),
                });
            }
        };
        if bus.is_some_and(|bus| bus != record.device) {
            continue;
        }
        let (id, data) = match &record.frame {
            CanAnyFrame::Normal(frame) if !frame.is_extended() => (frame.raw_id(), frame.data()),
            CanAnyFrame::Fd(frame) if !frame.is_extended() => (frame.raw_id(), frame.data()),
            _ => continue,
        };
        let Ok(id) = u16::try_from(id) else { continue };
        seen.take(line, record.t_us, &record.device, id, data)?;
    }
    seen.series()
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
            unused: 0,
            not_running: 0,
            invalid: 0,
        })
    }

    fn take(
        &mut self,
        line: usize,
        stamp_us: u64,
        bus: &str,
        id: u16,
        data: &[u8],
    ) -> Result<(), MeasurementError> {
        let profile = match MessageId::from_raw(id) {
            Some(MessageId::Sync) => {
                // The first one stands for the run; a change of period would be another run.
                self.sync = self.sync.or(Sync::decode(id, data).ok());
                return Ok(());
            }
            Some(MessageId::Measurement(profile, node)) if node == self.node => profile,
            _ => return Ok(()),
        };
        let known = self.bus.get_or_insert_with(|| bus.to_owned());
        if known != bus {
            return Err(MeasurementError::Cell {
                file: self.series.file.clone(),
                row: line,
                column: "bus".to_owned(),
                found: format!("node {} on {bus} after {known}", self.node),
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
        if measurement.state != RunState::Run {
            self.not_running += 1;
            return Ok(());
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
        // A sequence that begins anew says nothing by its counter.
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
        Ok(self.series)
    }
}

/// One damper slot (0 to 3) of a run's `record.npy`: what the rig measured in the cycles that had a fresh
/// answer, or motion and force of the model for a slot without a rig.
///
/// # Errors
/// The file cannot be read, is no record of this version, or the slot has no such rows.
pub fn read_record(path: &Path, slot: usize) -> Result<Series, MeasurementError> {
    let fail = |found: String, expected: String| MeasurementError::File {
        file: path.to_owned(),
        found,
        expected,
    };
    let bytes = std::fs::read(path)
        .map_err(|error| fail(format!("no readable file ({error})"), "a record".to_owned()))?;
    let rows = npy::rows(&bytes).ok_or_else(|| {
        fail("another layout".to_owned(), "a record.npy of this version".to_owned())
    })?;
    if slot >= DAMPER_SLOTS {
        return Err(fail(format!("slot {slot}"), format!("0 to {}", DAMPER_SLOTS - 1)));
    }
    let offset = |name: &str| Row::offset(name).unwrap_or(0);
    let number = |row: &[u8], name: &str, item: usize| -> f64 {
        let at = offset(name) + 8 * item;
        let bytes = row.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
        bytes.map_or(f64::NAN, f64::from_le_bytes)
    };
    let input = |row: &[u8]| row.get(offset("input") + slot).copied().unwrap_or(0);
    let on_rig = rows.clone().any(|row| input(row) != 0);
    let (displacement, force) =
        if on_rig { ("measured_m", "measured_n") } else { ("extension_m", "force_n") };
    let mut series = empty(path, &format!("slot{slot}"));
    let mut stale = 0;
    for (index, row) in rows.enumerate() {
        let (x, f) = (number(row, displacement, slot), number(row, force, slot));
        if on_rig && (input(row) != 1 || !x.is_finite() || !f.is_finite()) {
            stale += 1;
            continue;
        }
        series.lines.push(index + 1);
        series.time_s.push(number(row, "time_s", 0));
        series.displacement_m.push(x);
        series.force_n.push(f);
    }
    if stale > 0 {
        series.repairs.push(format!("{stale} cycles without a fresh measurement left out"));
    }
    Ok(series)
}

fn empty(path: &Path, part: &str) -> Series {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Series {
        name: format!("{}-{part}", stem.unwrap_or_default()),
        file: PathBuf::from(path),
        lines: Vec::new(),
        time_s: Vec::new(),
        time_resolution_s: 0.0,
        displacement_m: Vec::new(),
        force_n: Vec::new(),
        velocity_m_per_s: None,
        temperature_degc: None,
        extension: Extension::Positive,
        repairs: Vec::new(),
        columns: ["time_s", "displacement_m", "force_n"].map(str::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::WireFrame;
    use crate::record::{BusEvent, BusLog, NpyWriter};
    use measurement::Measurement as Test;
    use std::num::{NonZeroU8, NonZeroU16};

    fn place(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("yawbench-{}-{name}", std::process::id()))
    }

    /// Displacement (m) and force (N) of a cycle of 2 ms: 5 mm at 2 Hz.
    fn sample(cycle: u64) -> (f64, f64) {
        let angle = std::f64::consts::TAU * 2.0 * cycle as f64 * 2e-3;
        (5e-3 * libm::sin(angle), 9e3 * libm::sin(angle + 0.9))
    }

    /// A log of 1500 cycles at 500 Hz; `change` may spoil or drop a measurement.
    fn log(name: &str, change: impl Fn(u64, &mut Measurement) -> bool) -> PathBuf {
        let path = place(name);
        let mut log =
            BusLog::create(&path, 1_700_000_000_000_000_000, vec!["can0".into()]).unwrap();
        let sync = Sync {
            version: 1,
            profile: Profile::Classical,
            pace: Pace::Clock,
            period_us: NonZeroU16::new(2000).unwrap(),
            slow_down: NonZeroU8::MIN,
            time_us: 0,
        };
        let event = |time_ns, frame: &can_protocol::Frame| BusEvent {
            time_ns,
            bus: 0,
            frame: WireFrame::from(frame),
        };
        log.write(&[event(0, &sync.encode())]).unwrap();
        let mut counter = 0;
        for cycle in 0..1500 {
            let (x, f) = sample(cycle);
            for node in [Node::ALL[0], Node::ALL[1]] {
                let mut measurement = Measurement {
                    node,
                    counter,
                    state: RunState::Run,
                    flags: MeasurementFlags::default(),
                    echo: None,
                    force_n: Some(f * f64::from(node.number())),
                    displacement_m: Some(x),
                    time_us: None,
                };
                if change(cycle, &mut measurement) {
                    // Up to 0.7 ms late.
                    let time_ns = cycle * 2_000_000 + cycle % 8 * 100_000;
                    let (frame, _) = measurement.encode(Profile::Classical);
                    log.write(&[event(time_ns, &frame)]).unwrap();
                }
            }
            counter = Profile::Classical.next_counter(counter);
        }
        log.finish().unwrap();
        path
    }

    #[test]
    fn a_bus_log_is_a_test_of_one_node() {
        let path = log("good.log", |_, _| true);
        let series = read_bus_log(&path, Node::ALL[1], None).unwrap();
        assert_eq!((series.time_s.len(), series.repairs.len()), (1500, 0));
        assert_eq!(series.lines[0], 3);
        let test = Test::from_series(series).unwrap();
        assert_eq!((test.step_s, test.direction_declared, test.cycles.len()), (2e-3, true, 6));
        for cycle in 0..1500 {
            let (x, f) = sample(cycle as u64);
            // Half a digit of the wire: 0.2 um, 0.2 N.
            assert!((test.displacement_m[cycle] - x).abs() <= 0.11e-6, "{cycle}");
            assert!((test.force_n[cycle] - 2.0 * f).abs() <= 0.11, "{cycle}");
        }
        let none = read_bus_log(&path, Node::ALL[2], None).unwrap_err().to_string();
        assert!(
            none.ends_with(
                "found no measurement of node 3 in state RUN, expected a log of a run with that rig"
            ),
            "{none}"
        );
        assert!(read_bus_log(&path, Node::ALL[0], Some("can1")).is_err());
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn lost_and_unusable_frames_are_told_and_keep_their_place() {
        let path = log("lossy.log", |cycle, measurement| {
            match cycle {
                0..20 => measurement.state = RunState::Safe,
                // Two lost, one without force, one repeated counter.
                300 | 301 => return false,
                500 => measurement.force_n = None,
                700 => {
                    measurement.counter = Profile::Classical.counter_steps(1, measurement.counter);
                }
                _ => {}
            }
            true
        });
        let series = read_bus_log(&path, Node::ALL[0], None).unwrap();
        assert_eq!(series.time_s.len(), 1500 - 20 - 4);
        assert!((series.time_s.last().unwrap() - 1479.0 * 2e-3).abs() < 1e-12);
        let expected = [
            "1 frames with a wrong CRC, repeated or out of sequence left out",
            "20 frames outside of RUN left out",
            "1 frames without valid force and displacement left out",
        ];
        assert_eq!(series.repairs, expected);
        let test = Test::from_series(series).unwrap();
        assert_eq!(
            test.repairs[3],
            "time_s: 4 missing samples filled in after line 600, 996, 1396, by cubic interpolation"
        );
        assert_eq!(test.len(), 1480);
        for cycle in [299, 300, 301, 500, 700, 1499] {
            let (x, f) = sample(cycle as u64);
            assert!((test.displacement_m[cycle - 20] - x).abs() <= 0.3e-6, "{cycle}");
            assert!((test.force_n[cycle - 20] - f).abs() <= 1.0, "{cycle}");
        }
        // Forty lost: more than two turns of the counter. The frame after them is out of sequence; the
        // next is placed by the clock, and that is too many to fill.
        let path_2 = log("gap.log", |cycle, _| !(600..640).contains(&cycle));
        let series = read_bus_log(&path_2, Node::ALL[0], None).unwrap();
        assert!((series.time_s.last().unwrap() - 1499.0 * 2e-3).abs() < 1e-12);
        let error = Test::from_series(series).unwrap_err().to_string();
        assert!(
            error.contains("gap.log:1204: time_s: found a gap of 0.084000 s, 41 samples"),
            "{error}"
        );
        std::fs::remove_file(path).unwrap();
        std::fs::remove_file(path_2).unwrap();
    }

    #[test]
    fn what_is_no_log_and_no_record_is_refused_with_its_line() {
        let path = place("bad.log");
        std::fs::write(&path, "(1700000000.000000) can0 080#00\ntime,x\n").unwrap();
        let error = read_bus_log(&path, Node::ALL[0], None).unwrap_err().to_string();
        assert!(error.contains("bad.log:2: frame: found"), "{error}");
        let error = read_record(&path, 0).unwrap_err().to_string();
        assert!(
            error.ends_with("found another layout, expected a record.npy of this version"),
            "{error}"
        );
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_record_gives_every_slot_its_own_signals() {
        let path = place("record.npy");
        let mut writer = NpyWriter::create(&path).unwrap();
        for cycle in 0..200_u64 {
            let (x, f) = sample(cycle);
            let mut row = Row { cycle: cycle + 1, time_s: cycle as f64 * 2e-3, ..Row::default() };
            (row.extension_m[0], row.force_n[0]) = (x, f);
            (row.measured_m[3], row.measured_n[3]) = (2.0 * x, 3.0 * f);
            row.input[3] = if cycle == 9 { 2 } else { 1 };
            writer.write(&[row]).unwrap();
        }
        writer.finish().unwrap();
        let modelled = read_record(&path, 0).unwrap();
        assert_eq!((modelled.displacement_m[50], modelled.force_n[50]), sample(50));
        assert_eq!(modelled.time_s.len(), 200);
        let rig = read_record(&path, 3).unwrap();
        assert_eq!((rig.time_s.len(), rig.lines[9]), (199, 11));
        assert_eq!(
            (rig.displacement_m[49], rig.force_n[49]),
            (2.0 * sample(50).0, 3.0 * sample(50).1)
        );
        assert_eq!(rig.repairs, ["1 cycles without a fresh measurement left out"]);
        assert!(read_record(&path, 4).is_err());
        std::fs::remove_file(path).unwrap();
    }
}
