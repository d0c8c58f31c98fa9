//! A signal extractor and a frame builder that know only the DBC: no code of the codec.
use can_dbc::{AttributeValue, ByteOrder, Dbc, Message, MessageId, Signal, ValueType};

/// The committed file.
pub(crate) fn dbc() -> Dbc {
    Dbc::try_from(include_str!("../../../yawbench.dbc")).expect("yawbench.dbc")
}

/// The DBC's message of a frame id.
pub(crate) fn message(dbc: &Dbc, id: u16) -> &Message {
    dbc.messages
        .iter()
        .find(|message| message.id == MessageId::Standard(id))
        .unwrap_or_else(|| panic!("no message {id:#x}"))
}

/// The raw code of a signal, bit by bit.
pub(crate) fn raw(signal: &Signal, data: &[u8]) -> i64 {
    assert_eq!(signal.byte_order, ByteOrder::LittleEndian);
    let mut code = 0_i64;
    for bit in 0..signal.size {
        let at = signal.start_bit + bit;
        let one = data[(at / 8) as usize] >> (at % 8) & 1;
        code |= i64::from(one) << bit;
    }
    if signal.value_type == ValueType::Signed && code >> (signal.size - 1) & 1 == 1 {
        code -= 1 << signal.size;
    }
    code
}

/// Write the raw code of a signal, bit by bit.
pub(crate) fn put_raw(signal: &Signal, code: i64, data: &mut [u8]) {
    for bit in 0..signal.size {
        let at = signal.start_bit + bit;
        let byte = &mut data[(at / 8) as usize];
        *byte &= !(1 << (at % 8));
        *byte |= ((code >> bit & 1) as u8) << (at % 8);
    }
}

/// The name of a code in the signal's value table.
pub(crate) fn name<'a>(dbc: &'a Dbc, id: u16, signal: &str, code: i64) -> Option<&'a str> {
    dbc.value_descriptions_for_signal(MessageId::Standard(id), signal)?
        .iter()
        .find(|entry| entry.id == code)
        .map(|entry| entry.description.as_str())
}

/// An integer attribute of a message, or the attribute's default.
pub(crate) fn attribute(dbc: &Dbc, id: u16, name: &str) -> u64 {
    match dbc.resolved_message_attribute(MessageId::Standard(id), name) {
        Some(AttributeValue::Uint(value)) => *value,
        // The default of an enumeration is its text, here always the first entry.
        Some(AttributeValue::String(_)) => 0,
        other => panic!("{id:#x} {name}: {other:?}"),
    }
}

/// The plain CRC as the DBC's comments describe it, bit by bit.
pub(crate) fn crc(dbc: &Dbc, id: u16, data: &[u8]) -> i64 {
    masked_crc(dbc, id, data, 0)
}

/// The same with the mask of a sealed frame.
pub(crate) fn masked_crc(dbc: &Dbc, id: u16, data: &[u8], mask: i64) -> i64 {
    let bits = message(dbc, id).signals.iter().find(|s| s.name == "crc").map_or(0, |s| s.size);
    let (polynomial, start, last) = match bits {
        8 => (0x1D, 0xFF, 0xFF),
        16 => (0x1021, 0xFFFF, 0),
        _ => return 0,
    };
    let data_id = attribute(dbc, id, "DataID") as u16;
    let mut crc = start;
    let payload = &data[bits as usize / 8..];
    for (at, byte) in data_id.to_be_bytes().iter().chain(payload).enumerate() {
        if at == 2 {
            crc ^= mask;
        }
        crc ^= i64::from(*byte) << (bits - 8);
        for _ in 0..8 {
            crc = if crc >> (bits - 1) & 1 == 1 { crc << 1 ^ polynomial } else { crc << 1 };
        }
        crc &= (1 << bits) - 1;
    }
    crc ^ last
}
