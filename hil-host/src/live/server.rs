//! The thread of the page: it answers requests and hands the newest of the run to every stream.
//!
//! One thread waits for all connections at once (`poll`), so that no browser can keep it from
//! another one. Their number is bounded. Where it is reached, a new one takes the place of the
//! oldest that is no stream; and streams never take the last places, so that the button can always
//! be pressed.

use super::answer::{answer, event, refused, stream};
use super::assets::Assets;
use super::board::{Board, Phase, RunEnd, Update};
use super::connection::Connection;
use super::gate::{Gate, Wish};
use super::request::{Refusal, Request};
use crate::control::{Asker, Requests};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use serde::Serialize;
use std::net::{TcpListener, TcpStream};
use std::os::fd::AsFd as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Most connections.
const CONNECTIONS_MAX: usize = 8;

/// Most of them that are streams.
const STREAMS_MAX: usize = 5;

/// Time between two looks at the board (ms).
const GLANCE_MS: u8 = 25;

/// Time after which a page hears that it is connected, though nothing is new.
const SIGN_OF_LIFE: Duration = Duration::from_secs(1);

/// Time in which browsers may take what is left at the end.
const FAREWELL: Duration = Duration::from_secs(1);

/// What the thread of the page has.
#[derive(Debug)]
pub(super) struct Server {
    listener: TcpListener,
    gate: Gate,
    assets: Assets,
    board: Arc<Board>,
    requests: &'static Requests,
    connections: Vec<Connection<TcpStream>>,
    shown: Shown,
    /// When something was last sent to the streams.
    sent: Instant,
}

/// What was last sent to the page.
#[derive(Debug, Default, PartialEq)]
struct Shown {
    facts: bool,
    state: &'static str,
    note: &'static str,
    update: Option<Update>,
    end: Option<RunEnd>,
}

/// The event `now`.
#[derive(Serialize)]
struct Now<'a> {
    state: &'a str,
    note: &'a str,
    update: Option<&'a Update>,
    end: Option<&'a RunEnd>,
}

impl Server {
    pub(super) fn new(
        listener: TcpListener,
        gate: Gate,
        board: Arc<Board>,
        requests: &'static Requests,
    ) -> Self {
        let assets = Assets::new(gate.token());
        let (connections, shown, sent) = (Vec::new(), Shown::default(), Instant::now());
        let mut server = Self { listener, gate, assets, board, requests, connections, shown, sent };
        server.look();
        server
    }

    /// Serves until the board is closed and what it holds has been taken.
    pub(super) fn run(mut self) {
        let mut until: Option<Instant> = None;
        loop {
            // Read before the rest: what was put before is shown.
            if self.board.is_closing() {
                until.get_or_insert_with(|| Instant::now() + FAREWELL);
            }
            self.wait(until.is_none());
            let now = Instant::now();
            if until.is_none() {
                self.accept(now);
            }
            self.hear(now);
            self.tell(now);
            for connection in &mut self.connections {
                connection.write(now);
                connection.expire(now);
            }
            self.connections.retain(|connection| !connection.is_closed());
            let is_taken = self.connections.iter().all(Connection::is_taken);
            if until.is_some_and(|until| is_taken || now >= until) {
                return;
            }
        }
    }

    /// Waits for a browser, or for the next look at the board.
    fn wait(&self, is_open: bool) {
        let listener = is_open.then(|| PollFd::new(self.listener.as_fd(), PollFlags::POLLIN));
        let lines = self.connections.iter().map(|connection| {
            let write =
                if connection.is_writing() { PollFlags::POLLOUT } else { PollFlags::empty() };
            PollFd::new(connection.line().as_fd(), PollFlags::POLLIN | write)
        });
        let mut fds: Vec<PollFd<'_>> = lines.chain(listener).collect();
        // A signal ends the wait early, and nothing is lost.
        let _ = poll(&mut fds, PollTimeout::from(GLANCE_MS));
    }

    /// Takes in new connections.
    fn accept(&mut self, now: Instant) {
        // No more than can be kept: a flood of them is served in several rounds.
        for _ in 0..CONNECTIONS_MAX {
            // Nobody is there, or somebody has left again.
            let Ok((line, _)) = self.listener.accept() else { return };
            if line.set_nonblocking(true).is_err() {
                continue;
            }
            // Events are small and are to come at once.
            let _ = line.set_nodelay(true);
            if self.connections.len() == CONNECTIONS_MAX {
                // The oldest is the first; there are fewer streams than places.
                let oldest = self.connections.iter().position(|other| !other.is_stream());
                let Some(oldest) = oldest else { continue };
                self.connections.remove(oldest);
            }
            self.connections.push(Connection::new(line, now));
        }
    }

