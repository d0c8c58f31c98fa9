//! What Linux can do so that a cycle is on time, asked for one by one.
//!
//! 1. `SCHED_FIFO` with a priority: no ordinary process runs before the loop. Under `PREEMPT_RT`
//!    the interrupt threads have priority 50; the CAN interrupt belongs above the loop or on its
//!    own processor.
//! 2. `mlockall`: no page of the loop is fetched from disk.
//! 3. The stack is touched once in advance, so that no page of it is missing in the loop.
//! 4. Affinity: the loop stays on one processor, best an isolated one.
//! 5. `/dev/cpu_dma_latency` is held open with 0: the processor sleeps only as deep as it wakes at
//!    once.
//!
//! Each is optional and answers with a line; none is fatal here. All of it applies to the calling
//! thread (1, 3, 4) or the process (2, 5) and stays until they end. Threads that the caller starts
//! afterwards do not inherit its priority, but they do inherit its processor: start them before. On
//! a kernel without `PREEMPT_RT`, or inside a virtual machine, all five can be granted and a cycle
//! still be late by milliseconds: only the measured lateness shows it.
//!
//! The one `unsafe` call of this crate is here.

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_setaffinity};
use std::fs::File;
use std::io::Write;
use std::sync::OnceLock;

/// What to ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct RealtimeOptions {
    /// `SCHED_FIFO` priority, 1 to 99.
    pub fifo_priority: Option<u8>,
    /// Whether to lock all memory.
    pub lock_memory: bool,
    /// Whether to touch [`STACK_BYTES`] of the stack.
    pub prefault_stack: bool,
    /// The processor to stay on.
    pub cpu: Option<usize>,
    /// Whether to keep the processors from sleeping deeply.
    pub dma_latency: bool,
    /// Whether the caller wants to fail unless all was granted.
    pub require: bool,
}

impl Default for RealtimeOptions {
    /// Everything except a processor of its own; nothing is required.
    fn default() -> Self {
        Self {
            fifo_priority: Some(80),
            lock_memory: true,
            prefault_stack: true,
            cpu: None,
            dma_latency: true,
            require: false,
        }
    }
}

impl RealtimeOptions {
    /// Ask for nothing.
    pub const NONE: Self = Self {
        fifo_priority: None,
        lock_memory: false,
        prefault_stack: false,
        cpu: None,
        dma_latency: false,
        require: false,
    };
}

/// Stack that is touched in advance, in bytes: far more than a cycle uses, far less than the 8 MiB
/// of a main thread or the 2 MiB of another.
pub const STACK_BYTES: usize = 512 * 1024;

/// What was granted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RealtimeReport {
    steps: Vec<Step>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Step {
    what: String,
    /// Why not, when it was refused.
    refused: Option<String>,
}

impl RealtimeReport {
    /// Whether everything that was asked for was granted.
    pub fn complete(&self) -> bool {
        self.steps.iter().all(|step| step.refused.is_none())
    }

    /// One line for each thing that was asked for: `memory locked: done`, or why not and what
    /// helps.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.steps.iter().map(|Step { what, refused }| match refused {
            None => format!("{what}: done"),
            Some(why) => format!("{what}: {why}"),
        })
    }

    fn note(&mut self, what: impl Into<String>, result: std::io::Result<()>, advice: &str) {
        let refused = result.err().map(|error| format!("refused ({error}); {advice}"));
        self.steps.push(Step { what: what.into(), refused });
    }
}

/// Asks for what the options name, for the calling thread and its process.
///
/// ```
/// use hil_host::realtime::{RealtimeOptions, set_up};
/// let report = set_up(&RealtimeOptions { prefault_stack: true, ..RealtimeOptions::NONE });
/// assert!(report.complete());
/// assert_eq!(report.lines().collect::<Vec<_>>(), ["512 KiB of stack touched: done"]);
/// ```
pub fn set_up(options: &RealtimeOptions) -> RealtimeReport {
    let mut report = RealtimeReport::default();
    if options.lock_memory {
        let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE;
        let locked = mlockall(flags).map_err(Into::into);
        report.note("memory locked", locked, "raise the limit memlock, or run as root");
    }
    if options.prefault_stack {
        touch_stack();
        report.note(format!("{} KiB of stack touched", STACK_BYTES / 1024), Ok(()), "");
    }
    if let Some(cpu) = options.cpu {
        let advice = "there is no such processor, or this process may not use it";
        report.note(format!("kept on processor {cpu}"), keep_on(cpu), advice);
    }
    if options.dma_latency {
        let held = hold_dma_latency();
        let advice = "allow this user to write /dev/cpu_dma_latency, or run as root";
        report.note("processors kept awake", held, advice);
    }
    // Last: nothing above needs precedence over the rest of the machine.
    if let Some(priority) = options.fifo_priority {
        let advice = "raise the limit rtprio, or run as root";
        report.note(format!("SCHED_FIFO {priority}"), fifo(priority), advice);
    }
    report
}

