//! A run whose disk, page and browser all hang: the loop does not notice.

use super::*;
use crate::bus::MemoryBus;
use crate::clock::Pacer;
use crate::control::{Course, NoAnswer};
use crate::live::LivePage;
use crate::record::PART_CYCLES;
use crate::rig::RigNode;
use crate::run::work::Coupled;
use crate::run::{Plan, Terms, is_rig, session};
use can_protocol::{Pace as WirePace, Profile};
use scenario::run::{Overrides, Run};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::sync::{Condvar, Mutex};

/// A gate that holds everybody up while it is closed.
#[derive(Debug, Default)]
struct Barrier {
    is_closed: Mutex<bool>,
    changed: Condvar,
}

impl Barrier {
    fn set(&self, is_closed: bool) {
        *self.is_closed.lock().unwrap() = is_closed;
        self.changed.notify_all();
    }

    fn pass(&self) {
        let closed = self.is_closed.lock().unwrap();
        drop(self.changed.wait_while(closed, |is_closed| *is_closed).unwrap());
    }
}

/// A disk behind a gate that takes everything and keeps nothing.
#[derive(Debug)]
struct Disk<'a>(&'a Barrier);

impl Storage for Disk<'_> {
    fn write_at(&self, _bytes: &[u8], _at: u64) -> io::Result<()> {
        self.0.pass();
        Ok(())
    }
    fn cut(&self, _length: u64) -> io::Result<()> {
        self.0.pass();
        Ok(())
    }
    fn sync(&self) -> io::Result<()> {
        self.0.pass();
        Ok(())
    }
}

impl<'a> Place for &'a Barrier {
    type File = Disk<'a>;

    fn make(&self, _file: RunFile, _part: u64) -> io::Result<Disk<'a>> {
        Ok(Disk(self))
    }
    fn path(&self, _file: RunFile) -> PathBuf {
        PathBuf::from("nowhere")
    }
}

/// The work of a run, with the gate closed from its first cycle to its last.
struct Held<'a, W> {
    work: W,
    gate: Option<&'a Barrier>,
}

impl<W> Held<'_, W> {
    fn close(&self, is_closed: bool) {
        if let Some(gate) = self.gate {
            gate.set(is_closed);
        }
    }
}

impl<W: Work> Work for Held<'_, W> {
    fn arm<B: Bus>(
        &self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        self.work.arm(session, state, buses, requests)
    }

    fn run<B: Bus>(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        requests: &Requests,
    ) -> End {
        self.close(true);
        let end = self.work.run(session, state, buses, pace, requests);
        // Only now: a loop that waits for a file or for the page never comes here.
        self.close(false);
        end
    }
}

/// Cycles, hash and lost rows of seven seconds on a clock of virtual time, which drops what the
/// recorder does not take, as a real one does.
fn run_with(page: Option<&LivePage>, is_held: bool) -> (End, u64, u64, u64) {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(7.0), ..Overrides::default() };
    let run = Run::load(&scenario, overrides).unwrap();
    let plan = Plan::new(&run, &BusChoice::Memory).unwrap();
    let track = run.track.view();
    let terms = Terms { pace: WirePace::Clock, ..Terms::in_memory(Profile::Classical) };
    let session = session(&run, &track, &plan.rigs, terms).unwrap();
    let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, session.profile));
    let mut buses = vec![MemoryBus::new(rigs)];
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let requests = Requests::armed();
    session.meet(&mut state, &mut buses, Duration::from_secs(10), &requests).unwrap();
    let gate = Barrier::default();
    let output = Output {
        place: &gate,
        part_cycles: PART_CYCLES,
        lost_cycles_max: None,
        bus_names: vec!["memory".to_owned()],
        epoch: Epoch::now(),
        handshake: Vec::new(),
        feed: page.map(|page| page.feed(is_rig(&run))),
    };
    let work = Coupled { course: Course::new(&run, &track), cycles: run.cycles() };
    let task = Task {
        session: &session,
        work: Held { work, gate: is_held.then_some(&gate) },
        state: &mut state,
        buses: &mut buses,
        bus: &BusChoice::Memory,
        pace: &mut Pace::Realtime(Pacer::virtual_time(1_000_000)),
        cycles: run.cycles(),
    };
    let recording = record(task, &RealtimeOptions::NONE, output, &requests).unwrap();
    assert_eq!(state.skipped, 0);
    (recording.end, state.line.cycle, state.hash, recording.dropped)
}

fn requests() -> &'static Requests {
    Box::leak(Box::default())
}

#[test]
fn a_run_whose_recorder_page_and_reader_hang_is_the_same_run() {
    let (end, cycles, hash, _) = run_with(None, false);
    assert_eq!((end, cycles), (End::Completed, 9000));

    // A browser that asks for the events and never reads one.
    let page = LivePage::serve("127.0.0.1:0".parse().unwrap(), requests()).unwrap();
    let mut deaf = TcpStream::connect(page.address()).unwrap();
    write!(deaf, "GET /events HTTP/1.1\r\nHost: {}\r\n\r\n", page.address()).unwrap();
    let hung = LivePage::hung();
    for page in [None, Some(&page), Some(&hung)] {
        let held = run_with(page, true);
        assert_eq!((held.0, held.1, held.2), (end, cycles, hash));
        // The queue holds four seconds of nine: the rest was dropped and nobody waited.
        assert!(held.3 > 4000, "{} rows and frames lost", held.3);
    }
    // With a disk that takes everything the page alone holds nothing up either.
    for page in [&page, &hung] {
        let (held_end, held_cycles, held_hash, _) = run_with(Some(page), false);
        assert_eq!((held_end, held_cycles, held_hash), (end, cycles, hash));
    }
    let mut answer = [0; 15];
    deaf.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 200 OK");
}
