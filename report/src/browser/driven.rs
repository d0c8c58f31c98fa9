//! A headless browser on a page that changes, driven by scripts.
//!
//! Chromium takes commands over a pipe (`--remote-debugging-pipe`): JSON, with a zero byte behind
//! each message, read from file descriptor 3 and answered on 4.

use super::{FLAGS, PATIENCE, Scratch, installed};
use serde_json::{Value, json};
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Time until a page is asked again whether it is there.
const GLANCE: Duration = Duration::from_millis(20);

/// Gives a program its standard input as descriptor 3 and its standard output as 4.
const WITH_PIPES: &str = r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#;

/// A browser that shows a page until it is dropped.
#[derive(Debug)]
pub struct Driven {
    child: Child,
    to: ChildStdin,
    messages: Receiver<Value>,
    session: Option<String>,
    calls: u64,
    _profile: Scratch,
}

impl Driven {
    /// Visits an address of this machine, in a window of this size.
    ///
    /// Without a Chromium it returns `None`, as [`open`](super::open) does.
    ///
    /// # Errors
    /// No browser where one is required; a browser that does not start or does not answer.
    pub fn visit(address: &str, (width, height): (u32, u32)) -> io::Result<Option<Self>> {
        let Some(browser) = installed()? else { return Ok(None) };
        let profile = Scratch::new()?;
        let mut child = Command::new("sh")
            .args(["-c", WITH_PIPES])
            .arg(browser)
            .args(FLAGS)
            .arg("--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1")
            .arg(format!("--user-data-dir={}", profile.0.display()))
            .arg(format!("--window-size={width},{height}"))
            .arg("--remote-debugging-pipe")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let (to, from) = (child.stdin.take(), child.stdout.take());
        let (Some(to), Some(from)) = (to, from) else {
            return Err(io::Error::other("no pipes to the browser"));
        };
        let (sender, messages) = channel();
        thread::spawn(move || receive(from, &sender));
        let (session, calls) = (None, 0);
        let mut driven = Self { child, to, messages, session, calls, _profile: profile };
        let target = driven.call("Target.createTarget", &json!({"url": address}))?;
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let attached = driven.call("Target.attachToTarget", &attach)?;
        driven.session = attached["sessionId"].as_str().map(str::to_owned);
        let is_there = "location.href !== 'about:blank' && document.readyState === 'complete'";
        // The page takes the place of an empty one, and its scripts with it.
        let begin = Instant::now();
        while let Err(why) = driven.wait_until(is_there) {
            if begin.elapsed() > PATIENCE || !why.to_string().contains("context") {
                return Err(why);
            }
            thread::sleep(GLANCE);
        }
        Ok(Some(driven))
    }

    /// The value of a script in the page; of a promise, what it gives.
    ///
    /// # Errors
    /// A script that fails, a browser that does not answer.
    pub fn evaluate(&mut self, script: &str) -> io::Result<Value> {
        let params = json!({"expression": script, "awaitPromise": true, "returnByValue": true});
        let mut answer = self.call("Runtime.evaluate", &params)?;
        if !answer["exceptionDetails"].is_null() {
            return Err(io::Error::other(answer["exceptionDetails"].to_string()));
        }
        Ok(answer["result"]["value"].take())
    }

    /// Waits until a condition in the page is true.
    ///
    /// # Errors
    /// As [`Driven::evaluate`].
    pub fn wait_until(&mut self, condition: &str) -> io::Result<()> {
        let script = format!(
            "new Promise((done) => {{\
               const look = () => ({condition}) ? done(true) : setTimeout(look, 20);\
               look();\
             }})"
        );
        self.evaluate(&script).map(|_| ())
    }

    /// Sends a command and waits for its answer; what else the browser says is passed over.
    fn call(&mut self, method: &str, params: &Value) -> io::Result<Value> {
        self.calls += 1;
        let mut message = json!({"id": self.calls, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes())?;
        loop {
            let timeout = |_| io::Error::new(io::ErrorKind::TimedOut, method.to_owned());
            let mut answer = self.messages.recv_timeout(PATIENCE).map_err(timeout)?;
            if answer["id"] != self.calls {
                continue;
            }
            if !answer["error"].is_null() {
                return Err(io::Error::other(format!("{method}: {}", answer["error"])));
            }
            return Ok(answer["result"].take());
        }
    }
}

impl Drop for Driven {
    fn drop(&mut self) {
        // One that has ended already needs no end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Hands on the messages of the browser until it ends.
fn receive(from: ChildStdout, to: &Sender<Value>) {
    let mut from = BufReader::new(from);
    let mut message = Vec::new();
    while from.read_until(0, &mut message).is_ok_and(|count| count > 0) {
        message.pop();
        let Ok(value) = serde_json::from_slice(&message) else { return };
        if to.send(value).is_err() {
            return;
        }
        message.clear();
    }
}
