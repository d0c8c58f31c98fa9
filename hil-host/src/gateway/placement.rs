//! Every message has one sender, and every key of the map its own bits.
//!
//! A command that is read back as a measurement says what was asked for and not what the rig does.
//! Two keys on the same bits overwrite each other in every cycle. A command is one frame of each of
//! its messages, so all its signals in a multiplexed message are on one page; measurements may come
//! on several.

use super::error::GatewayError;
use super::look_up::Found;
use dbc::CanId;
use scenario::source::Source;

/// Checks the signals of a command, its displacement first, and those of the rig. Each constant of
/// the command comes with its raw value.
pub(super) fn check(
    map: &Source,
    command: &[&Found],
    constants: &[(Found, u64)],
    rig: &[&Found],
) -> Result<(), GatewayError> {
    let all: Vec<&Found> =
        command.iter().copied().chain(constants.iter().map(|(found, _)| found)).collect();
    one_sender(map, &all, rig)?;
    own_bits(map, &all)?;
    own_bits(map, rig)?;
    one_page(map, command, constants)
}

/// Refuses a message that both sides would send.
fn one_sender(map: &Source, command: &[&Found], rig: &[&Found]) -> Result<(), GatewayError> {
    let displacement = command.first().map(|found| found.message.id);
    for sent in command {
        let id = sent.message.id;
        let Some(heard) = rig.iter().find(|heard| heard.message.id == id) else { continue };
        let (at, other, sender) =
            if Some(id) == displacement { (heard, sent, "rig") } else { (sent, heard, "host") };
        let found = format!("{} in message {id} next to {}", at.name, other.key);
        return Err(at.key.refuse(map, found, format!("a message that the {sender} alone sends")));
    }
    Ok(())
}

/// Refuses signals of one sender that share bits of a frame.
fn own_bits(map: &Source, signals: &[&Found]) -> Result<(), GatewayError> {
    for (number, one) in signals.iter().enumerate() {
        for other in signals.iter().take(number) {
            // A constant may name the page of the command: `one_page` looks at its value.
            let is_page = |one: &Found, other: &Found| {
                one.key.is_constant() && one.signal.selects(&other.signal)
            };
            let is_apart = one.message.id != other.message.id
                || !one.signal.overlaps(&other.signal)
                || is_page(one, other)
                || is_page(other, one);
            if is_apart {
                continue;
            }
            let (found, expected) = if one.name == other.name {
                (format!("{}, as for {}", one.name, other.key), "another signal")
            } else {
                let (name, key) = (&other.name, &other.key);
                (format!("{} on bits of {name} ({key})", one.name), "bits of its own")
            };
            return Err(one.key.refuse(map, found, expected));
        }
    }
    Ok(())
}

/// Writes a command as the encoder does, and refuses a signal that is not in its frame then.
fn one_page(
    map: &Source,
    command: &[&Found],
    constants: &[(Found, u64)],
) -> Result<(), GatewayError> {
    let constants = constants.iter().map(|(found, raw)| (found, *raw));
    let written: Vec<(&Found, u64)> =
        constants.chain(command.iter().map(|found| (*found, 0))).collect();
    let mut frames: Vec<(CanId, [u8; 64])> = Vec::new();
    for (found, raw) in &written {
        let id = found.message.id;
        let known = frames.iter().position(|(known, _)| *known == id);
        let number = known.unwrap_or(frames.len());
        if known.is_none() {
            frames.push((id, [0; 64]));
        }
        if let Some((_, data)) = frames.get_mut(number) {
            found.signal.write_raw(data, *raw);
        }
    }
    for (found, raw) in &written {
        let frame = frames.iter().find(|(id, _)| *id == found.message.id);
        if frame.and_then(|(_, data)| found.signal.read_raw(data)) != Some(*raw) {
            let said = format!("{} for another page than other signals of the command", found.name);
            return Err(found.key.refuse(map, said, "one page in each message"));
        }
    }
    Ok(())
}
