//! One connection of a browser: it reads one request, writes one answer or a stream, and waits for
//! nobody.
//!
//! Each stage has its time: a request has to come whole, an answer has to be taken. What is written
//! is at most one answer or one event. A browser that takes nothing loses the events that come
//! meanwhile.

use super::request::{Refusal, Request};
use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// Time in which a request has to come.
const REQUEST: Duration = Duration::from_secs(2);

/// Time in which some bytes of an answer have to be taken.
const TAKEN: Duration = Duration::from_secs(10);

/// Time that a browser has to hang up after its answer.
const HANG_UP: Duration = Duration::from_secs(1);

/// Bytes that are read at once, and how often in a round: an endless request then blocks nothing.
const BATCH: usize = 2048;
const BATCHES: usize = 8;

/// What a connection reads from and writes to, without waiting.
pub(super) trait Line: Read + Write {
    /// Tells the other end that nothing more comes.
    fn end_writing(&mut self);
}

impl Line for TcpStream {
    fn end_writing(&mut self) {
        // One that is gone needs no end.
        let _ = self.shutdown(Shutdown::Write);
    }
}

/// How far a connection is.
#[derive(Debug, PartialEq, Eq)]
enum Stage {
    /// Its request is coming.
    Request(Vec<u8>),
    /// Its answer is being written.
    Answer,
    /// Events follow each other.
    Stream,
    /// The answer is written; what is still on the way is read and thrown away, for a socket that
    /// is closed over unread bytes takes its answer back.
    HangUp,
    /// It is over.
    Closed,
}

/// A connection.
#[derive(Debug)]
pub(super) struct Connection<L> {
    line: L,
    stage: Stage,
    /// What is to be written, and how much of it is.
    out: Vec<u8>,
    written: usize,
    /// Begin of the stage, or the last time that bytes were taken.
    since: Instant,
    /// Whether an event was lost since the last one that was not.
    has_missed: bool,
}

impl<L: Line> Connection<L> {
    pub(super) fn new(line: L, now: Instant) -> Self {
        let stage = Stage::Request(Vec::new());
        Self { line, stage, out: Vec::new(), written: 0, since: now, has_missed: false }
    }

    pub(super) const fn line(&self) -> &L {
        &self.line
    }

    /// Whether its request has not come yet.
    pub(super) const fn is_asking(&self) -> bool {
        matches!(self.stage, Stage::Request(_))
    }

    pub(super) const fn is_stream(&self) -> bool {
        matches!(self.stage, Stage::Stream)
    }

    pub(super) const fn is_closed(&self) -> bool {
        matches!(self.stage, Stage::Closed)
    }

    /// Whether it is a stream that has missed something and could be told now.
    pub(super) const fn is_behind(&self) -> bool {
        self.is_stream() && self.has_missed && !self.is_writing()
    }

    /// Whether everything that there was to tell has been taken.
    pub(super) const fn is_taken(&self) -> bool {
        let is_told = !self.is_stream() || !self.has_missed;
        is_told && !self.is_writing()
    }

    /// Whether there is something to write.
    pub(super) const fn is_writing(&self) -> bool {
        self.written < self.out.len()
    }

    /// Reads what has come; gives the request when it is whole, or why it is none.
    pub(super) fn read(&mut self) -> Option<Result<Request, Refusal>> {
        let mut batch = [0; BATCH];
        for _ in 0..BATCHES {
            let came = match self.line.read(&mut batch) {
                Ok(0) => {
                    self.stage = Stage::Closed;
                    return None;
                }
                Ok(count) => batch.get(..count).unwrap_or_default(),
                Err(why) if why.kind() == ErrorKind::Interrupted => continue,
                Err(why) if why.kind() == ErrorKind::WouldBlock => return None,
                Err(_) => {
                    self.stage = Stage::Closed;
                    return None;
                }
            };
            // Bytes behind a request say nothing that is listened to.
            let Stage::Request(head) = &mut self.stage else { continue };
            head.extend_from_slice(came);
            if let Some(asked) = Request::read(head).transpose() {
                return Some(asked);
            }
        }
        None
    }

    /// Begins an answer, after which the connection ends.
    pub(super) fn answer(&mut self, bytes: Vec<u8>, now: Instant) {
        self.begin(Stage::Answer, bytes, now);
    }

    /// Begins a stream.
    pub(super) fn stream(&mut self, bytes: Vec<u8>, now: Instant) {
        self.begin(Stage::Stream, bytes, now);
    }

    fn begin(&mut self, stage: Stage, bytes: Vec<u8>, now: Instant) {
        debug_assert!(self.is_asking(), "two answers on one connection");
        (self.stage, self.out, self.written, self.since) = (stage, bytes, 0, now);
    }

    /// Adds an event to a stream; it is lost where one before it is not taken yet.
    pub(super) fn push(&mut self, event: &[u8], now: Instant) {
        if !self.is_stream() {
            return;
        }
        self.has_missed = self.is_writing();
        if !self.has_missed {
            self.out.clear();
            self.out.extend_from_slice(event);
            (self.written, self.since) = (0, now);
        }
    }