#[allow(unsafe_code, reason = "no safe wrapper of sched_setscheduler is among the libraries")]
fn fifo(priority: u8) -> std::io::Result<()> {
    let parameters = libc::sched_param { sched_priority: libc::c_int::from(priority) };
    // A thread that this one starts is an ordinary one again.
    let policy = libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK;
    // SAFETY: `parameters` is initialised and outlives the call, which only reads it; 0 names the
    // calling thread. The kernel checks policy and priority.
    let result = unsafe { libc::sched_setscheduler(0, policy, &raw const parameters) };
    if result == 0 { Ok(()) } else { Err(std::io::Error::last_os_error()) }
}

/// Writes one byte into every page of a large frame; `black_box` keeps the compiler from seeing
/// that they are never read.
#[inline(never)]
#[expect(clippy::large_stack_arrays, reason = "a large frame is the point")]
fn touch_stack() {
    const PAGE_BYTES: usize = 4096;
    let mut frame = [0_u8; STACK_BYTES];
    for byte in frame.iter_mut().step_by(PAGE_BYTES) {
        *byte = 1;
    }
    std::hint::black_box(&mut frame);
}

fn keep_on(cpu: usize) -> std::io::Result<()> {
    if cpu >= CpuSet::MAX_CPU {
        return Err(std::io::Error::from(std::io::ErrorKind::InvalidInput));
    }
    let mut set = CpuSet::new();
    set.set(cpu);
    sched_setaffinity(None, &set).map_err(Into::into)
}

/// The request holds as long as the file is open: as long as the process lives.
fn hold_dma_latency() -> std::io::Result<()> {
    static HELD: OnceLock<File> = OnceLock::new();
    if HELD.get().is_none() {
        let mut file = File::options().write(true).open("/dev/cpu_dma_latency")?;
        file.write_all(&0_i32.to_ne_bytes())?;
        // A second thread that was quicker holds the same request.
        let _already_held = HELD.set(file);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_asked_is_nothing_missing() {
        let report = set_up(&RealtimeOptions::NONE);
        assert!(report.complete());
        assert_eq!(report.lines().count(), 0);
    }

    #[test]
    fn a_refusal_has_its_line_and_says_what_helps() {
        // No kernel has this many processors, whatever the caller's rights.
        let options = RealtimeOptions { cpu: Some(1_000_000), ..RealtimeOptions::NONE };
        let report = set_up(&options);
        assert!(!report.complete());
        let line = report.lines().next().unwrap();
        assert!(line.starts_with("kept on processor 1000000: refused ("), "{line}");
        assert!(line.ends_with("there is no such processor, or this process may not use it"));
    }

    #[test]
    fn what_is_granted_is_really_in_force() {
        // In a thread of its own: priority and affinity end with it. The memory lock would stay.
        std::thread::spawn(|| {
            let all = RealtimeOptions { cpu: Some(0), lock_memory: false, ..<_>::default() };
            let report = set_up(&all);
            assert_eq!(report.lines().count(), 4);
            let granted = |what: &str| {
                let line = report.lines().find(|line| line.starts_with(what)).unwrap();
                line.ends_with(": done")
            };
            let set = rustix::thread::sched_getaffinity(None).unwrap();
            assert_eq!(granted("kept on"), set.count() == 1 && set.is_set(0));
            let policy = scheduling_policy();
            assert_eq!(granted("SCHED_FIFO"), policy == "1", "policy {policy}");
            // A recorder or a printer that is started now must not run in front of the machine.
            assert_eq!(std::thread::spawn(scheduling_policy).join().unwrap(), "0");
        })
        .join()
        .unwrap();
    }

    /// Field 41 of `/proc/thread-self/stat`; the fields are counted behind the bracketed name.
    fn scheduling_policy() -> String {
        let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
        let behind_name = stat.rsplit_once(')').unwrap().1;
        behind_name.split_whitespace().nth(38).unwrap().to_owned()
    }
}
