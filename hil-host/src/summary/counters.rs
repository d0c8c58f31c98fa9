//! What went wrong and did not end the run: every counter that is not zero.

use super::{DamperSummary, Summary};

impl Summary {
    /// Every counter of a fault that is not zero, in words; none where all went well.
    ///
    /// Measurements lost, frames damaged, repeated or out of sequence, commands late, cut or
    /// limited, ticks skipped, rows dropped, and what the bus itself dropped.
    pub fn counters(&self) -> Vec<String> {
        let (frames, bus) = (&self.frames, &self.bus_counters);
        let mut counters = vec![
            ("measurements lost".to_owned(), frames.lost),
            ("frames with a wrong CRC".to_owned(), frames.crc_errors),
            ("repeated".to_owned(), frames.repeated),
            ("out of sequence".to_owned(), frames.wrong_sequence),
            ("commands late".to_owned(), frames.late),
            ("ticks skipped".to_owned(), self.overruns),
            ("rows and frames not recorded".to_owned(), self.record_dropped),
            ("frames the bus did not send".to_owned(), bus.send_dropped),
            ("frames lost in its receive queue".to_owned(), bus.receive_dropped),
            ("error frames".to_owned(), bus.error_frames),
        ];
        for damper in &self.damper {
            let of = |what: &str| format!("{what} ({})", damper.name);
            let is_worn = damper.virtual_wear.is_some();
            counters.extend([
                (of("cycles without a measurement"), damper.stale_cycles.unwrap_or(0)),
                (of("commands cut"), damper.saturated_commands.unwrap_or(0)),
                (of("commands limited"), damper.limited_commands.filter(|_| !is_worn).unwrap_or(0)),
                (of("measurements with a flag"), damper.flagged_measurements.unwrap_or(0)),
            ]);
        }
        let counted = counters.into_iter().filter(|(_, count)| *count > 0);
        counted.map(|(what, count)| format!("{count} {what}")).collect()
    }

    /// Commands that limits changed on purpose, in words: no ram can follow a contact of wear in
    /// software, and the limits of `[motion]` round it.
    pub fn rounded_commands(&self) -> Vec<String> {
        let worn = self.damper.iter().filter(|damper| damper.virtual_wear.is_some());
        let rounded = worn.filter(|damper| damper.limited_commands.is_some_and(|count| count > 0));
        let words = |damper: &DamperSummary| {
            format!(
                "{} commands rounded at contacts of virtual_wear, on purpose ({})",
                damper.limited_commands.unwrap_or(0),
                damper.name
            )
        };
        rounded.map(words).collect()
    }
}