    /// Writes as much as is taken.
    pub(super) fn write(&mut self, now: Instant) {
        while self.is_writing() && !self.is_closed() {
            match self.line.write(self.out.get(self.written..).unwrap_or_default()) {
                Ok(0) => self.stage = Stage::Closed,
                Ok(count) => {
                    self.written += count;
                    self.since = now;
                }
                Err(why) if why.kind() == ErrorKind::Interrupted => {}
                Err(why) if why.kind() == ErrorKind::WouldBlock => return,
                Err(_) => self.stage = Stage::Closed,
            }
        }
        if self.stage == Stage::Answer {
            self.line.end_writing();
            (self.stage, self.since) = (Stage::HangUp, now);
        }
    }

    /// Ends what takes too long.
    pub(super) fn expire(&mut self, now: Instant) {
        let passed = now.saturating_duration_since(self.since);
        match self.stage {
            Stage::Request(_) if passed > REQUEST => {
                let late = Refusal::new(408, "the request did not come in time");
                self.answer(super::answer::refused(late), now);
            }
            Stage::Answer | Stage::Stream if self.is_writing() && passed > TAKEN => {
                self.stage = Stage::Closed;
            }
            Stage::HangUp if passed > HANG_UP => self.stage = Stage::Closed,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;
    use std::io;

    /// A line that gives what it was given, and takes as many bytes as it has room for.
    #[derive(Debug, Default)]
    struct Given {
        comes: VecDeque<Vec<u8>>,
        room: usize,
        taken: Vec<u8>,
        is_ended: bool,
    }

    impl Read for Given {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let next = self.comes.pop_front().ok_or(ErrorKind::WouldBlock)?;
            into[..next.len()].copy_from_slice(&next);
            Ok(next.len())
        }
    }

    impl Write for Given {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = bytes.len().min(self.room);
            if count == 0 {
                return Err(ErrorKind::WouldBlock.into());
            }
            self.room -= count;
            self.taken.extend_from_slice(&bytes[..count]);
            Ok(count)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Line for Given {
        fn end_writing(&mut self) {
            self.is_ended = true;
        }
    }

    fn begun() -> (Connection<Given>, Instant) {
        let now = Instant::now();
        (Connection::new(Given::default(), now), now)
    }

    #[test]
    fn a_request_that_comes_in_crumbs_is_read_and_one_that_never_ends_is_refused() {
        let (mut connection, begin) = begun();
        for byte in *b"GET / HTTP/1.1\r\nHost: a\r\n\r" {
            connection.line.comes.push_back(vec![byte]);
            assert!(connection.read().is_none());
        }
        // A byte in every second does not win time.
        connection.expire(begin + REQUEST);
        assert!(connection.is_asking());
        let late = begin + REQUEST + Duration::from_millis(1);
        connection.expire(late);
        connection.line.room = 10_000;
        connection.write(late);
        assert!(connection.line.taken.starts_with(b"HTTP/1.1 408 ") && connection.line.is_ended);
        // The answer is out: a connection that the browser leaves open is closed from here.
        connection.line.comes.push_back(b"\nmore".to_vec());
        assert!(connection.read().is_none() && !connection.is_closed());
        connection.expire(late + HANG_UP + Duration::from_millis(1));
        assert!(connection.is_closed());

        let (mut connection, _) = begun();
        connection.line.comes.extend([b"GET / HT".to_vec(), b"TP/1.1\r\n\r\n".to_vec()]);
        assert!(matches!(connection.read(), Some(Ok(request)) if request.path == "/"));
    }

    #[test]
    fn a_stream_that_is_not_taken_loses_events_and_gets_the_newest() {
        let (mut connection, begin) = begun();
        connection.stream(b"head".to_vec(), begin);
        connection.line.room = 2;
        connection.write(begin);
        connection.push(b"lost", begin);
        assert!(connection.line.taken == b"he" && !connection.is_behind());
        connection.line.room = 100;
        connection.write(begin);
        assert!(connection.is_behind() && !connection.is_taken());
        connection.push(b"first", begin);
        connection.push(b"extra", begin);
        connection.write(begin);
        assert_eq!(connection.line.taken, b"headfirst");
        connection.push(b"last", begin);
        connection.write(begin);
        assert!(connection.line.taken.ends_with(b"firstlast") && connection.is_taken());
        assert!(!connection.line.is_ended);
        // Nothing to write is no reason to end; an event that nobody takes is.
        let later = begin + 10 * TAKEN;
        connection.expire(later);
        assert!(connection.is_stream());
        connection.line.room = 0;
        connection.push(b"stuck", later);
        connection.write(later);
        connection.expire(later + TAKEN + Duration::from_millis(1));
        assert!(connection.is_closed());
    }

    #[test]
    fn a_line_that_ends_or_fails_closes_its_connection() {
        let (mut connection, _) = begun();
        connection.line.comes.push_back(Vec::new());
        assert!(connection.read().is_none() && connection.is_closed());
        let (mut connection, begin) = begun();
        connection.answer(b"whole".to_vec(), begin);
        assert!(connection.is_writing());
        connection.expire(begin + TAKEN + Duration::from_millis(1));
        assert!(connection.is_closed());
    }
}
