//! Runs a command, passes its lines on as they come, and reads the test counts out of them.

use std::fmt;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// How a command ended.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Ended {
    Status(i32),
    /// By a signal.
    Killed,
    /// It was ended because its time was up.
    TimedOut(Duration),
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Ended::Status(status) => write!(f, "exit status {status}"),
            Ended::Killed => f.write_str("killed by a signal"),
            Ended::TimedOut(limit) => write!(f, "not done after {} s", limit.as_secs()),
        }
    }
}

/// Runs the command and gives each of its lines to `see`, with whether it is an error's.
///
/// A standard input that the caller made a pipe stays open and empty until the end.
pub(crate) fn lines(
    command: &mut Command,
    limit: Option<Duration>,
    mut see: impl FnMut(&str, bool),
) -> std::io::Result<Ended> {
    let start = Instant::now();
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let keyboard = child.stdin.take();
    let (sender, lines) = mpsc::channel();
    if let Some(out) = child.stdout.take() {
        forward(out, false, sender.clone());
    }
    if let Some(err) = child.stderr.take() {
        forward(err, true, sender);
    }
    let mut timed_out = false;
    loop {
        let left = limit.map_or(Duration::MAX, |limit| limit.saturating_sub(start.elapsed()));
        match lines.recv_timeout(left.min(Duration::from_secs(3600))) {
            Ok((line, is_stderr)) => see(&line, is_stderr),
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) if left.is_zero() && !timed_out => {
                timed_out = true;
                child.kill()?;
                break;
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
    let status = child.wait()?;
    drop(keyboard);
    Ok(match (timed_out, limit, status.code()) {
        (true, Some(limit), _) => Ended::TimedOut(limit),
        (_, _, Some(code)) => Ended::Status(code),
        (_, _, None) => Ended::Killed,
    })
}

/// Sends the lines of one stream; a console's carriage returns go, odd bytes are replaced.
fn forward(stream: impl Read + Send + 'static, is_stderr: bool, lines: Sender<(String, bool)>) {
    std::thread::spawn(move || {
        let mut stream = BufReader::new(stream);
        let mut bytes = Vec::new();
        while stream.read_until(b'\n', &mut bytes).is_ok_and(|n| n > 0) {
            let line = String::from_utf8_lossy(&bytes).trim_end_matches(['\n', '\r']).to_owned();
            if lines.send((line, is_stderr)).is_err() {
                return;
            }
            bytes.clear();
        }
    });
}

/// Runs a command without showing its output; the last line of what it said is the error.
pub(crate) fn quiet(command: &mut Command) -> Result<String, String> {
    let shown = shown(command);
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{}: {error}", command.get_program().display()))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(text);
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let last = said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message");
    Err(format!("{shown}: {last}"))
}

/// The command's name and first arguments, for messages.
pub(crate) fn shown(command: &Command) -> String {
    let name = std::path::Path::new(command.get_program());
    let mut text = name.file_name().unwrap_or(name.as_os_str()).to_string_lossy().into_owned();
    let plain = |word: &&std::ffi::OsStr| !word.to_string_lossy().starts_with("Dir::");
    for word in command.get_args().filter(plain).take(3) {
        text.push(' ');
        text.push_str(&word.to_string_lossy());
    }
    text
}

/// What a test over SocketCAN says where `VCAN_ELSEWHERE=1` keeps it from running.
const ELSEWHERE: &str = "vcan: this test runs in a step of its own";

/// Sum of the closing lines of the test programs.
#[derive(Default)]
pub(crate) struct Tests {
    passed: u64,
    failed: u64,
    ignored: u64,
    /// Counted as passed by the harness, but run in another step.
    elsewhere: u64,
}

impl Tests {
    /// Reads one line; most change nothing.
    pub(crate) fn read(&mut self, line: &str) {
        if line.ends_with(ELSEWHERE) {
            self.elsewhere += 1;
        }
        let Some((_, counts)) = line.split_once("test result: ") else { return };
        let count = |word: &str| {
            let (before, _) = counts.split_once(&format!(" {word}"))?;
            before.rsplit(' ').next()?.parse::<u64>().ok()
        };
        self.passed += count("passed").unwrap_or(0);
        self.failed += count("failed").unwrap_or(0);
        self.ignored += count("ignored").unwrap_or(0);
    }

    pub(crate) fn any(&self) -> bool {
        self.passed + self.failed > 0
    }
}

impl fmt::Display for Tests {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let passed = self.passed.saturating_sub(self.elsewhere);
        write!(f, "tests: {passed} passed, {} failed", self.failed)?;
        if self.ignored > 0 { write!(f, ", {} skipped", self.ignored) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_add_up() {
        let mut tests = Tests::default();
        tests.read("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out");
        tests.read("\x1b[0mtest result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured");
        tests.read("test physics::result ... ok");
        tests.read("vcan: this test runs in a step of its own");
        assert_eq!(tests.to_string(), "tests: 14 passed, 2 failed, 1 skipped");
    }

    #[test]
    fn a_command_that_outlives_its_limit_is_ended() {
        let limit = Duration::from_millis(50);
        let mut cat = Command::new("cat");
        let ended = lines(cat.stdin(Stdio::piped()), Some(limit), |_, _| {}).unwrap();
        assert_eq!(ended, Ended::TimedOut(limit));
    }

    #[test]
    fn lines_arrive_without_carriage_return_and_the_status_comes_back() {
        let mut seen = Vec::new();
        let script = "printf 'one\\r\\ntwo'; exit 7";
        let mut sh = Command::new("sh");
        let ended = lines(sh.args(["-c", script]), None, |line, _| seen.push(line.to_owned()));
        assert_eq!(ended.unwrap(), Ended::Status(7));
        assert_eq!(seen, ["one", "two"]);
    }
}
