//! Worst-case response times of the messages on a CAN bus.
//!
//! A message may wait for one frame of lower priority that is on the wire already, and for all of
//! higher priority. The revised analysis of Davis, Burns, Bril and Lukkien ("Controller Area
//! Network (CAN) schedulability analysis: Refuted, revisited and revised", Real-Time Systems 35,
//! 2007) looks at every instance in the longest busy period of its priority level, since the first
//! one need not be the slowest. With frame times `C`, periods `T`, blocking `B` (the longest frame
//! of lower priority) and the time of a bit `t_bit`:
//!
//! ```text
//! busy period   t    = B + sum over all of this priority or a higher one of ceil(t / T_k) C_k
//! instance q    w_q  = B + q C + sum over the higher ones of ceil((w_q + t_bit) / T_k) C_k
//! response      R    = max over q < ceil(t / T) of  w_q - q T + C
//! ```
//!
//! Limits: no release jitter, no errors and retransmissions on the bus, and every node offers its
//! most urgent frame first. The transmit queue of Linux is first in, first out: there a message
//! also waits for what its own node has sent before. Messages without a period block others as
//! frames of lower priority do; as higher ones they are not counted, because nothing bounds them.
//!
//! Times are whole nanoseconds, rounded up, so that no bound hangs on a rounding.

use super::bus_message::{BitRates, BusMessage};
use super::check::Verdict;
use report::{Cell, Table};
use serde::Serialize;

/// A message with its bound.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseTime {
    /// Its name.
    pub name: String,
    /// Its id.
    pub id: u32,
    /// Whether the id has 29 bits.
    pub is_extended: bool,
    /// Time of its longest frame (µs).
    pub frame_us: f64,
    /// Its period, which is its deadline too (ms).
    pub period_ms: Option<f64>,
    /// From its release to its end on the bus, at worst (µs); `None` where nothing bounds it.
    pub response_us: Option<f64>,
    /// Good if it is there before the next one is released; unknown without a period.
    pub verdict: Verdict,
}

/// The messages of a bus, most urgent first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseTimes {
    /// Share of the bus that messages with a period take at worst; `None` where none has one.
    pub load: Option<f64>,
    /// Every message.
    pub messages: Vec<ResponseTime>,
}

/// A message as the analysis sees it, in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stream {
    frame_ns: u64,
    period_ns: Option<u64>,
}

/// Instances of one busy period beyond which a message counts as unbounded: the load is then so
/// close to 1 that a single error never wears off.
const MOST_INSTANCES: u64 = 100_000;

/// The response times of messages in any order.
pub fn response_times(messages: &[BusMessage], rates: &BitRates) -> ResponseTimes {
    let mut messages: Vec<&BusMessage> = messages.iter().collect();
    messages.sort_by_key(|message| priority(message));
    let streams: Vec<Stream> = messages
        .iter()
        .map(|message| Stream {
            frame_ns: rates.frame_ns(message),
            period_ns: message.period_s.map(|period_s| (period_s * 1e9).round() as u64),
        })
        .collect();
    let bit_ns = rates.bit_ns();
    let found = messages.iter().enumerate().map(|(level, message)| {
        let stream = streams[level];
        let response_ns = response_ns(&streams, level, bit_ns);
        let verdict = match (stream.period_ns, response_ns) {
            (None, _) => Verdict::Unknown,
            (Some(period_ns), Some(response_ns)) if response_ns <= period_ns => Verdict::Good,
            (Some(_), _) => Verdict::Change,
        };
        ResponseTime {
            name: message.name.clone(),
            id: message.id,
            is_extended: message.is_extended,
            frame_us: stream.frame_ns as f64 / 1e3,
            period_ms: message.period_s.map(|period_s| period_s * 1e3),
            response_us: response_ns.map(|ns| ns as f64 / 1e3),
            verdict,
        }
    });
    let has_period = streams.iter().any(|stream| stream.period_ns.is_some());
    ResponseTimes { load: has_period.then(|| load(&streams)), messages: found.collect() }
}

/// What arbitration compares: 11 bits, then a short id before a long one, then the other 18.
fn priority(message: &BusMessage) -> (u32, bool, u32) {
    if message.is_extended {
        (message.id >> 18, true, message.id & 0x3_FFFF)
    } else {
        (message.id, false, 0)
    }
}

fn load(streams: &[Stream]) -> f64 {
    let share = |stream: &Stream| Some(stream.frame_ns as f64 / stream.period_ns? as f64);
    streams.iter().filter_map(share).sum()
}

