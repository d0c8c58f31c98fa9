//! The system calls of the loop's thread, with a page and without.
//!
//! The test traces that thread alone, as `strace` does, by `ptrace`: it is stopped at every system
//! call, and the number of the call is read. From the first tick of the clock to the last, each
//! cycle makes one call, the wait for its tick, in both cases. What this shows: whatever page,
//! browser and recorder do, the loop's thread asks the kernel for the same things as often as
//! without them; so it waits for no lock that somebody else holds (a futex), writes nothing and
//! starts nothing. What it does not show is the time that the processor and its caches lose to
//! other threads: `yawbench rtcheck --serve` measures that.

use crate::support::command::{folder, read, repository, yawbench};
use crate::support::live_page::ServedRun;
use nix::libc;
use nix::sys::ptrace;
use nix::sys::signal::Signal;
use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
use nix::unistd::Pid;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::Stdio;
use std::thread;

/// Long enough for thousands of cycles, of which a machine that is busy may skip some.
const DURATION: [&str; 2] = ["--duration", "1"];

/// Numbers of the calls of a process's first thread, in their order, until it ends. None where this
/// machine lets no process trace another one.
fn traced(process: u32) -> Option<Vec<i64>> {
    let thread = Pid::from_raw(process.cast_signed());
    if let Err(why) = ptrace::seize(thread, ptrace::Options::PTRACE_O_TRACESYSGOOD) {
        let required = std::env::var_os("REQUIRE_PTRACE").is_some_and(|value| value == "1");
        assert!(!required, "REQUIRE_PTRACE=1, but a process cannot be traced: {why}");
        let _ = writeln!(std::io::stderr(), "SKIPPED: no process can be traced here ({why})");
        return None;
    }
    ptrace::interrupt(thread).unwrap();
    let (mut calls, mut is_inside) = (Vec::new(), false);
    loop {
        let signal = match waitpid(thread, Some(WaitPidFlag::__WALL)).unwrap() {
            WaitStatus::PtraceSyscall(_) => {
                is_inside = !is_inside;
                if is_inside {
                    calls.push(number_of_call(process));
                }
                None
            }
            // A stop of the tracing itself hands over no signal.
            WaitStatus::Stopped(_, signal) => Some(signal).filter(|own| *own != Signal::SIGTRAP),
            WaitStatus::PtraceEvent(..) => None,
            WaitStatus::Exited(..) | WaitStatus::Signaled(..) => return Some(calls),
            other => panic!("{other:?}"),
        };
        ptrace::syscall(thread, signal).unwrap();
    }
}

/// The call in which a stopped thread is.
fn number_of_call(process: u32) -> i64 {
    let text = std::fs::read_to_string(format!("/proc/{process}/syscall")).unwrap();
    text.split(' ')
        .next()
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{text}"))
}

/// How often each call was made from the first tick of the clock to the last.
fn of_the_loop(calls: &[i64]) -> BTreeMap<i64, usize> {
    let is_tick = |call: &i64| *call == libc::SYS_clock_nanosleep;
    let first = calls.iter().position(is_tick).expect("a tick");
    let last = calls.iter().rposition(is_tick).expect("a tick");
    let mut counted = BTreeMap::new();
    for call in &calls[first..=last] {
        *counted.entry(*call).or_insert(0) += 1;
    }
    counted
}

/// One tick for every cycle of a run but the last, and nothing else.
fn a_tick_for_every_cycle(out: &Path) -> BTreeMap<i64, usize> {
    let summary: Value = serde_json::from_str(&read(&out.join("summary.json"))).unwrap();
    // A host that is stopped for each call may lose its rig on a busy machine: its cycles count.
    let cycles = summary["cycles"].as_u64().unwrap() as usize;
    println!("{cycles} cycles, {} ticks skipped, {}", summary["overruns"], summary["state"]);
    assert!(cycles > 50, "{cycles} cycles");
    BTreeMap::from([(libc::SYS_clock_nanosleep, cycles - 1)])
}

#[test]
fn the_loop_makes_the_same_system_calls_with_a_page_and_without() {
    let out = folder("traced");
    let mut child = yawbench()
        .arg("run")
        .arg(repository().join("scenarios/ss9-160kmh.toml"))
        .args(DURATION)
        .arg("--out")
        .arg(&out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let without = traced(child.id());
    // The trace has waited for its end already.
    let _ = child.wait();
    let Some(without) = without else { return };
    assert_eq!(of_the_loop(&without), a_tick_for_every_cycle(&out));
    std::fs::remove_dir_all(out).unwrap();

    let run = ServedRun::of_locomotive(&DURATION);
    // One browser reads, one asks for the events and never reads them, one says nothing.
    let events = run.events();
    let reader = thread::spawn(move || events.filter(|(name, _)| name == "now").count());
    let mut deaf = run.connect();
    write!(deaf, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", run.address).unwrap();
    let mute = run.connect();
    let with = traced(run.id()).expect("it was traced before");
    assert_eq!(of_the_loop(&with), a_tick_for_every_cycle(&run.out));
    assert!(reader.join().unwrap() > 2, "the page was not watched");
    let mut heard = [0; 15];
    deaf.read_exact(&mut heard).unwrap();
    assert_eq!(&heard, b"HTTP/1.1 200 OK");
    drop(mute);
}
