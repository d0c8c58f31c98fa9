//! A page to watch and end a run with, in a browser on this machine.
//!
//! ```text
//! loop -> queue -> recorder's thread -> Feed -> board -> thread of the page -> browsers
//!                        |                                      |
//!                     record.npy                      POST /ramp-out -> Requests
//! ```
//! The loop does not know of it: it fills the queue that it fills without a page, and reads the
//! request for an end that it reads without one. The recorder's thread takes copies of the rows
//! that it has written, decimates them and puts an update on a board, ten times a second
//! (`feed.rs`). The thread of the page takes the newest update (`server.rs`). A slow browser
//! loses updates; nobody waits for anybody.
//!
//! The page is three files in the program and a stream of server-sent events. The only command is
//! the ramp-out, as by key `s`: nothing can be armed, started or set (`gate.rs`). It is no safety
//! function; between the button and the loop are a browser and an ordinary thread.
//!
//! Limits: loopback only, without encryption. Any program on this machine can do what the page
//! does.

mod address;
mod answer;
mod assets;
mod board;
mod connection;
mod feed;
mod gate;
mod interlocks;
mod request;
mod server;
mod timing;

pub use address::{LiveAddress, NotLoopback};
pub use board::RunEnd;
pub(crate) use board::{Facts, Phase, SlotFacts};
pub(crate) use feed::Feed;
pub(crate) use interlocks::AgreedLimits;
pub(crate) use timing::edges_us;

use crate::control::Requests;
use crate::draw::Draw;
use board::Board;
use gate::Gate;
use server::Server;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// A page that is served until it is dropped.
#[derive(Debug)]
pub struct LivePage {
    address: SocketAddr,
    board: Arc<Board>,
    thread: Option<JoinHandle<()>>,
}

impl LivePage {
    /// Serves a page at an address. Its thread is an ordinary one: it is to be started before the
    /// caller asks the kernel for real time, which it would inherit.
    ///
    /// # Errors
    /// The address is in use or is not this machine's; the system has no random numbers or no
    /// thread.
    pub fn serve(address: LiveAddress, requests: &'static Requests) -> io::Result<Self> {
        let listener = TcpListener::bind(address.socket())?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let gate = Gate::new(address, &mut Draw::system()?);
        let board = Arc::new(Board::default());
        let server = Server::new(listener, gate, Arc::clone(&board), requests);
        let thread = thread::Builder::new().name("page".to_owned()).spawn(move || server.run())?;
        Ok(Self { address, board, thread: Some(thread) })
    }

    /// Where it is.
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Shows how the run has ended; called again when more is known.
    pub fn end(&self, end: RunEnd) {
        self.board.end(end);
    }

    /// Shows what does not change in a run.
    pub(crate) fn begin(&self, facts: Facts) {
        self.board.begin(facts);
    }

    /// Shows what happens before the first cycle.
    pub(crate) fn enter(&self, phase: Phase) {
        self.board.enter(phase);
    }

    /// The recorder's end of it, for slots with and without a rig.
    pub(crate) fn feed(&self, is_rig: Vec<bool>) -> Feed {
        Feed::new(Arc::clone(&self.board), is_rig)
    }
}

#[cfg(test)]
impl LivePage {
    /// A page whose thread hangs where it takes an update.
    pub(crate) fn hung() -> Self {
        let board = Arc::new(Board::default());
        board.hang();
        Self { address: ([127, 0, 0, 1], 0).into(), board, thread: None }
    }
}

impl Drop for LivePage {
    /// Shows the last update, for a second at most, and ends.
    fn drop(&mut self) {
        self.board.close();
        if let Some(thread) = self.thread.take() {
            // A thread that has panicked serves no more.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead as _, BufReader, Write as _};
    use std::net::TcpStream;

    /// Reads events until one says something.
    fn read_until(events: &mut BufReader<TcpStream>, text: &str) -> String {
        let mut line = String::new();
        while !line.contains(text) {
            line.clear();
            assert!(events.read_line(&mut line).unwrap() > 0, "no event with \"{text}\"");
        }
        line
    }

    #[test]
    fn a_page_follows_a_run_from_its_preparation_to_its_end() {
        let requests: &'static Requests = Box::leak(Box::default());
        let page = LivePage::serve("127.0.0.1:0".parse().unwrap(), requests).unwrap();
        let mut line = TcpStream::connect(page.address()).unwrap();
        write!(line, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", page.address()).unwrap();
        let mut events = BufReader::new(line);
        let prepared = read_until(&mut events, "the run is being prepared");
        assert!(prepared.starts_with("data: {\"state\":\"INIT\""), "{prepared}");
        page.enter(Phase::Meeting);
        read_until(&mut events, "the rigs are being met");
        requests.wait_for_arming();
        let awaited = read_until(&mut events, "wait to be armed: key a in the terminal");
        assert!(awaited.contains("\"state\":\"STANDBY\""), "{awaited}");
        requests.arm();
        page.enter(Phase::Arming);
        read_until(&mut events, "the rigs are being armed");
        page.end(RunEnd {
            words: "over".to_owned(),
            why: None,
            warnings: Vec::new(),
            files: None,
            is_good: true,
        });
        let end = read_until(&mut events, "\"words\":\"over\"");
        assert!(end.contains("\"note\":\"\""), "{end}");
        // What is put before the end is told, and then the line is closed.
        page.end(RunEnd {
            words: "last".to_owned(),
            why: None,
            warnings: Vec::new(),
            files: None,
            is_good: true,
        });
        drop(page);
        read_until(&mut events, "\"words\":\"last\"");
        let mut rest = String::new();
        while events.read_line(&mut rest).is_ok_and(|count| count > 0) {}
        assert_eq!(requests.asker(), None);
    }
}