/// The bound of the message at a level; `None` without a period, and where nothing bounds it.
fn response_ns(streams: &[Stream], level: usize, bit_ns: u64) -> Option<u64> {
    let (urgent, rest) = streams.split_at_checked(level + 1)?;
    let (own, higher) = urgent.split_last()?;
    let period_ns = own.period_ns?;
    debug_assert!(period_ns > 0 && own.frame_ns > 0, "a message without time");
    if load(urgent) >= 1.0 {
        return None;
    }
    let blocking_ns = rest.iter().map(|stream| stream.frame_ns).max().unwrap_or(0);
    let busy_ns = settled(own.frame_ns, |t| blocking_ns + demand(urgent, t))?;
    let instances = busy_ns.div_ceil(period_ns);
    let mut worst_ns = 0;
    let mut start_ns = blocking_ns;
    for q in 0..instances {
        let before_ns = blocking_ns + q * own.frame_ns;
        let wait = |w| before_ns + demand(higher, w + bit_ns);
        start_ns = settled(start_ns.max(before_ns), wait)?;
        // Before its release no instance waits: that would be another busy period.
        worst_ns = worst_ns.max((start_ns + own.frame_ns).saturating_sub(q * period_ns));
        if q >= MOST_INSTANCES {
            return None;
        }
    }
    debug_assert!(worst_ns >= own.frame_ns + blocking_ns, "a bound below the least there is");
    Some(worst_ns)
}

/// Time that the frames of some messages take which are released in `[0, t)`.
fn demand(streams: &[Stream], t_ns: u64) -> u64 {
    let of = |stream: &Stream| Some(t_ns.div_ceil(stream.period_ns?) * stream.frame_ns);
    streams.iter().filter_map(of).sum()
}

/// The least fixed point at or above a start; `None` if it is not reached.
fn settled(start_ns: u64, next: impl Fn(u64) -> u64) -> Option<u64> {
    let mut t_ns = start_ns;
    for _ in 0..MOST_INSTANCES {
        let further_ns = next(t_ns);
        if further_ns <= t_ns {
            return Some(t_ns);
        }
        t_ns = further_ns;
    }
    None
}

impl ResponseTimes {
    /// Whether a message may be later than its next release.
    pub fn is_late(&self) -> bool {
        self.messages.iter().any(|message| message.verdict == Verdict::Change)
    }

