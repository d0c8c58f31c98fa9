//! A virtual CAN interface for one test, and can-utils on it.
//!
//! Needs a kernel with CAN and the right to make interfaces, or `VCAN_IFACE` naming one that is
//! up. Where there is neither, a test reports that it was skipped, or fails if `REQUIRE_VCAN=1`.

use std::ffi::OsStr;
use std::fs;
use std::io::Write as _;
use std::ops::Deref;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use socketcan::dump::Reader;
use socketcan::{CanAnyFrame, CanDataFrame, CanSocket, EmbeddedFrame, ExtendedId, Socket};

/// A CAN FD frame as the kernel hands it out, in bytes: the transfer unit that FD needs.
const FD_MTU: &str = "72";
/// For candump to come up or to write its log; it takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(20);
/// Tests of one program that share `VCAN_IFACE` take turns.
static SHARED: Mutex<()> = Mutex::new(());

/// A virtual CAN interface that is up and takes FD frames; one of our own is removed on drop.
pub(crate) struct Interface {
    name: String,
    shared: Option<MutexGuard<'static, ()>>,
}

/// An interface for this test alone, or `None` with the reason on standard error.
///
/// # Panics
///
/// If there is none and `REQUIRE_VCAN=1`.
pub(crate) fn interface() -> Option<Interface> {
    if is_one("VCAN_ELSEWHERE") {
        aloud("vcan: this test runs in a step of its own");
        return None;
    }
    if let Ok(name) = std::env::var("VCAN_IFACE") {
        let turn = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        return Some(Interface { name, shared: Some(turn) });
    }
    match make() {
        Ok(name) => Some(Interface { name, shared: None }),
        Err(reason) => {
            assert!(!is_one("REQUIRE_VCAN"), "REQUIRE_VCAN=1, but no vcan interface: {reason}");
            aloud(&format!(
                "SKIPPED: no vcan interface ({reason}); `cargo xtask vcan` brings a kernel with CAN"
            ));
            None
        }
    }
}

/// By how much a paced run with 1 ms periods has to be stretched on this machine.
pub(crate) fn slow_down() -> u32 {
    let named = std::env::var("VCAN_SLOW_DOWN").ok();
    named.map_or(1, |text| text.parse().expect("VCAN_SLOW_DOWN is a whole number"))
}

/// The `yawbench` command under test.
pub(crate) fn yawbench() -> Command {
    let here = std::env::var_os("YAWBENCH_BIN");
    Command::new(here.as_deref().unwrap_or(OsStr::new(env!("CARGO_BIN_EXE_yawbench"))))
}

/// Sends one frame in `cansend`'s spelling: `123#0011`, or `123##1` and data for FD with
/// bit-rate switch.
pub(crate) fn cansend(interface: &str, frame: &str) {
    said(Command::new("cansend").args([interface, frame])).expect("cansend");
}

/// `candump -l` on an interface, recording until [`Candump::stop`].
pub(crate) struct Candump {
    interface: String,
    process: Child,
    folder: PathBuf,
}

impl Candump {
    /// Returns once it listens: no frame sent after this is missed.
    pub(crate) fn start(interface: &Interface) -> Self {
        let folder = std::env::temp_dir().join(format!("candump-{}-{}", interface.name, unique()));
        fs::create_dir_all(&folder).expect("a folder for candump's log");
        let before = listeners(interface);
        // It names the log by the second and takes no other name: hence a folder of its own.
        let mut command = Command::new("candump");
        // A large receive buffer: on one processor it may wait its turn for long.
        command.args(["-r", "16777216", "-l", interface]).current_dir(&folder);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let process = command.spawn().expect("candump, from the package can-utils");
        wait_for("candump to listen", || listeners(interface) > before);
        Self { interface: interface.to_string(), process, folder }
    }

    /// Ends the recording; every frame sent before, in the order of the log.
    ///
    /// A signal would end candump with frames still in its queue. So marks are sent until the log
    /// shows one: every earlier frame is then in the file too.
    pub(crate) fn stop(self) -> Vec<CanAnyFrame> {
        let socket = CanSocket::open(&self.interface).expect("a CAN socket");
        let mark = CanDataFrame::new(ExtendedId::MAX, &[]).expect("an empty frame");
        let text = format!("{mark:X}");
        let mut log = String::new();
        wait_for("candump to write its log", || {
            // It writes in blocks of some hundred frames; a full queue only costs marks.
            (0..50).for_each(|_| drop(socket.write_frame(&mark)));
            log = self.log().unwrap_or_default();
            log.contains(&text)
        });
        let records = Reader::from_reader(log.as_bytes());
        let frames = records.map(|record| record.expect("a line of candump's log").frame);
        frames.take_while(|frame| format!("{frame:X}") != text).collect()
    }

    /// What it has written so far; it opens its log after it began to listen.
    fn log(&self) -> Option<String> {
        let file = fs::read_dir(&self.folder).ok()?.next()?.ok()?;
        fs::read_to_string(file.path()).ok()
    }
}

impl Drop for Candump {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl Deref for Interface {
    type Target = str;

    fn deref(&self) -> &str {
        &self.name
    }
}

impl AsRef<OsStr> for Interface {
    fn as_ref(&self) -> &OsStr {
        OsStr::new(&self.name)
    }
}

impl std::fmt::Display for Interface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

impl Drop for Interface {
    fn drop(&mut self) {
        if self.shared.is_none() {
            let _ = ip(&["link", "del", "dev", &self.name]);
        }
    }
}

fn make() -> Result<String, String> {
    let name = format!("yb{}", unique());
    ip(&["link", "add", "dev", &name, "type", "vcan"])?;
    ip(&["link", "set", "dev", &name, "mtu", FD_MTU, "up"])?;
    Ok(name)
}

fn ip(words: &[&str]) -> Result<Output, String> {
    said(Command::new("ip").args(words))
}

/// Distinct among all test programs that run side by side, and short: a name of an interface has
/// at most 15 characters.
fn unique() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("{:x}-{:x}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// Sockets that take every frame of the interface, as the kernel lists them.
fn listeners(interface: &Interface) -> usize {
    let list = fs::read_to_string("/proc/net/can/rcvlist_all").expect("the kernel's list");
    list.lines().filter(|line| line.split_whitespace().next() == Some(&interface.name)).count()
}

/// Waits for another process; a deadline turns a hang into a failure.
fn wait_for(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "waited {} s for {what}", PATIENCE.as_secs());
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn said(command: &mut Command) -> Result<Output, String> {
    let name = command.get_program().display().to_string();
    let output = command.stdin(Stdio::null()).output().map_err(|e| format!("{name}: {e}"))?;
    if output.status.success() {
        return Ok(output);
    }
    Err(format!("{name}: {}", String::from_utf8_lossy(&output.stderr).trim()))
}

fn is_one(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| value == "1")
}

/// Bypasses the test harness, which captures the output of a passing test.
pub(crate) fn aloud(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
