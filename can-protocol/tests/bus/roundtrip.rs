//! A round trip keeps values within half an lsb; what does not fit is reported; nothing panics.
use crate::support::samples;
use can_protocol::signal::FixedPoint;
use can_protocol::{
    CommandLayout, MeasurementFlags, MeasurementLayout, Message, MessageId, Profile, Receiver,
    ReceiverState, Residual, Saturated, Telemetry, TrackSample, protection,
};
use proptest::prelude::*;

/// Whether `read` is what `signal` makes of `sent`, and the flag reports it.
fn same(signal: FixedPoint, sent: Option<f64>, read: Option<f64>, saturated: bool) -> bool {
    let half_lsb = 0.5 / signal.lsb_per_unit();
    let limit = signal.max_value();
    match (sent, read) {
        (None, None) => !saturated,
        (Some(sent), None) => sent.is_nan() && saturated,
        (None, Some(_)) => false,
        (Some(sent), Some(read)) if sent.abs() <= limit + half_lsb => {
            // A value within rounding of the limit itself may go either way.
            let at_edge = (sent.abs() - limit - half_lsb).abs() < 1e-9 * limit;
            (read - sent).abs() <= half_lsb * (1.0 + 1e-6) && (!saturated || at_edge)
        }
        (Some(sent), Some(read)) => saturated && read == limit.copysign(sent),
    }
}

fn check(profile: Profile, sent: &Message) {
    let (frame, saturated) = sent.encode(profile);
    let read = Message::decode(frame.id(), frame.data()).expect("our own frame");
    let has = |flag| saturated.contains(flag);
    match (sent, read) {
        (Message::Command(sent), Message::Command(read)) => {
            let layout = CommandLayout::of(profile);
            let (x, v) = (Saturated::DISPLACEMENT, Saturated::VELOCITY);
            assert!(same(layout.displacement, sent.displacement_m, read.displacement_m, has(x)));
            assert!(same(layout.velocity, sent.velocity_m_per_s, read.velocity_m_per_s, has(v)));
            let (displacement_m, velocity_m_per_s) = (None, None);
            let bare =
                |message| can_protocol::Command { displacement_m, velocity_m_per_s, ..message };
            assert_eq!(bare(*sent), bare(read));
        }
        (Message::Measurement(sent), Message::Measurement(read)) => {
            let layout = MeasurementLayout::of(profile);
            let (f, x) = (Saturated::FORCE, Saturated::DISPLACEMENT);
            assert!(same(layout.force, sent.force_n, read.force_n, has(f)));
            assert!(same(layout.displacement, sent.displacement_m, read.displacement_m, has(x)));
            let flagged = read.flags.contains(MeasurementFlags::SATURATED);
            assert_eq!(
                flagged,
                !saturated.is_empty() || sent.flags.contains(MeasurementFlags::SATURATED)
            );
            let bare = |message| can_protocol::Measurement {
                force_n: None,
                displacement_m: None,
                flags: MeasurementFlags::empty(),
                ..message
            };
            assert_eq!(bare(*sent), bare(read));
            assert_eq!(
                read.flags - MeasurementFlags::SATURATED,
                sent.flags - MeasurementFlags::SATURATED
            );
        }
        (Message::Telemetry(sent), Message::Telemetry(read)) => {
            let (signal, flag) = (Telemetry::TEMPERATURE, Saturated::TEMPERATURE);
            assert!(same(signal, sent.temperature_degc, read.temperature_degc, has(flag)));
            let bare = |message| Telemetry { temperature_degc: None, ..message };
            assert_eq!(bare(*sent), bare(read));
        }
        (Message::Residual(sent), Message::Residual(read)) => {
            assert!(same(Residual::RMS, sent.rms_n, read.rms_n, has(Saturated::FORCE)));
            let bare = |message| Residual { rms_n: None, ..message };
            assert_eq!(bare(*sent), bare(read));
        }
        (Message::TrackSample(sent), Message::TrackSample(read)) => {
            let signals = TrackSample::CHANNELS;
            let pairs = || sent.channels_m.into_iter().zip(read.channels_m).zip(signals);
            // One flag stands for both.
            let fits = |((sent, read), signal)| same(signal, sent, read, false);
            assert_eq!(pairs().all(fits), !has(Saturated::TRACK));
            assert!(pairs().all(|((sent, read), signal)| {
                same(signal, sent, read, false) || same(signal, sent, read, true)
            }));
            let bare = |sample| TrackSample { channels_m: [None; 2], ..sample };
            assert_eq!(bare(*sent), bare(read));
        }
        (sent, read) => {
            assert_eq!(*sent, read);
            assert!(saturated.is_empty());
        }
    }
    // A decoded message says the same again, bit for bit.
    if let Message::Measurement(_) | Message::Command(_) = read {
        assert_eq!(read.encode(profile).0, frame);
        assert!(read.encode(profile).1.is_empty());
    }
}

proptest! {
    #![proptest_config(samples::config(20_000))]

    #[test]
    fn every_message_survives_its_frame((message, profile) in samples::message()) {
        check(profile, &message);
    }

    /// Any id, any length, any bytes, with the right CRC every other time so that the decoder
    /// gets past it.
    #[test]
    fn no_bytes_panic_the_decoder(
        id in prop_oneof![any::<u16>(), 0_u16..0x800],
        ours in any::<prop::sample::Index>(),
        bytes in prop::collection::vec(any::<u8>(), 0..=64),
        seal in any::<bool>(),
    ) {
        let _ = Message::decode(id, &bytes);
        let all: Vec<MessageId> = MessageId::all().collect();
        let message = all[ours.index(all.len())];
        let mut payload = bytes;
        if seal {
            payload.resize(message.payload_len(), 0);
            let crc = protection::checksum(message, &payload).to_le_bytes();
            {
                let field = protection::crc_field(message);
                let length = field.bits() as usize / 8;
                payload[..length].copy_from_slice(&crc[..length]);
            }
        }
        if let Ok(read) = Message::decode(message.raw(), &payload) {
            let _ = read.to_string();
            prop_assert_eq!(payload.len(), message.payload_len());
        }
        let receiver = Receiver::<can_protocol::Measurement>::new(
            Profile::Fd, can_protocol::Node::ALL[0], 3,
        ).unwrap();
        let _ = receiver.accept(&mut ReceiverState::default(), message.raw(), &payload);
    }
}

#[test]
fn every_length_of_every_id_is_judged() {
    for id in 0..=0x7FF {
        for length in 0..=64 {
            let decoded = Message::decode(id, &vec![0xA5; length]);
            // No message accepts these bytes: their CRC is wrong under every id.
            assert!(decoded.is_err(), "{id:#x} {length}");
        }
    }
}