    /// The table, and below it what to do about messages that may be late.
    pub fn lines(&self, caption: &str) -> Vec<String> {
        let table = Table::new("")
            .text("message")
            .written("id", "")
            .number("period", "ms")
            .fixed("frame", "us", 1)
            .fixed("response, worst", "us", 1)
            .text("verdict");
        let table = table.rows(self.messages.iter().map(|message| -> [Cell; 6] {
            let digits = if message.is_extended { 8 } else { 3 };
            [
                message.name.as_str().into(),
                format!("{:0digits$X}", message.id).into(),
                message.period_ms.into(),
                message.frame_us.into(),
                match (message.response_us, message.verdict) {
                    (None, Verdict::Change) => "no bound".into(),
                    (response_us, _) => response_us.into(),
                },
                message.verdict.name().into(),
            ]
        }));
        let load = match self.load {
            Some(load) => format!("load {:.1} % at worst", 100.0 * load),
            None => "load unknown".to_owned(),
        };
        let mut lines = vec![format!("{caption}, {load}")];
        lines.extend(table.lines());
        let has = |verdict| self.messages.iter().any(|message| message.verdict == verdict);
        if has(Verdict::Change) {
            lines.push(
                "To change: a message may still wait when its next one is due. Raise the bit rate, \
                 lower the id of the message, lengthen the periods of others, or use a second bus."
                    .to_owned(),
            );
        }
        if has(Verdict::Unknown) {
            lines.push(
                "Not judged: messages without a period (GenMsgCycleTime). They are counted where \
                 they delay more urgent ones by one frame, and nowhere else."
                    .to_owned(),
            );
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits of 8 us: 125 of them take a millisecond.
    const BIT_NS: u64 = 8_000;

    fn streams(list: &[(u64, u64)]) -> Vec<Stream> {
        let stream = |&(frame_ns, period_ns)| Stream { frame_ns, period_ns: Some(period_ns) };
        list.iter().map(stream).collect()
    }

    /// The example that refutes the analysis of 1994: the second instance of C is the slowest.
    #[test]
    fn the_second_instance_of_the_published_example_is_the_slowest() {
        let abc =
            streams(&[(1_000_000, 2_500_000), (1_000_000, 3_500_000), (1_000_000, 3_500_000)]);
        let found: Vec<_> = (0..3).map(|level| response_ns(&abc, level, BIT_NS)).collect();
        assert_eq!(found, [Some(2_000_000), Some(3_000_000), Some(3_500_000)]);
        // The simulation from the critical instant finds the same, instance by instance.
        assert_eq!(simulated_ns(&abc, &[0, 0, 0], None)[2], 3_500_000);
    }

    #[test]
    fn without_others_a_frame_waits_for_one_of_lower_priority() {
        let two = streams(&[(135_000, 1_000_000), (115_000, 50_000_000)]);
        assert_eq!(response_ns(&two, 0, 1_000), Some(135_000 + 115_000));
        assert_eq!(response_ns(&two, 1, 1_000), Some(135_000 + 115_000));
    }

    #[test]
    fn a_full_bus_bounds_only_what_is_urgent_enough() {
        let full = streams(&[(600, 1000), (500, 1000), (100, 10_000)]);
        assert_eq!(response_ns(&full, 0, 1), Some(600 + 500));
        assert_eq!((response_ns(&full, 1, 1), response_ns(&full, 2, 1)), (None, None));
    }

    #[test]
    fn messages_without_a_period_block_and_have_no_bound() {
        let mut mixed = streams(&[(135_000, 1_000_000), (1, 1), (135_000, 10_000_000)]);
        mixed[1] = Stream { frame_ns: 160_000, period_ns: None };
        assert_eq!(response_ns(&mixed, 0, 1_000), Some(295_000));
        assert_eq!(response_ns(&mixed, 1, 1_000), None);
        assert_eq!(response_ns(&mixed, 2, 1_000), Some(270_000));
    }

    fn message(id: u32, is_extended: bool) -> BusMessage {
        BusMessage {
            name: String::new(),
            id,
            is_extended,
            bytes: 8,
            is_fd: false,
            switches_rate: false,
            period_s: None,
        }
    }

    #[test]
    fn the_load_of_messages_without_a_period_is_unknown() {
        let rates = BitRates { nominal_bits_per_s: 1e6, data_bits_per_s: 1e6 };
        let mut messages = [message(1, false), message(2, false)];
        let heading = |messages: &[BusMessage]| {
            response_times(messages, &rates).lines("Messages").swap_remove(0)
        };
        assert_eq!(heading(&messages), "Messages, load unknown");
        messages[0].period_s = Some(1e-3);
        assert_eq!(heading(&messages), "Messages, load 13.5 % at worst");
    }

    #[test]
    fn arbitration_compares_eleven_bits_first() {
        let long = |id: u32, rest| priority(&message(id << 18 | rest, true));
        let short = |id| priority(&message(id, false));
        assert!(short(0x100) < long(0x100, 0) && long(0x100, 0) < long(0x100, 1));
        assert!(long(0xFF, 5) < short(0x100) && long(0x100, 9) < short(0x101));
    }

    /// A bus that takes the most urgent frame that waits, for 200 of the longest periods; the
    /// slowest response of each. `blocker` is on the wire since just before time 0.
    fn simulated_ns(streams: &[Stream], offsets_ns: &[u64], blocker: Option<usize>) -> Vec<u64> {
        let mut worst_ns = vec![0; streams.len()];
        let mut release_ns = offsets_ns.to_vec();
        let mut now_ns = blocker.map_or(0, |level| streams[level].frame_ns - 1);
        let end_ns = 200 * streams.iter().filter_map(|stream| stream.period_ns).max().unwrap();
        while now_ns < end_ns {
            let waiting = release_ns.iter().position(|release_ns| *release_ns <= now_ns);
            let Some(level) = waiting else {
                now_ns = *release_ns.iter().min().unwrap();
                continue;
            };
            now_ns += streams[level].frame_ns;
            worst_ns[level] = worst_ns[level].max(now_ns - release_ns[level]);
            release_ns[level] += streams[level].period_ns.unwrap();
        }
        worst_ns
    }

    /// Sets of messages and offsets from a counter: no seed that a run could miss.
    fn drawn(seed: u64) -> impl FnMut(u64, u64) -> u64 {
        use crate::draw::Draw;
        let mut draw = Draw::seeded(seed, 0);
        move |low, high| low + u64::from(draw.number()) % (high - low)
    }

    #[test]
    fn no_simulated_bus_is_slower_than_its_bound_and_some_reach_it() {
        let (mut bounded, mut reached) = (0, 0);
        for seed in 0..400 {
            let mut draw = drawn(seed);
            let count = draw(2, 7);
            let set: Vec<(u64, u64)> =
                (0..count).map(|_| (draw(55, 161), draw(3, 30) * 100)).collect();
            let set = streams(&set);
            if load(&set) >= 1.0 {
                continue;
            }
            let bounds: Vec<u64> =
                (0..set.len()).map(|level| response_ns(&set, level, 1).unwrap()).collect();
            for trial in 0..8 {
                let together = trial < 4;
                let offsets: Vec<u64> =
                    set.iter().map(|_| if together { 0 } else { draw(0, 3000) }).collect();
                let blocker = together.then(|| draw(0, count) as usize);
                let found = simulated_ns(&set, &offsets, blocker);
                for (level, (found_ns, bound_ns)) in found.iter().zip(&bounds).enumerate() {
                    let context = format!("seed {seed}, level {level}, {set:?}, {offsets:?}");
                    // A blocker that is itself more urgent blocks nobody in the analysis: it is
                    // demand, and the simulated one comes in addition.
                    if blocker.is_none_or(|blocker| blocker > level) || !together {
                        assert!(found_ns <= bound_ns, "{found_ns} over {bound_ns}: {context}");
                    }
                    bounded += 1;
                    reached += u32::from(found_ns + 1 >= *bound_ns);
                }
            }
        }
        assert!(bounded > 2000 && reached > 200, "{reached} of {bounded}: is this test blind?");
    }
}
