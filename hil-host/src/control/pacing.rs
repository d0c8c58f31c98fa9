//! Cycle after cycle: who sets the pace, and how a session ends.

use super::buses::Buses;
use super::session::{Session, SessionState};
use crate::bus::Bus;
use crate::clock::{Pacer, Tick};
use can_protocol::{Pace as WirePace, RunState};
use firmware_core::supervision::Signal;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Who sets the pace.
#[derive(Debug, Clone, PartialEq)]
pub enum Pace {
    /// Absolute deadlines; missed ticks are skipped and counted.
    Realtime(Pacer),
    /// The next cycle comes when every rig has echoed this one.
    LockStep,
    /// Nothing waits.
    Fast,
}

impl Pace {
    /// What the rigs are given: without a clock a command is a cycle.
    pub const fn on_the_wire(&self) -> WirePace {
        match self {
            Self::Realtime(_) => WirePace::Clock,
            Self::LockStep | Self::Fast => WirePace::LockStep,
        }
    }
}

/// A peer that is silent for this long in lock-step is lost.
pub const SILENCE: Duration = Duration::from_secs(1);

/// Cycles of the safe stop before the session ends.
pub const STOP_CYCLES: u64 = 200;

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// All cycles were run.
    Completed,
    /// The user interrupted it, or the record could not be kept.
    Stopped,
    /// A guard tripped or a peer was lost: the rigs were brought to rest.
    Safe,
}

impl End {
    /// The word for it, as `summary.json` has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Stopped => "stopped",
            Self::Safe => "safe",
        }
    }
}

impl Session<'_> {
    /// Runs until the cycles are done, the user stops it, the record cannot be kept, or the safe
    /// state has been reached.
    pub fn run<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        cycles: u64,
        stop: &AtomicBool,
    ) -> End {
        debug_assert_eq!(self.pace, pace.on_the_wire(), "the rigs were given another pace");
        buses.recorder().may_wait = !matches!(pace, Pace::Realtime(_));
        if let Pace::Realtime(pacer) = pace {
            pacer.restart();
        }
        let mut safe_since = None;
        let mut tick = Tick::default();
        let end = loop {
            let row = self.cycle(state, buses, tick);
            buses.recorder().row(row);
            if state.line.safe && safe_since.is_none() {
                safe_since = Some(state.line.cycle);
            }
            match safe_since {
                Some(since) if state.line.cycle >= since + STOP_CYCLES => break End::Safe,
                None if state.line.cycle >= cycles => break End::Completed,
                None if stop.load(Ordering::Relaxed) || buses.recorder().is_overrun() => {
                    break End::Stopped;
                }
                Some(_) | None => {}
            }
            tick = self.wait(state, buses, pace);
        };
        self.close(state, buses, end);
        end
    }

    /// Waits for the next cycle, in the way of the pace.
    fn wait<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
    ) -> Tick {
        match pace {
            Pace::Realtime(pacer) => {
                let tick = pacer.wait();
                state.skipped += tick.skipped;
                tick
            }
            Pace::LockStep if !state.line.safe => {
                if !self.wait_for_echoes(state, buses) {
                    let mut ports = self.ports.iter().zip(&state.ports);
                    let silent = ports.find(|(port, memory)| !port.has_echo(memory));
                    let node = silent.map(|(port, _)| port.node.number());
                    self.stop(state, node, Self::fact(Signal::SilentRig));
                }
                Tick::default()
            }
            Pace::LockStep | Pace::Fast => Tick::default(),
        }
    }

    /// Waits until every rig has answered the last command; false when one stays silent.
    fn wait_for_echoes<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
    ) -> bool {
        let since = Instant::now();
        loop {
            // Read before the buses: a host that was suspended first takes in what has arrived.
            let late = since.elapsed() > SILENCE;
            self.receive(state, buses);
            let mut ports = self.ports.iter().zip(&state.ports);
            let Some((waiting, _)) = ports.rfind(|(port, memory)| !port.has_echo(memory)) else {
                return true;
            };
            if late {
                return false;
            }
            buses.wait(waiting.bus, SILENCE);
        }
    }

    /// Ends the run for the rigs, and takes in what is still on the way.
    fn close<B: Bus>(&self, state: &mut SessionState, buses: &mut Buses<'_, '_, B>, end: End) {
        if end != End::Safe {
            self.wait_for_echoes(state, buses);
        }
        let run = if end == End::Safe { RunState::Safe } else { RunState::Standby };
        let time_us = self.time_us(state);
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let mut still = state.line.slots[port.slot].command;
            still.velocity_m_per_s = 0.0;
            let frame = port.command(memory, &still, run, time_us);
            // It ends the run and is no cycle.
            memory.commands -= 1;
            buses.send(port.bus, &frame);
        }
    }
}
