//! What a power cut leaves of a record: an emulated machine with a disk of its own is killed while
//! it records.
//!
//! The machine is User Mode Linux with an ext4 file system in a file. `yawbench run` writes there,
//! and the machine's console shows again and again how many bytes of the record have been written.
//! After a drawn time the whole machine gets SIGKILL: what its kernel had not handed to the disk is
//! gone. The journal is then replayed (`e2fsck`), the folder of the run copied out (`debugfs`), and
//! checked:
//!
//! - the number of rows in the header is at most the whole rows in the file, and every one of them
//!   is the row of its cycle: `numpy.load` reads the file;
//! - these rows reach to at most two seconds of wall time before the kill;
//! - `yawbench report` makes the report of what is there.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::machine::quoted;
use crate::run::{Outcome, Run};
use crate::stream::quiet;
use crate::{debian, uml, vcan};

/// Rows may be lost for so long before a kill.
const LOST_MAX: Duration = Duration::from_secs(2);
/// Size of the disk, of which the machine uses little: a run of its length has to find room.
const DISK_BYTES: u64 = 1_000_000_000;
/// A run begins within this time of the machine's start.
const PATIENCE: Duration = Duration::from_secs(120);
/// On the console before the bytes of the record.
const BYTES: &str = "machine: bytes ";

/// How many kills, and from which seed their times are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cuts {
    pub(crate) kills: u64,
    pub(crate) seed: u64,
}

impl Cuts {
    /// From the words of the command line; none where they say something else.
    pub(crate) fn parse(words: &[&str]) -> Option<Self> {
        let seed = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |now| now.as_secs());
        let mut cuts = Self { kills: 5, seed };
        for pair in words.chunks(2) {
            match pair {
                ["--kills", number] => cuts.kills = number.parse().ok()?,
                ["--seed", number] => cuts.seed = number.parse().ok()?,
                _ => return None,
            }
        }
        Some(cuts)
    }
}

/// Kills the machine again and again.
pub(crate) fn test(run: &mut Run, cuts: Cuts) -> Outcome {
    // One that is built already, as the tests take it.
    let yawbench = std::env::var_os("YAWBENCH_BIN").map(PathBuf::from);
    if yawbench.is_none() {
        let mut cargo = run.cargo();
        let built = run.checked(cargo.args(["build", "--bin", "yawbench"]));
        if !matches!(built, Outcome::Passed) {
            return built;
        }
    }
    let yawbench = yawbench.unwrap_or_else(|| run.target.join("debug/yawbench"));
    let bench = match Bench::prepare(run, yawbench) {
        Ok(bench) => bench,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_POWER_CUT", reason),
    };
    let mut drawn = cuts.seed;
    let mut all = Outcome::Passed;
    for kill in 1..=cuts.kills {
        // 1 to 9 s, by a linear congruential generator.
        drawn =
            drawn.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let after = Duration::from_millis(1000 + (drawn >> 33) % 8000);
        let label = format!("kill {kill} of {} (seed {})", cuts.kills, cuts.seed);
        match bench.cut(after) {
            Ok(line) => println!("{label}: {line}"),
            Err(reason) => {
                println!("{label}: FAILED: {reason}");
                all = all.and(Outcome::Failed(format!("kill {kill}: {reason}")));
            }
        }
    }
    all
}

/// Everything that a kill needs.
struct Bench {
    root: PathBuf,
    folder: PathBuf,
    uml: PathBuf,
    busybox: PathBuf,
    yawbench: PathBuf,
    mkfs: PathBuf,
    e2fsck: PathBuf,
    debugfs: PathBuf,
}

impl Bench {
    fn prepare(run: &Run, yawbench: PathBuf) -> Result<Self, String> {
        let folder = run.target.join("power-cut");
        fs::create_dir_all(&folder).map_err(|why| format!("{}: {why}", folder.display()))?;
        let tool = |name| debian::ensure(name, &["e2fsprogs"]);
        let bench = Self {
            root: run.root.clone(),
            uml: run.target.join("vcan/uml"),
            busybox: vcan::busybox(run)?,
            yawbench,
            mkfs: tool("mkfs.ext4")?,
            e2fsck: tool("e2fsck")?,
            debugfs: tool("debugfs")?,
            folder,
        };
        uml::prepare(&bench.uml, &bench.script()).map(|_| bench)
    }

    fn script(&self) -> PathBuf {
        self.folder.join("first-process.sh")
    }

    fn disk(&self) -> PathBuf {
        self.folder.join("disk")
    }

