//! `yawbench.dbc` is the contract: every frame of the codec reads through it, and every frame
//! made from it is read by the codec. The DBC parser is can-dbc; the bits are moved by hand.
use crate::support::samples::Value;
use crate::support::{dbc_text, samples, wire};
use can_dbc::{Dbc, Signal, ValueType};
use can_protocol::{Error, Message, MessageId, Profile};
use proptest::prelude::*;

/// What the DBC says a signal holds: an entry of its value table, else a number.
fn read<'a>(dbc: &'a Dbc, id: u16, signal: &Signal, data: &[u8]) -> Result<&'a str, f64> {
    let code = wire::raw(signal, data);
    let number = code as f64 * signal.factor + signal.offset;
    wire::name(dbc, id, &signal.name, code).ok_or(number)
}

/// Panics unless the DBC and the codec see the same in a frame.
fn agree(dbc: &Dbc, id: u16, data: &[u8], message: &Message, profile: Profile) {
    let described = wire::message(dbc, id);
    assert_eq!(described.size as usize, data.len());
    let values = samples::dbc_values(message, profile);
    assert!(has_crc(described));
    assert_eq!(described.signals.len(), values.len() + 1);
    for (name, value) in values {
        let signal = described.signals.iter().find(|signal| signal.name == name);
        let signal = signal.unwrap_or_else(|| panic!("{} lacks {name}", described.name));
        match (read(dbc, id, signal, data), value) {
            (Ok(found), Value::Name(expected)) => assert_eq!(found, expected, "{name}"),
            (Err(found), Value::Number(expected)) => assert!(
                (found - expected).abs() <= 1e-3 * signal.factor,
                "{name}: {found} by the dbc, {expected} by the codec"
            ),
            (found, expected) => panic!("{name}: {found:?} by the dbc, {expected:?} by the codec"),
        }
    }
}

fn has_crc(message: &can_dbc::Message) -> bool {
    message.signals.iter().any(|signal| signal.name == "crc")
}

#[test]
fn the_committed_file_is_the_generated_one() {
    assert!(
        include_str!("../../yawbench.dbc") == dbc_text::dbc_text(),
        "yawbench.dbc is stale: cargo run -p can-protocol --example dbc > can-protocol/yawbench.dbc"
    );
}

#[test]
fn the_dbc_has_every_message_and_nothing_else() {
    let dbc = wire::dbc();
    let ids: Vec<u32> = dbc.messages.iter().map(|message| message.id.raw()).collect();
    assert_eq!(ids, MessageId::all().map(|message| u32::from(message.raw())).collect::<Vec<_>>());
    for message in MessageId::all() {
        let id = message.raw();
        let fd = message.profile() == Profile::Fd;
        assert_eq!(wire::attribute(&dbc, id, "VFrameFormat"), if fd { 14 } else { 0 });
        assert_eq!(wire::attribute(&dbc, id, "CANFD_BRS"), u64::from(fd));
        assert_eq!(wire::message(&dbc, id).name, message.to_string());
        let period_us = message.nominal_period_us().unwrap_or(0);
        assert_eq!(wire::attribute(&dbc, id, "CycleTimeUs"), u64::from(period_us));
        let period_ms = wire::attribute(&dbc, id, "GenMsgCycleTime");
        assert_eq!(period_ms, u64::from(period_us).div_ceil(1000));
    }
}

#[test]
fn signals_fill_their_message_without_overlap() {
    for message in &wire::dbc().messages {
        let mut used = vec![false; message.size as usize * 8];
        for signal in &message.signals {
            for bit in &mut used[signal.start_bit as usize..][..signal.size as usize] {
                assert!(!*bit, "{} {} overlaps", message.name, signal.name);
                *bit = true;
            }
        }
        // Only telemetry and the residual have spare bits, four each, and the heartbeat six.
        let spare = used.iter().filter(|used| !**used).count();
        let expected = [("TELEMETRY", 4), ("RESIDUAL", 4), ("HEARTBEAT", 6)]
            .into_iter()
            .find_map(|(name, bits)| message.name.starts_with(name).then_some(bits));
        assert_eq!(spare, expected.unwrap_or(0), "{}", message.name);
    }
}

#[test]
fn limits_are_the_codes_without_the_invalid_one() {
    let dbc = wire::dbc();
    for message in &dbc.messages {
        for signal in message.signals.iter().filter(|s| s.value_type == ValueType::Signed) {
            let limit = (1_i64 << (signal.size - 1)) - 1;
            let edge = |value: can_dbc::NumericValue| -> f64 { value.to_string().parse().unwrap() };
            for (value, code) in [(edge(signal.max), limit), (edge(signal.min), -limit)] {
                assert!((value - code as f64 * signal.factor).abs() < 1e-3 * signal.factor);
            }
            let id = message.id.raw() as u16;
            assert_eq!(wire::name(&dbc, id, &signal.name, -limit - 1), Some("INVALID"));
        }
    }
}

#[test]
fn the_comments_suffice_to_write_a_peer() {
    let dbc = wire::dbc();
    for message in MessageId::all() {
        let comment = dbc
            .message_comment(can_dbc::MessageId::Standard(message.raw()))
            .unwrap_or_else(|| panic!("{message} has no comment"));
        let (_, worked) = comment.split_once("Worked frame: ").expect("a worked frame");
        let (bytes, line) = worked.split_once(" (").expect("its meaning");
        let data: Vec<u8> =
            bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
        // The codec reads it as the comment says, and its CRC is right by the comment's recipe.
        let read = Message::decode(message.raw(), &data).unwrap();
        assert_eq!(format!("{read})."), line);
        let described = wire::message(&dbc, message.raw());
        if let Some(signal) = described.signals.iter().find(|signal| signal.name == "crc") {
            assert_eq!(wire::raw(signal, &data), wire::crc(&dbc, message.raw(), &data));
            assert!(comment.contains(&format!("DataID 0x{:04X}", message.data_id())));
            for word in ["CRC", "start", "xor", "Little-endian"] {
                assert!(comment.contains(word), "{message}: {word}");
            }
        }
    }
}

