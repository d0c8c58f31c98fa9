//! The messages of a bus: those of a DBC, or those of this protocol.

use super::bus_message::BusMessage;
use crate::BenchError;
use can_dbc::{AttributeValue, Dbc, MessageId as DbcId};
use can_protocol::{MessageId, Profile, Sender};
use dbc::Database;
use scenario::run::CYCLE_S;
use std::path::Path;

/// The messages of this protocol that share a bus: those of the host and of so many rigs, in one
/// profile, with the periods of a run.
pub fn messages_of_protocol(profile: Profile, rigs: u8) -> Vec<BusMessage> {
    let is_used = |message: &MessageId| match *message {
        MessageId::Command(of, node) | MessageId::Measurement(of, node) => {
            of == profile && node.number() <= rigs
        }
        MessageId::Fault(Sender::Rig(node))
        | MessageId::Heartbeat(Sender::Rig(node))
        | MessageId::PressureOff(Some(node))
        | MessageId::Telemetry(node)
        | MessageId::Residual(node)
        | MessageId::ArmRequest(node)
        | MessageId::ArmAnswer(node) => node.number() <= rigs,
        // A host has its track in memory.
        MessageId::TrackRequest | MessageId::TrackOffer | MessageId::TrackSample(_) => false,
        MessageId::PressureOff(None)
        | MessageId::Sync
        | MessageId::Fault(Sender::Host)
        | MessageId::Heartbeat(Sender::Host) => true,
    };
    let of = |message: MessageId| {
        let is_cyclic = matches!(message, MessageId::Command(..) | MessageId::Measurement(..));
        let usual_s = message.nominal_period_us().map(|us| f64::from(us) / 1e6);
        let is_fd = message.profile() == Profile::Fd;
        BusMessage {
            name: message.to_string(),
            id: u32::from(message.raw()),
            is_extended: false,
            bytes: message.payload_len() as u32,
            is_fd,
            switches_rate: is_fd,
            period_s: if is_cyclic { Some(CYCLE_S) } else { usual_s },
        }
    };
    MessageId::all().filter(is_used).map(of).collect()
}

/// Name of the message that Vector's tools put unused signals into; it is never sent.
const NEVER_SENT: &str = "VECTOR__INDEPENDENT_SIG_MSG";

/// The messages of a DBC: period from `GenMsgCycleTime` (ms), frame format from `VFrameFormat` and
/// `CANFD_BRS`.
///
/// # Errors
/// The file cannot be read, or is no DBC.
pub fn messages_of_dbc(path: &Path) -> Result<Vec<BusMessage>, BenchError> {
    let database = Database::read(path)?;
    let dbc = database.contents();
    let refused =
        |found: String, expected| BenchError::Kept { file: path.to_owned(), found, expected };
    let sent = dbc.messages.iter().filter(|message| message.name != NEVER_SENT);
    let mut messages = Vec::new();
    for message in sent {
        let most = if is_fd(dbc, message) { 64 } else { 8 };
        if message.size > most {
            let name = files::quoted(&message.name);
            let found = format!("message {name} of {} bytes", message.size);
            return Err(refused(found, "at most 8 bytes, or 64 in an FD frame"));
        }
        messages.push(message_of(dbc, message));
    }
    if messages.is_empty() {
        return Err(refused("no message".to_owned(), "a DBC with messages"));
    }
    Ok(messages)
}

fn message_of(dbc: &Dbc, message: &can_dbc::Message) -> BusMessage {
    let (id, is_extended) = match message.id {
        DbcId::Standard(id) => (u32::from(id), false),
        DbcId::Extended(id) => (id, true),
    };
    let cycle_time = dbc.resolved_message_attribute(message.id, "GenMsgCycleTime");
    let period_ms = cycle_time.and_then(number).filter(|ms| *ms > 0.0 && *ms <= MOST_PERIOD_MS);
    let is_fd = is_fd(dbc, message);
    // A DBC that does not say it means the usual: FD frames switch.
    let switch = dbc.resolved_message_attribute(message.id, "CANFD_BRS");
    let switches_rate = is_fd && switch.and_then(number) != Some(0.0);
    let (name, bytes) = (message.name.clone(), message.size as u32);
    let period_s = period_ms.map(|ms| ms / 1e3);
    BusMessage { name, id, is_extended, bytes, is_fd, switches_rate, period_s }
}

/// A period that is longer is none that anybody waits for (ms): a day.
const MOST_PERIOD_MS: f64 = 86.4e6;

/// Whether a message is an FD frame. `VFrameFormat` 14 and 15 are the FD formats with a short and a
/// long id; the default of an enumeration is its text.
fn is_fd(dbc: &Dbc, message: &can_dbc::Message) -> bool {
    match dbc.resolved_message_attribute(message.id, "VFrameFormat") {
        Some(AttributeValue::String(text)) if text.parse::<f64>().is_err() => text.ends_with("_FD"),
        Some(value) => number(value).is_some_and(|format| format >= 14.0),
        None => message.size > 8,
    }
}

