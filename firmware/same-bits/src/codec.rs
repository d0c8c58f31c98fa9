//! The codec: physical values to frames and back, plain and sealed, and frames of random bytes.

use crate::random::Random;
use can_protocol::{
    Command, Frame, Measurement, MeasurementFlags, Message, Mode, Node, Pressure, Profile,
    Residual, RunState, Seal, SessionCode, Telemetry, Trips, Watch,
};
use firmware_core::fnv;

/// Most bytes of a frame.
const BYTES_MAX: usize = 64;

/// Frames and values of so many rounds; none where the node is none.
#[inline(never)]
pub fn run(steps: u32) -> Option<u64> {
    let node = Node::new(1).ok()?;
    let code = SessionCode::of(0x1234_5678, 0x9abc_def0);
    let mut random = Random::new(2211);
    let mut hash = fnv::START;
    for step in 0..steps {
        let profile = if step % 2 == 0 { Profile::Classical } else { Profile::Fd };
        let counter = (step % 15) as u8;
        let (command, measurement) = pair(node, counter, &mut random);
        let slow = slow(node, counter, &mut random);
        for message in
            [Message::Command(command), Message::Measurement(measurement)].iter().chain(&slow)
        {
            let (frame, saturated) = message.encode(profile);
            hash = fnv::add(with_frame(hash, &frame), u64::from(saturated.bits()));
            hash = with_decoded(hash, frame.id(), frame.data());
        }
        let seal = Seal { code, cycle: step + 1 };
        hash = with_frame(hash, &command.encode_sealed(profile, seal).0);
        hash = with_frame(hash, &measurement.encode_sealed(profile, seal).0);
        let mut bytes = [0; BYTES_MAX];
        for byte in &mut bytes {
            *byte = random.byte();
        }
        let length = usize::from(random.byte()) % BYTES_MAX;
        let id = random.word() as u16 & 0x7ff;
        hash = with_decoded(hash, id, bytes.get(..length)?);
    }
    Some(hash)
}

/// The messages of a cycle; values reach a little beyond what fits.
fn pair(node: Node, counter: u8, random: &mut Random) -> (Command, Measurement) {
    let displacement_m = Some(0.2 * random.within_one());
    let command = Command {
        node,
        counter,
        state: RunState::Run,
        mode: Mode::Follow,
        echo: Some(counter),
        displacement_m,
        velocity_m_per_s: Some(2.0 * random.within_one()),
        time_us: None,
    };
    let measurement = Measurement {
        node,
        counter,
        state: RunState::Run,
        flags: MeasurementFlags::empty(),
        echo: Some(counter),
        force_n: Some(60e3 * random.within_one()),
        displacement_m,
        time_us: None,
    };
    (command, measurement)
}

fn slow(node: Node, counter: u8, random: &mut Random) -> [Message; 2] {
    let state = RunState::Run;
    let temperature_degc = Some(150.0 * random.within_one());
    let (pressure, trips) = (Pressure::Ready, Trips::empty());
    let rms_n = Some(30e3 * (1.0 + random.within_one()));
    [
        Message::Telemetry(Telemetry { node, counter, state, temperature_degc, pressure, trips }),
        Message::Residual(Residual { node, counter, state, rms_n, watch: Watch::Steady }),
    ]
}

fn with_frame(hash: u64, frame: &Frame) -> u64 {
    let words = frame.data().iter().map(|byte| u64::from(*byte));
    words.fold(fnv::add(hash, u64::from(frame.id())), fnv::add)
}

/// Values that a receiver reads, or that it reads none.
fn with_decoded(hash: u64, id: u16, data: &[u8]) -> u64 {
    let value = |value: Option<f64>| value.map_or(0, f64::to_bits);
    let words = match Message::decode(id, data) {
        Ok(Message::Command(c)) => [value(c.displacement_m), value(c.velocity_m_per_s)],
        Ok(Message::Measurement(m)) => [value(m.force_n), value(m.displacement_m)],
        Ok(Message::Telemetry(t)) => [value(t.temperature_degc), 1],
        Ok(Message::Residual(r)) => [value(r.rms_n), 2],
        Ok(_) => [3; 2],
        Err(_) => [4; 2],
    };
    words.into_iter().fold(hash, fnv::add)
}
