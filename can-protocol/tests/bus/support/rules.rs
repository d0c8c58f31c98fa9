//! The rules of the bus, as the comment of `yawbench.dbc` states them.
use can_protocol::arming::{DBC_HASH, Patience, Quiet, RigArming};
use can_protocol::{ArmItem, FaultCode, MessageId, SessionHistory};

/// The comment on the bus, one sentence after the other; no double quotes in a DBC.
pub(crate) fn rules() -> String {
    let (arming, sealed, counters) = (arming(), sealed(), counters());
    format!(
        "yawbench: a locomotive model (HOST) and damper rigs (RIG_1 to RIG_4). \
         {SAFETY}{arming}{FRAMES}{sealed}{counters}"
    )
}

/// What a rig owes to its surroundings, armed or not.
const SAFETY: &str = "SAFE means: the rig decelerates within its limit of acceleration and holds its \
        position under its own controller while its displacement is believed. Where the \
        displacement is invalid, stuck, reversed or runs away from the command, a rig holds no \
        position: it shuts its valve or drops the pressure by itself. \
        This protocol is no safety function and claims no PL or SIL: emergency stop, guard door \
        and pressure dump are hard-wired, and the limits of the bench controller rule. \
        PRESSURE_OFF: a rig obeys in every state, armed or not, whatever the counter is. \
        Watchdog: from its first accepted CMD on, an armed rig goes SAFE by itself when it has \
        accepted no new one for the agreed number of cycles, 5 by default, counted in cycles also \
        under slow-down. \
        A rig whose key switch no longer enables motion goes SAFE. \
        SAFE and FAULT are left by a reset only, by key at the rig or by RESET on the bus; no SYNC, \
        no CMD and no new run ends them, and a reset leads to INIT, never to motion. \
        A rig sends HEARTBEAT from its start, in every state; its boot number is drawn anew at each \
        start. It sends the slow messages of a cycle before its MEAS. ";

/// Bytes, values and the plain CRC.
const FRAMES: &str = "All ids are standard. Byte order: little-endian (Intel) throughout. \
        Physical value = code x factor, rounded half to even; saturate at the limits, never wrap. \
        CRC of 6- and 8-byte frames: CRC-8 SAE J1850, polynomial 0x1D, start 0xFF, final xor 0xFF, \
        not reflected, check of 123456789 = 0x4B, in byte 0. \
        CRC of 16-byte frames: CRC-16/CCITT-FALSE, polynomial 0x1021, start 0xFFFF, final xor \
        0x0000, not reflected, check of 123456789 = 0x29B1, in bytes 0 and 1, low byte first. \
        Both run over the two bytes of the DataID (not sent, high byte first) and then over all \
        payload bytes behind the CRC. DataID = 0x5000 + frame id, also given as an attribute. ";

/// The exchange before motion.
fn arming() -> String {
    let code = |item: ArmItem| format!("{item} (0x{:04X})", item.code());
    let Patience { repeat_cycles, attempts, .. } = Patience::default();
    format!(
        "Arming, by ARM_REQUEST and ARM_ANSWER, plain CRC: the host sends an item and a value, \
         repeats it every {repeat_cycles} cycles at most {attempts} times, and goes on when the rig \
         has answered. \
         1. {} with h; the rig answers {} with a fresh number r, the same r while h stays the same. \
         2. {}, {}, {} and {} with the host's limit; the rig answers the same item with the smaller \
         of that and its own limit. \
         3. {}, {}, {}, {}, {}, {} and {} with 0; the rig answers its boot number, 1 or 0, the age \
         of the load cell's zero, 1 or 0, the magnitude of the force at rest, and the stroke left \
         to either end; all ones mean unknown. \
         4. {} with c; the rig answers its own c when it is equal. c is the CRC-32 of zlib over 28 \
         bytes: version, profile, pace and slow_down in one byte each, period_us and watchdog in \
         cycles in two, stroke, velocity, acceleration and force as agreed and the hash of this \
         file in four, low byte first. The hash of this file is the CRC-32 over its BO_ and SG_ \
         lines in their order, without those of the messages TRACK_*, each without white space \
         at its ends and with one line feed behind \
         it: 0x{DBC_HASH:08X}. \
         5. {} with r xor c: the one frame that arms, in STANDBY and with all of the above in \
         order. The rig answers {} with h xor c, or {} with the cycles that are missing to {} \
         without another host or a second node, after which the host asks again. \
         To any item the rig may answer {} with the code of the item that stands against it, also \
         {}; the exchange is then over and the next one has another r. \
         Reset of a latched rig: {} as above, then {} with r; the rig answers {} with h. ",
        code(ArmItem::HostNumber),
        code(ArmItem::RigNumber),
        code(ArmItem::Stroke),
        code(ArmItem::Velocity),
        code(ArmItem::Acceleration),
        code(ArmItem::Force),
        code(ArmItem::Alive),
        code(ArmItem::Enabled),
        code(ArmItem::ZeroAge),
        code(ArmItem::ShuntCheck),
        code(ArmItem::ForceAtRest),
        code(ArmItem::StrokeOut),
        code(ArmItem::StrokeIn),
        code(ArmItem::Configuration),
        code(ArmItem::Arm),
        code(ArmItem::Armed),
        code(ArmItem::Quiet),
        Quiet::CYCLES,
        code(ArmItem::Refused),
        code(ArmItem::State),
        ArmItem::HostNumber,
        code(ArmItem::Reset),
        ArmItem::Reset,
    )
}