    /// Kills a machine that has recorded for so long, and checks what is there; one line about it.
    fn cut(&self, after: Duration) -> Result<String, String> {
        use std::os::unix::fs::PermissionsExt as _;

        let (disk, script) = (self.disk(), self.script());
        let failed = |why: std::io::Error| why.to_string();
        let _ = fs::remove_file(&disk);
        fs::File::create(&disk).and_then(|file| file.set_len(DISK_BYTES)).map_err(failed)?;
        quiet(Command::new(&self.mkfs).args(["-q", "-F"]).arg(&disk))?;
        fs::write(&script, self.first_process()).map_err(failed)?;
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).map_err(failed)?;
        let mut machine = uml::prepare(&self.uml, &script)?;
        machine.start.arg(format!("ubd0={}{}", uml::HOST, disk.display()));
        let (seen, killed) = kill(&mut machine.start, after)?;
        // 1 means that errors were corrected, which the replay of a journal is not.
        let checked = Command::new(&self.e2fsck).args(["-fy"]).arg(&disk).output();
        let code = checked.map_err(failed)?.status.code();
        if !matches!(code, Some(0 | 1)) {
            return Err(format!("e2fsck: exit status {code:?}"));
        }
        let copy = self.folder.join("copy");
        let _ = fs::remove_dir_all(&copy);
        fs::create_dir_all(&copy).map_err(failed)?;
        let request = format!("rdump /run \"{}\"", copy.display());
        quiet(Command::new(&self.debugfs).arg("-R").arg(request).arg(&disk))?;
        let folder = copy.join("run");
        let record = Held::of(&folder.join("record.npy"))?;
        let reached = seen.iter().rfind(|(_, bytes)| record.rows_in(*bytes) <= record.count);
        let lost = reached.or(seen.first()).map_or(Duration::MAX, |(at, _)| killed - *at);
        let report = Command::new(&self.yawbench).arg("report").arg(&folder).output();
        let report = report.map_err(failed)?;
        let written = seen.last().map_or(0, |(_, bytes)| record.rows_in(*bytes));
        let line = format!(
            "killed after {:.1} s and {written} rows; {} in the header, {} in the file; {:.2} s lost",
            after.as_secs_f64(),
            record.count,
            record.rows,
            lost.as_secs_f64()
        );
        match () {
            () if record.count > record.rows => Err(format!("{line}: more counted than there are")),
            () if lost > LOST_MAX => Err(format!("{line}: more than {LOST_MAX:?}")),
            () if !report.status.success() => {
                let why = String::from_utf8_lossy(&report.stderr);
                Err(format!("{line}: yawbench report: {}", why.trim()))
            }
            () => Ok(line),
        }
    }

    /// POSIX shell, as for the tests over `SocketCAN`.
    fn first_process(&self) -> String {
        let [busybox, root, yawbench] =
            [&self.busybox, &self.root, &self.yawbench].map(|path| quoted(&path.to_string_lossy()));
        let major = uml::DISK_MAJOR;
        format!(
            "#!/bin/sh\n\
             # Written by cargo xtask: the first process of a throw-away machine.\n\
             [ $$ = 1 ] || exit 2\n\
             export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root\n\
             mount -t proc proc /proc\n\
             mount -t sysfs sys /sys\n\
             mount -t tmpfs tmpfs /run\n\
             [ -c /dev/console ] && [ -c /dev/urandom ] || mount -t devtmpfs dev /dev\n\
             exec </dev/null >/dev/console 2>&1\n\
             mkdir -p /run/disk\n\
             {busybox} mknod /run/ubda b {major} 0\n\
             {busybox} mount -t ext4 /run/ubda /run/disk || {busybox} poweroff -f\n\
             cd {root}\n\
             {yawbench} run scenarios/ss9-160kmh.toml --pace fast \\\n\
             --fifo-priority 0 --duration 600 --out /run/disk/run >/run/said 2>&1 &\n\
             while kill -0 $! 2>/dev/null; do\n\
             size=$({busybox} stat -c %s /run/disk/run/record.npy 2>/dev/null) &&\n\
             echo \"{BYTES}$size\"\n\
             {busybox} usleep 50000\n\
             done\n\
             tail -n 3 /run/said\n\
             {busybox} poweroff -f\n"
        )
    }
}

