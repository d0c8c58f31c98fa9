//! The second run of a comparison: on the memory bus, as fast as it goes, in a thread of its own.

use crate::bus::MemoryBus;
use crate::columns::{Columns, ROWS_MAX};
use crate::control::{Pace, Slots};
use crate::record::{NpyWriter, Queues, ROWS};
use crate::rig::RigNode;
use crate::run::{BusChoice, rigs_of, session};
use anyhow::{Context, bail};
use can_protocol::Profile;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use scenario::run::Run;
use std::num::NonZeroU8;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What came out of it.
#[derive(Debug, Clone)]
pub struct SecondRun {
    /// What statistics and plots need.
    pub columns: Columns,
    /// Bodies whose accelerations were recorded: carbody, front bogie, first wheelset.
    pub watched: [Option<usize>; 3],
    /// Cycles done.
    pub cycles: u64,
    /// The trajectory hash.
    pub hash: u64,
    /// Whether the model left its track.
    pub safe: bool,
}

/// A run that takes longer shows how far it is.
const SILENT: Duration = Duration::from_secs(2);

impl SecondRun {
    /// Runs through a scenario, at most as far as statistics reach, and leaves its record; none if it
    /// was stopped.
    ///
    /// # Errors
    /// The record cannot be written.
    pub fn through(
        run: &Run,
        profile: Profile,
        cycles: u64,
        record: &Path,
        stop: &AtomicBool,
    ) -> anyhow::Result<Option<Self>> {
        // The thread of a control loop runs in front of the rest of the machine; one that it starts
        // is an ordinary one again.
        std::thread::scope(|scope| {
            let thread = scope.spawn(|| through(run, profile, cycles, record, stop));
            thread.join().map_err(|_| anyhow::anyhow!("the second run failed"))?
        })
    }
}

fn through(
    run: &Run,
    profile: Profile,
    cycles: u64,
    path: &Path,
    stop: &AtomicBool,
) -> anyhow::Result<Option<SecondRun>> {
    let name = || path.display().to_string();
    let cycles = cycles.min(ROWS_MAX as u64);
    let (_, rigs) = rigs_of(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &rigs, profile, NonZeroU8::MIN)?;
    let mut buses =
        vec![MemoryBus::new(rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, profile)))];
    let mut state = session.start(session.line.start(run.start.state.clone()));
    if session.greet(&state, &mut buses, &Pace::Fast, SILENT).is_err() {
        bail!("an emulated rig did not answer");
    }
    let mut queues = Queues::default();
    // Nobody keeps the frames of this bus.
    let (mut recorder, _frames) = queues.split();
    let mut record = NpyWriter::create(path).with_context(name)?;
    let mut columns = Columns::default();
    let mut rows = Vec::with_capacity(ROWS);
    let bar = ProgressBar::with_draw_target(Some(cycles), ProgressDrawTarget::hidden());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    bar.set_message("the same with the other damper");
    let begin = Instant::now();
    while state.line.cycle < cycles && !state.line.safe {
        if stop.load(Ordering::Relaxed) {
            drop(record);
            std::fs::remove_file(path).with_context(name)?;
            return Ok(None);
        }
        let row = session.cycle(
            &mut state,
            &mut buses,
            &Pace::Fast,
            &mut recorder,
            &begin,
            Slots::default(),
        );
        columns.push(&row);
        rows.push(row);
        if rows.len() == ROWS {
            record.write(&rows).with_context(name)?;
            rows.clear();
            if bar.is_hidden() && begin.elapsed() > SILENT {
                bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
            }
            bar.set_position(state.line.cycle);
        }
    }
    record.write(&rows).with_context(name)?;
    record.finish().with_context(name)?;
    bar.finish_and_clear();
    Ok(Some(SecondRun {
        columns,
        watched: session.watched,
        cycles: state.line.cycle,
        hash: state.hash,
        safe: state.line.safe,
    }))
}