#[test]
fn the_comment_on_the_bus_starts_with_what_safe_means() {
    let text = dbc_text::dbc_text();
    let (_, comment) = text.split_once("CM_ \"").expect("a comment on the bus");
    let (comment, _) = comment.split_once("\";").expect("its end");
    let (_, rules) = comment.split_once(". ").expect("more than a title");
    assert!(rules.starts_with("SAFE means: the rig decelerates within its limit"));
    for rule in [
        "no safety function and claims no PL or SIL",
        "PRESSURE_OFF",
        "Watchdog",
        "left by a reset only",
        "the one frame that arms",
        "255 of 256 cases",
    ] {
        assert!(rules.contains(rule), "{rule}");
    }
    for item in can_protocol::ArmItem::ALL {
        assert!(rules.contains(&format!("{item} (0x{:04X})", item.code())), "{item}");
    }
}

#[test]
fn the_sealed_frames_of_the_comments_follow_their_recipe() {
    let dbc = wire::dbc();
    let mut count = 0;
    for message in MessageId::all() {
        let comment = dbc.message_comment(can_dbc::MessageId::Standard(message.raw())).unwrap();
        let Some((_, sealed)) = comment.split_once("Sealed frame: ") else { continue };
        let (bytes, _) = sealed.split_once(" (").unwrap();
        let data: Vec<u8> =
            bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
        let described = wire::message(&dbc, message.raw());
        let raw =
            |name| wire::raw(described.signals.iter().find(|s| s.name == name).unwrap(), &data);
        // The recipe of the comment on the bus, by hand: code 0x49C5, cycle 1000; of a sample of
        // the track 0xDB7C and its number.
        let (code, name, numbers) =
            if message.is_of_track() { (0xDB7C, "number", 256) } else { (0x49C5, "counter", 0) };
        let (modulus, masks) = if data.len() == 8 { (15, 256) } else { (255, 65_536) };
        let mask = if message.is_of_track() {
            (code + 1000 / 15 * (2 * code + 1)) % 65_536 / 256
        } else {
            (code + 1000 / modulus * (2 * code + 1)) % masks
        };
        assert_eq!(raw(name), 1000 % modulus.max(numbers));
        assert_eq!(raw("crc"), wire::masked_crc(&dbc, message.raw(), &data, mask));
        count += 1;
    }
    assert_eq!(count, 18, "commands and measurements of four nodes in both profiles, and track");
}

proptest! {
    #![proptest_config(samples::config(20_000))]

    #[test]
    fn frames_of_the_codec_read_through_the_dbc((message, profile) in samples::message()) {
        let dbc = DBC.with(std::rc::Rc::clone);
        let (frame, _) = message.encode(profile);
        let decoded = Message::decode(frame.id(), frame.data()).unwrap();
        agree(&dbc, frame.id(), frame.data(), &decoded, profile);
        let described = wire::message(&dbc, frame.id());
        if let Some(signal) = described.signals.iter().find(|signal| signal.name == "crc") {
            let found = wire::raw(signal, frame.data());
            prop_assert_eq!(found, wire::crc(&dbc, frame.id(), frame.data()));
        }
    }

    /// Codes are drawn per signal: any, or the ends of the range and the invalid one.
    #[test]
    fn frames_of_the_dbc_are_read_by_the_codec(
        pick in any::<prop::sample::Index>(),
        codes in prop::collection::vec((0_u8..6, any::<i64>()), 20),
    ) {
        let dbc = DBC.with(std::rc::Rc::clone);
        let described = pick.get(&dbc.messages);
        let id = described.id.raw() as u16;
        let mut data = vec![0; described.size as usize];
        for (signal, (kind, code)) in described.signals.iter().zip(codes) {
            let limit = 1_i64 << (signal.size - 1);
            wire::put_raw(signal, match kind { 0 => -limit, 1 => limit - 1, 2 => -1, _ => code }, &mut data);
        }
        if let Some(signal) = described.signals.iter().find(|signal| signal.name == "crc") {
            let crc = wire::crc(&dbc, id, &data);
            wire::put_raw(signal, crc, &mut data);
        }
        match Message::decode(id, &data) {
            Ok(read) => {
                let profile = MessageId::from_raw(id).unwrap().profile();
                agree(&dbc, id, &data, &read, profile);
            }
            // The codec refuses exactly what the DBC has no name or no room for.
            Err(Error::ReservedCode { field, code, .. }) => {
                let signal = described.signals.iter().find(|signal| signal.name.starts_with(field));
                let signal = signal.unwrap();
                prop_assert_eq!(wire::raw(signal, &data), i64::from(code));
                let name = wire::name(&dbc, id, &signal.name, code.into());
                let minimum: f64 = signal.min.to_string().parse().unwrap();
                let senders_own = field == "sender" && i64::from(code) != i64::from(id & 0xF);
                prop_assert!(
                    senders_own || name == Some("INVALID") || f64::from(code) < minimum
                        || (name.is_none() && ["state", "mode", "pressure", "profile", "pace", "watch", "item"].contains(&field)),
                    "{field} {code}"
                );
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
}

thread_local! {
    static DBC: std::rc::Rc<Dbc> = std::rc::Rc::new(wire::dbc());
}