    /// Reads requests and begins their answers.
    fn hear(&mut self, now: Instant) {
        for at in 0..self.connections.len() {
            let asked = self.connections.get_mut(at).and_then(Connection::read);
            let Some(asked) = asked else { continue };
            let streams = self.connections.iter().filter(|other| other.is_stream()).count();
            let answer = asked.and_then(|request| self.respond(&request, streams));
            let Some(connection) = self.connections.get_mut(at) else { continue };
            match answer {
                Ok(Response::Whole(bytes)) => connection.answer(bytes, now),
                Ok(Response::Stream(bytes)) => connection.stream(bytes, now),
                Err(refusal) => connection.answer(refused(refusal), now),
            }
        }
    }

    fn respond(&self, request: &Request, streams: usize) -> Result<Response, Refusal> {
        let whole = |kind, body: &str| Ok(Response::Whole(answer(kind, body)));
        match self.gate.admit(request)? {
            Wish::Page => whole("text/html; charset=utf-8", &self.assets.page),
            Wish::Script => whole("text/javascript; charset=utf-8", self.assets.script),
            Wish::Style => whole("text/css; charset=utf-8", &self.assets.style),
            Wish::Events if streams >= STREAMS_MAX => {
                Err(Refusal::new(503, "this page is open too often: close it elsewhere"))
            }
            Wish::Events => {
                let mut bytes = stream();
                bytes.extend(self.facts());
                bytes.extend(self.now());
                Ok(Response::Stream(bytes))
            }
            Wish::RampOut => {
                self.requests.end(Asker::Page);
                whole("text/plain; charset=utf-8", "ramp-out is asked for\n")
            }
        }
    }

    /// Tells all streams what is new.
    fn tell(&mut self, now: Instant) {
        let is_new = self.look();
        let mut events = Vec::new();
        if self.board.facts().is_some() && !self.shown.facts {
            self.shown.facts = true;
            events.extend(self.facts());
        }
        if is_new || now.saturating_duration_since(self.sent) >= SIGN_OF_LIFE {
            events.extend(self.now());
            self.sent = now;
        }
        if !events.is_empty() {
            self.connections.iter_mut().for_each(|connection| connection.push(&events, now));
        }
        if self.connections.iter().any(Connection::is_behind) {
            let events = [self.facts(), self.now()].concat();
            let behind = self.connections.iter_mut().filter(|connection| connection.is_behind());
            behind.for_each(|connection| connection.push(&events, now));
        }
        // Each row is drawn once.
        if let Some(update) = &mut self.shown.update {
            update.samples.clear();
        }
    }

    /// Looks at the board; whether anything is new.
    fn look(&mut self) -> bool {
        let (update, end) = (self.board.take(), self.board.known_end());
        let shown = &mut self.shown;
        let is_new = update.is_some() || end != shown.end;
        shown.end = end;
        shown.update = update.or_else(|| shown.update.take());
        let before = match self.board.phase() {
            _ if self.requests.are_awaited() => {
                ("STANDBY", "the rigs are ready and wait to be armed: key a in the terminal")
            }
            Phase::Preparing => ("INIT", "the run is being prepared"),
            Phase::Meeting => ("INIT", "the rigs are being met"),
            Phase::Arming => ("STANDBY", "the rigs are being armed"),
        };
        let is_asked = self.requests.is_ending();
        let (state, note) = match &shown.update {
            _ if shown.end.is_some() => (shown.update.as_ref().map_or("", |now| now.state), ""),
            Some(now) if is_asked => (now.state, "the end of the run has been asked for"),
            Some(now) => (now.state, ""),
            None => before,
        };
        let is_other = (state, note) != (shown.state, shown.note);
        (shown.state, shown.note) = (state, note);
        is_new || is_other
    }

    fn facts(&self) -> Vec<u8> {
        let facts = self.board.facts().and_then(|facts| serde_json::to_string(facts).ok());
        facts.map_or_else(Vec::new, |json| event("facts", &json))
    }

    fn now(&self) -> Vec<u8> {
        let Shown { state, note, update, end, .. } = &self.shown;
        let now = Now { state, note, update: update.as_ref(), end: end.as_ref() };
        serde_json::to_string(&now).map_or_else(|_| Vec::new(), |json| event("now", &json))
    }
}

/// What a request gets.
enum Response {
    Whole(Vec<u8>),
    Stream(Vec<u8>),
}
