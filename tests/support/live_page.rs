//! A run with a page, as a browser sees it.

use super::command::{folder, repository, yawbench};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::{self, JoinHandle};

/// A run that serves a page.
pub(crate) struct ServedRun {
    child: Child,
    /// Host and port of the page.
    pub(crate) address: String,
    /// Its result folder.
    pub(crate) out: PathBuf,
    errors: Option<JoinHandle<String>>,
}

/// What a run came to.
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    /// What it said on standard error.
    pub(crate) errors: String,
    /// Its `summary.json`; null without one.
    pub(crate) summary: Value,
}

impl ServedRun {
    /// Begins a run of a scenario, with further options.
    pub(crate) fn begin(scenario: &Path, options: &[&str]) -> Self {
        let out = folder("served");
        let mut child = yawbench()
            .arg("run")
            .arg(scenario)
            .args(["--serve", "127.0.0.1:0", "--json", "--out"])
            .arg(&out)
            .args(options)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut errors = String::new();
        let address = loop {
            let begin = errors.len();
            assert!(stderr.read_line(&mut errors).unwrap() > 0, "no page: {errors}");
            if let Some(address) = errors[begin..].strip_prefix("page: http://") {
                break address.trim_end().trim_end_matches('/').to_owned();
            }
        };
        let rest = thread::spawn(move || {
            // A terminal that is taken away in between is not what is tested.
            let _ = stderr.read_to_string(&mut errors);
            errors
        });
        Self { child, address, out, errors: Some(rest) }
    }

    /// The same with the usual scenario.
    pub(crate) fn of_locomotive(options: &[&str]) -> Self {
        Self::begin(&repository().join("scenarios/ss9-160kmh.toml"), options)
    }

    /// The process.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// A connection.
    pub(crate) fn connect(&self) -> TcpStream {
        TcpStream::connect(&self.address).unwrap()
    }

    /// What is answered to some bytes: status and text.
    pub(crate) fn answer_to(&self, bytes: &[u8]) -> (u16, String) {
        let mut line = self.connect();
        // A server that has heard enough hangs up.
        let _ = line.write_all(bytes);
        let mut answer = Vec::new();
        let _ = line.read_to_end(&mut answer);
        let text = String::from_utf8_lossy(&answer).into_owned();
        let status = text.split(' ').nth(1).and_then(|status| status.parse().ok());
        (status.unwrap_or(0), text)
    }

    /// What is answered to a request with these header fields and its own host.
    pub(crate) fn ask(&self, line: &str, fields: &[(&str, &str)]) -> (u16, String) {
        let fields = fields.iter().map(|(name, value)| format!("{name}: {value}\r\n"));
        let fields: String = fields.collect();
        let text = format!("{line} HTTP/1.1\r\nHost: {}\r\n{fields}\r\n", self.address);
        self.answer_to(text.as_bytes())
    }

    /// The token that its page holds.
    pub(crate) fn token(&self) -> String {
        let (status, page) = self.ask("GET /", &[]);
        assert_eq!(status, 200);
        let rest = page.split("ramp-out-token\" content=\"").nth(1).unwrap();
        rest.split('"').next().unwrap().to_owned()
    }

    /// Presses the button, as its page does.
    pub(crate) fn press(&self) -> u16 {
        let (origin, token) = (format!("http://{}", self.address), self.token());
        let fields = [("Origin", origin.as_str()), ("X-Yawbench-Token", token.as_str())];
        self.ask("POST /ramp-out", &fields).0
    }

    /// The events from now on.
    pub(crate) fn events(&self) -> Events {
        let mut line = self.connect();
        write!(line, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", self.address).unwrap();
        Events(BufReader::new(line))
    }

    /// Waits for its end.
    pub(crate) fn finish(mut self) -> Outcome {
        let code = self.child.wait().unwrap().code();
        let errors = self.errors.take().unwrap().join().unwrap();
        let summary = std::fs::read_to_string(self.out.join("summary.json"));
        let summary = summary.map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
        Outcome { code, errors, summary }
    }
}

impl Drop for ServedRun {
    fn drop(&mut self) {
        // Of a test that has failed; one that has ended may have given its number away.
        if matches!(self.child.try_wait(), Ok(None)) {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
        let _ = std::fs::remove_dir_all(&self.out);
    }
}

/// The events of a page.
pub(crate) struct Events(BufReader<TcpStream>);

impl Iterator for Events {
    /// Name and content.
    type Item = (String, Value);

    fn next(&mut self) -> Option<(String, Value)> {
        let (mut name, mut line) = (String::new(), String::new());
        loop {
            line.clear();
            if self.0.read_line(&mut line).ok()? == 0 {
                return None;
            }
            if let Some(event) = line.strip_prefix("event: ") {
                event.trim_end().clone_into(&mut name);
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return Some((name, serde_json::from_str(data).unwrap()));
            }
        }
    }
}