fn number(value: &AttributeValue) -> Option<f64> {
    match value {
        AttributeValue::Uint(value) => Some(*value as f64),
        AttributeValue::Int(value) => Some(*value as f64),
        AttributeValue::Double(value) => Some(*value),
        AttributeValue::String(text) => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::{BitRates, Verdict, response_times};
    use can_protocol::fd_frame_bits;

    const RATES: BitRates = BitRates { nominal_bits_per_s: 1e6, data_bits_per_s: 5e6 };

    fn of_dbc(name: &str, text: &str) -> Result<Vec<BusMessage>, BenchError> {
        let file = std::env::temp_dir().join(format!("doctor-{}-{name}.dbc", std::process::id()));
        std::fs::write(&file, text).unwrap();
        let found = messages_of_dbc(&file);
        std::fs::remove_file(&file).unwrap();
        found
    }

    #[test]
    fn the_published_dbc_holds_what_the_protocol_says() {
        let text = include_str!("../../../can-protocol/yawbench.dbc");
        let of_file = of_dbc("yawbench", text).unwrap();
        for profile in [Profile::Classical, Profile::Fd] {
            for message in messages_of_protocol(profile, 4) {
                let same = of_file.iter().find(|other| other.name == message.name).unwrap();
                assert_eq!(*same, message);
            }
        }
    }

    #[test]
    fn one_rig_has_time_and_four_on_a_classical_bus_have_not() {
        let one = response_times(&messages_of_protocol(Profile::Classical, 1), &RATES);
        assert!(!one.is_late());
        let row = |name: &str| one.messages.iter().find(|row| row.name == name).unwrap();
        // A frame that is on the wire, sync, and its own: pressure off is sent on demand.
        assert_eq!(row("CMD_1").response_us, Some(135.0 * 3.0));
        assert_eq!(row("MEAS_1").response_us, Some(135.0 * 4.0));
        assert_eq!(row("PRESSURE_OFF_1").verdict, Verdict::Unknown);
        let four = response_times(&messages_of_protocol(Profile::Classical, 4), &RATES);
        assert!(four.is_late() && four.load > Some(1.08), "{:?}", four.load);
        let fd = response_times(&messages_of_protocol(Profile::Fd, 4), &RATES);
        assert!(!fd.is_late(), "{fd:?}");
    }

    #[test]
    fn periods_formats_and_long_ids_are_read() {
        let text = "VERSION \"\"\nBU_: A B\n\
            BO_ 256 FAST: 8 A\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" B\n\n\
            BO_ 2566844672 LONG: 8 A\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" B\n\n\
            BO_ 512 WIDE: 20 B\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" A\n\n\
            BO_ 768 QUIET: 2 B\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" A\n\n\
            BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n\
            BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"StandardCAN_FD\";\n\
            BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\nBA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n\
            BA_ \"GenMsgCycleTime\" BO_ 256 5;\nBA_ \"GenMsgCycleTime\" BO_ 2566844672 100;\n\
            BA_ \"GenMsgCycleTime\" BO_ 512 10;\nBA_ \"VFrameFormat\" BO_ 512 14;\n";
        let found = response_times(&of_dbc("formats", text).unwrap(), &RATES);
        let row = |name: &str| found.messages.iter().find(|row| row.name == name).unwrap();
        assert_eq!((row("FAST").frame_us, row("FAST").period_ms), (135.0, Some(5.0)));
        assert_eq!((row("LONG").frame_us, row("LONG").is_extended), (160.0, true));
        let (nominal, data) = fd_frame_bits(20);
        assert_eq!(row("WIDE").frame_us, f64::from(nominal) + f64::from(data) / 5.0);
        let quiet = row("QUIET");
        assert_eq!((quiet.period_ms, quiet.verdict), (None, Verdict::Unknown));
    }

    #[test]
    fn a_file_that_is_no_dbc_is_one_line() {
        let wide = "VERSION \"\"\nBO_ 1 WIDE: 9 A\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" B\n\
            BA_DEF_ BO_ \"VFrameFormat\" INT 0 15;\nBA_DEF_DEF_ \"VFrameFormat\" 0;\n";
        let endless = format!("VERSION \"\"\nCM_ \"{}", "\\\"".repeat(1000));
        for (name, text, expected) in [
            ("none", "hello\n", "none.dbc:1: found no DBC, expected "),
            ("endless", &endless, "endless.dbc:2: found no DBC, expected "),
            ("empty", "VERSION \"\"\n", "found no message, expected a DBC with messages"),
            ("wide", wide, "found message WIDE of 9 bytes, expected at most 8 bytes, or"),
        ] {
            let why = of_dbc(name, text).unwrap_err();
            let line = why.to_string();
            assert!(why.is_bad_input(), "{line}");
            assert!(line.contains(expected) && line.len() < 500, "{line}");
            assert_eq!(line.lines().count(), 1, "{line}");
        }
    }
}