/// Starts a machine and kills it when its record has grown for so long; gives how many bytes of the
/// record had been written when, and when it was killed.
fn kill(start: &mut Command, after: Duration) -> Result<(Vec<(Instant, u64)>, Instant), String> {
    start.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut machine = start.spawn().map_err(|why| why.to_string())?;
    let (keyboard, console) = (machine.stdin.take(), machine.stdout.take());
    let (sender, lines) = mpsc::channel();
    std::thread::spawn(move || {
        let console = console.into_iter().flat_map(|console| BufReader::new(console).split(b'\n'));
        for line in console.map_while(Result::ok) {
            if sender.send((Instant::now(), String::from_utf8_lossy(&line).into_owned())).is_err() {
                return;
            }
        }
    });
    let (mut seen, mut said) = (Vec::new(), Vec::new());
    let mut deadline = Instant::now() + PATIENCE;
    let ended = loop {
        let left = deadline.saturating_duration_since(Instant::now());
        match lines.recv_timeout(left) {
            Ok((at, line)) => {
                let line = line.trim();
                let bytes = line.strip_prefix(BYTES).and_then(|bytes| bytes.parse::<u64>().ok());
                let Some(bytes) = bytes else {
                    said.push(line.to_owned());
                    continue;
                };
                // The header comes before the rigs are armed.
                if bytes > 4096 {
                    if seen.is_empty() {
                        deadline = at + after;
                    }
                    seen.push((at, bytes));
                }
            }
            Err(RecvTimeoutError::Timeout) => break false,
            Err(RecvTimeoutError::Disconnected) => break true,
        }
    };
    let killed = Instant::now();
    machine.kill().and_then(|()| machine.wait()).map_err(|why| why.to_string())?;
    drop(keyboard);
    if ended || seen.is_empty() {
        return Err(format!("the machine did not record: {}", said.join(" | ")));
    }
    Ok((seen, killed))
}

/// A record as `numpy.load` sees it.
struct Held {
    /// Rows by the header.
    count: u64,
    /// Whole rows by the size of the file.
    rows: u64,
    start: u64,
    row: u64,
}

impl Held {
    /// Reads a record, and that every counted row is the one of its cycle.
    fn of(path: &Path) -> Result<Self, String> {
        let bytes = fs::read(path).map_err(|why| format!("{}: {why}", path.display()))?;
        let unreadable = || "the record has no header of NumPy's".to_owned();
        let length = bytes.get(8..10).ok_or_else(unreadable)?;
        let start = 10 + usize::from(u16::from_le_bytes([length[0], length[1]]));
        let header = bytes.get(10..start).ok_or_else(unreadable)?;
        let header = String::from_utf8_lossy(header);
        let row = row_bytes(&header).ok_or_else(unreadable)?;
        let (_, shape) = header.split_once("'shape': (").ok_or_else(unreadable)?;
        let count = shape.split(',').next().and_then(|count| count.trim().parse().ok());
        let count: usize = count.ok_or_else(unreadable)?;
        let rows = (bytes.len() - start) / row;
        for (number, row) in bytes[start..].chunks_exact(row).take(count).enumerate() {
            let cycle = row.first_chunk().map_or(0, |first| u64::from_le_bytes(*first));
            if cycle != number as u64 + 1 {
                return Err(format!("row {number} of {count} is that of cycle {cycle}"));
            }
        }
        let (count, rows, start, row) = (count as u64, rows as u64, start as u64, row as u64);
        Ok(Self { count, rows, start, row })
    }

    /// Whole rows in a file of so many bytes.
    fn rows_in(&self, bytes: u64) -> u64 {
        bytes.saturating_sub(self.start) / self.row
    }
}

/// Bytes of a row by the types in a header.
fn row_bytes(header: &str) -> Option<usize> {
    let (fields, _) = header.split_once('[')?.1.split_once(']')?;
    let mut sum = 0;
    for field in fields.split("('").skip(1) {
        let (_, kind) = field.split_once("', '")?;
        let (kind, shape) = kind.split_once('\'')?;
        let size: usize = kind.get(2..)?.parse().ok()?;
        let items = shape.split(['(', ')', ',']).filter_map(|n| n.trim().parse::<usize>().ok());
        sum += size * items.product::<usize>();
    }
    (sum > 0).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_as_long_as_their_types_say() {
        let header = "{'descr': [('cycle', '<u8'), ('state', '|u1'), ('x_m', '<f8', (4,)), \
                      ('frame', '|u1', (4, 16,))], 'fortran_order': False, 'shape': (3  ,), }";
        assert_eq!(row_bytes(header), Some(8 + 1 + 32 + 64));
    }

    #[test]
    fn kills_and_seed_are_read_and_other_words_refused() {
        assert_eq!(Cuts::parse(&["--seed", "7", "--kills", "2"]), Some(Cuts { kills: 2, seed: 7 }));
        assert_eq!(Cuts::parse(&["--kills"]), None);
        assert_eq!(Cuts::parse(&["--kills", "many"]), None);
        assert!(Cuts::parse(&[]).is_some_and(|cuts| cuts.kills == 5));
    }
}
