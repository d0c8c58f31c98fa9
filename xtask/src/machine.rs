//! A throw-away machine that has CAN, for a kernel that has none.
//!
//! Its kernel comes from a Debian package that is only unpacked; its file system is this
//! machine's own, so nothing is packed or copied and programs run from where they were built.
//! One script is its first process: it makes CAN available, runs the tests, says their exit
//! status on the console and powers off.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::run::Run;
use crate::stream::Ended;

/// Said on the console once CAN works; before it a failure is the machine's, not the tests'.
const READY: &str = "machine: CAN is up";
/// Said on the console before power-off, with the exit status.
const STATUS: &str = "machine: exit status ";
/// Kernel modules for raw CAN sockets on virtual interfaces.
pub(crate) const CAN_MODULES: [&str; 3] = ["can", "can-raw", "vcan"];

/// A machine that can be started once.
pub(crate) struct Machine {
    pub(crate) name: &'static str,
    /// Starts it; the script is its first process and its console is the command's output.
    pub(crate) start: Command,
    /// Modules that the script has to insert.
    pub(crate) modules: Vec<PathBuf>,
    /// How much slower than real time a paced run holds comfortably, for 1 ms periods.
    pub(crate) slow_down: u32,
    pub(crate) limit: Duration,
}

/// What the machine shall do.
pub(crate) struct Job {
    /// Test programs, run one after the other.
    pub(crate) programs: Vec<PathBuf>,
    /// Given to each of them.
    pub(crate) arguments: Vec<String>,
    pub(crate) environment: Vec<(String, OsString)>,
    /// Put before the search path.
    pub(crate) tools: Vec<PathBuf>,
    pub(crate) busybox: PathBuf,
}

/// How it went.
pub(crate) enum Verdict {
    /// The largest exit status of the programs.
    Tests(i32),
    TimedOut(Duration),
    /// The machine failed, not the tests; the reason.
    MachineFailed(String),
}

/// Starts the machine, shows its console and gives back what the tests came to.
pub(crate) fn run(run: &mut Run, mut machine: Machine, job: &Job, script: &Path) -> Verdict {
    use std::os::unix::fs::PermissionsExt;

    let text = first_process(&machine, job, &run.root);
    let written = std::fs::write(script, text)
        .and_then(|()| std::fs::set_permissions(script, std::fs::Permissions::from_mode(0o755)));
    if let Err(error) = written {
        return Verdict::MachineFailed(format!("{}: {error}", script.display()));
    }
    let (mut ready, mut status) = (false, None);
    let ended = run.watched(&mut machine.start, Some(machine.limit), |line| {
        ready |= line.ends_with(READY);
        status = status.or_else(|| line.strip_prefix(STATUS)?.parse().ok());
    });
    match (ended, status) {
        (_, Some(status)) => Verdict::Tests(status),
        (Ok(Ended::TimedOut(limit)), None) if ready => Verdict::TimedOut(limit),
        (Ok(ended), None) if ready => {
            Verdict::MachineFailed(format!("ended amid the tests, {ended}"))
        }
        (Ok(ended), None) => Verdict::MachineFailed(format!("did not come up, {ended}")),
        (Err(error), None) => Verdict::MachineFailed(error.to_string()),
    }
}

/// The script: POSIX shell, since the first process has nothing but this machine's `/bin/sh`.
fn first_process(machine: &Machine, job: &Job, root: &Path) -> String {
    use std::fmt::Write as _;

    let busybox = quoted(&job.busybox.to_string_lossy());
    let mut path = String::new();
    for folder in &job.tools {
        let _ = write!(path, "{}:", folder.display());
    }
    path += "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin";
    let mut text = format!(
        "#!/bin/sh\n\
         # Written by cargo xtask: the first process of a throw-away machine, of use nowhere else.\n\
         [ $$ = 1 ] || exit 2\n\
         export PATH={} HOME=/root\n\
         mount -t proc proc /proc\n\
         mount -t sysfs sys /sys\n\
         mount -t tmpfs tmpfs /run\n\
         [ -c /dev/console ] && [ -c /dev/urandom ] || mount -t devtmpfs dev /dev\n\
         exec </dev/null >/dev/console 2>&1\n\
         mkdir -p /dev/shm && mount -t tmpfs tmpfs /dev/shm\n",
        quoted(&path)
    );
    for module in &machine.modules {
        let _ = writeln!(text, "{busybox} insmod {}", quoted(&module.to_string_lossy()));
    }
    let _ = writeln!(text, "ip link set lo up");
    let probe = "ip link add probe type vcan && ip link del probe";
    let _ = writeln!(text, "{probe} && echo '{READY}' || {busybox} poweroff -f");
    let _ = writeln!(text, "cd {}", quoted(&root.to_string_lossy()));
    // Its process numbers repeat from start to start, and the names of folders come from them.
    let _ = writeln!(text, "mkdir /run/tmp && export TMPDIR=/run/tmp");
    let _ = writeln!(text, "export VCAN_SLOW_DOWN={}", machine.slow_down);
    for (name, value) in &job.environment {
        let _ = writeln!(text, "export {name}={}", quoted(&value.to_string_lossy()));
    }
    let _ = writeln!(text, "worst=0");
    let arguments: Vec<_> = job.arguments.iter().map(|word| quoted(word)).collect();
    for program in &job.programs {
        let program = quoted(&program.to_string_lossy());
        let _ = writeln!(text, "echo; echo Running {program}");
        let _ = writeln!(text, "{program} {} || worst=$?", arguments.join(" "));
    }
    let _ = writeln!(text, "echo \"{STATUS}$worst\"");
    let _ = writeln!(text, "sync\n{busybox} poweroff -f");
    text
}

/// A word for a shell.
pub(crate) fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}