/// The CRC of an armed session.
fn sealed() -> String {
    format!(
        "That CRC is plain. CMD and MEAS of an armed rig are sealed: after the DataID and before the \
         payload the CRC register is xored with mask = (s + k * (2 * s + 1)) mod 2^w. The session \
         code s is the CRC-16/CCITT-FALSE over h and then r, four bytes each, low byte first; w is \
         8 for a CRC-8 and 16 for a CRC-16; k is the sender's cycle divided by 15 (8-bit counters: \
         255) without remainder, and the counter is the remainder. The cycle of either sender is 0 \
         in its first frame after ARMED. A rig draws r anew until the low byte of s is not 0 and \
         not that of one of its last {} sessions. A receiver takes the cycle from the counter and \
         the last accepted cycle, and never takes up a sender that started again. A rig sends its \
         first MEAS after it has accepted a sealed CMD; one that accepts none within {} cycles of \
         ARMED goes back to STANDBY. A frame of 15, 30 \
         and so on cycles ago fails in 255 of 256 cases (CRC-16: 65535 of 65536), a foreign frame \
         passes by chance once in 256 (65536). ",
        SessionHistory::SESSIONS,
        RigArming::FIRST_COMMAND_CYCLES,
    )
}

/// What a rig does with a message, in the comment of that message.
pub(crate) fn duties(message: MessageId) -> &'static str {
    match message {
        MessageId::PressureOff(_) => {
            "A rig goes to FAULT from every state and sends FAULT PRESSURE_LOST. The counter is not \
             judged. "
        }
        MessageId::Sync => {
            "A rig in INIT or STANDBY that can do this goes to STANDBY and sends a HEARTBEAT at \
             once. One that cannot sends FAULT CONFIGURATION_MISMATCH once and no HEARTBEAT for it, \
             and is in INIT: the host takes a HEARTBEAT of any other state for consent. From ARMED \
             on it refuses other values likewise and stays in its state; SAFE and FAULT take \
             nothing from it and answer with a HEARTBEAT. "
        }
        MessageId::Command(..) => {
            "The position is that of the damper's eyes where the cycle begins, counted from \
             mid-stroke. With x and v the ram is at x + v T at the end of the period T in \
             FOLLOW_WITH_VELOCITY, at x in FOLLOW. Before the first CMD of a session a cycle is \
             period_us times slow_down of the rig's own time. A CMD that cannot be obeyed moves the \
             echo, is answered and feeds no watchdog. A step of more than v_max T, with the agreed \
             v_max, from the last CMD that was followed (n CMD later: n times that, at most 5) is \
             not followed; after two in a row the rig goes SAFE and sends FAULT VELOCITY_LIMIT. \
             Before a first one the step counts from where the ram stands, with n = 5. STANDBY ends \
             the session. "
        }
        MessageId::Measurement(..) => {
            "Sampled at the end of the cycle, after its CMD. One MEAS, the last sealed one, answers \
             a STANDBY; in SAFE and FAULT each accepted CMD is answered as well. "
        }
        MessageId::Fault(_) => {
            "Sent once when it changes. A rig need not hear that of the host. The counter is not \
             judged. "
        }
        MessageId::Telemetry(_) | MessageId::Residual(_) => "The counter is not judged. ",
        MessageId::TrackRequest => {
            "From a locomotive that has no memory for its track. With count 0 the track server \
             answers with one TRACK_OFFER for each item in the order of their codes, and first \
             means nothing. Otherwise it answers with the samples first to first + count - 1, of \
             each CENTRE_LINE and then RAILS, at most one sample per millisecond; beyond the end \
             of the track it answers nothing. A newer request, of any session, replaces one that \
             is still being served: a server has one locomotive. A question which track it is \
             replaces none. A frame that is damaged is ignored. A locomotive repeats what is not \
             answered within 20 of its cycles, asks for the first sample that it lacks, and asks \
             once more now and then which track it is. It gives up before a run after 5000 cycles, \
             and in a run when the track is not there as the vehicle comes. "
        }
        MessageId::TrackOffer => {
            "Plain CRC. It does not change while a server runs. FIRST_UM is the distance of sample \
             0 from the start of the run, two's complement, STEP_UM the distance from one sample \
             to the next, SAMPLES their number one way. WAYS is 1 where the track ends with them, \
             2 where it is run there and back and there again, without an end: number n is then \
             the sample n, or on the way back 2 * (SAMPLES - 1) - n, and so on; the samples at \
             both ends come once, and no sign changes. FINGERPRINT is the CRC-32 of zlib over \
             FIRST_UM, STEP_UM and WAYS, four bytes each, then the codes of the first 262144 \
             samples or of all of one way, vertical, alignment, cross level and gauge, three bytes \
             each in two's complement; low byte first in all of these. "
        }
        MessageId::TrackSample(_) => {
            "Always sealed; the worked frame is the same without the seal. The code s is as for \
             CMD, where h is the session of the request, with 0 in the upper two of its four \
             bytes, and r is FINGERPRINT. The mask is the upper byte of (s + k * (2 * s + 1)) mod \
             65536, where k is the number of the sample in the whole track divided by 15 without \
             remainder; the field number is that number modulo 256. INVALID is never sent, and \
             such a sample is not taken. "
        }
        MessageId::ArmRequest(_) => {
            "The counter is not judged: the host may have started again. ARM is repeated until it \
             is answered; to the same ARM the rig answers ARMED again. REFUSED from the host ends \
             the exchange, and an armed session without a first CMD; it has no answer. The watchdog \
             of 5 cycles stands in the hash only: no item negotiates it. Before ARMED both sides \
             count 300 quiet cycles; signs of a bus that is not quiet are a HEARTBEAT of the host \
             with another boot number, a CMD to a rig that is not armed, another HOST_NUMBER within \
             an exchange, and a frame under an own id. "
        }
        MessageId::ArmAnswer(_) => {
            "The counter is not judged. A stroke counts from mid-stroke; the stroke left is the \
             nearer of ram and damper. A rig in INIT, which has heard no SYNC that it can take, \
             answers HOST_NUMBER with REFUSED and STATE. "
        }
        MessageId::Heartbeat(_) => {
            "The counter is not judged. It goes on in every state, with flag_latched in SAFE and \
             FAULT. "
        }
    }
}

/// Counters, echo and pace.
fn counters() -> String {
    format!(
        "Counter: 4-bit 0 to 14, then 0 again, 15 is invalid; 8-bit 0 to 254, then 0 again, 255 is \
         invalid; one counter per message and sender. \
         Echo: the counter last accepted from the peer, 15 (8-bit: 255) when there was none yet. \
         A receiver accepts a counter step of 1, and larger ones up to its own limit as lost \
         frames; it ignores step 0 and all others. Only accepted frames feed a watchdog. A frame \
         with the counter of the last one and another content shows a second sender. \
         The host announces profile, pace and period by SYNC; one bus runs either the classical or \
         the FD variants of CMD and MEAS. FD frames are sent with bit-rate switch. \
         A rig sends one MEAS per cycle and echoes the newest CMD. FAULT codes below {} are of the \
         link, the others of the bench. \
         TRACK is a server of the track for a HOST on a board that has no memory for it; no rig \
         has to know the messages TRACK_*.",
        FaultCode::ForceLimit.code()
    )
}
