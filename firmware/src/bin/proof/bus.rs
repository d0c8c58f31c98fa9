//! Every entry point of `can-protocol`.

use core::hint::black_box;
use core::num::{NonZeroU8, NonZeroU16};

use can_protocol::arming::{
    Configuration, HostArming, HostPlan, Limits, Listener, Patience, Quiet, Readiness,
    Requirements, RigArming, RigStatus,
};
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, BusPlan, Command, Cyclic, Fault, FaultCode, Frame, Heartbeat,
    Measurement, MeasurementFlags, Message, Mode, Node, Pace, Pressure, PressureOff, Profile,
    Receiver, ReceiverState, Residual, RunState, Seal, Sender, SessionCode, SessionHistory, Sync,
    Telemetry, TrackFingerprint, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample,
    TrackSeal, Trips, Watch, from_embedded, to_embedded,
};
use embedded_can::Id;

/// All of it once.
pub(crate) fn run() {
    let Ok(node) = Node::new(black_box(1)) else { return };
    let Ok(sender) = Sender::new(black_box(1)) else { return };
    let profile = black_box(Profile::Classical);
    let state = black_box(RunState::Run);
    for message in black_box(messages(node, sender, state)) {
        let (frame, saturated) = message.encode(profile);
        black_box(saturated);
        decode(&frame);
    }
    receive::<Command>(profile, node);
    receive::<Measurement>(profile, node);
    session(profile, node);
    arm(node);
    let plan = BusPlan {
        profile,
        rigs: black_box(4),
        rate_hz: black_box(1e3),
        nominal_bits_per_s: black_box(1e6),
        data_bits_per_s: black_box(5e6),
    };
    black_box((plan.verdict(), plan.background_load()));
}

/// A frame on its way to a driver and back, and its content.
fn decode(frame: &Frame) {
    if let Some(driver) = to_embedded::<Driver>(frame)
        && let Some((id, data)) = from_embedded(black_box(&driver))
    {
        black_box(Message::decode(id, data).is_ok());
    }
    // Whatever a bus may bring, of any length.
    let bytes = black_box([0; 64]);
    let length = black_box(8).min(bytes.len());
    let received = bytes.get(..length).unwrap_or(&bytes);
    if let Ok(message) = Message::decode(black_box(0x101), received) {
        black_box(message);
    }
}

/// A receiver with a frame, and without one.
fn receive<M: Cyclic>(profile: Profile, node: Node) {
    let Ok(follower) = Receiver::<M>::new(profile, node, black_box(5)) else { return };
    let mut state = ReceiverState::default();
    black_box(&mut state);
    let bytes = black_box([0; 16]);
    let length = black_box(8).min(bytes.len());
    let received = bytes.get(..length).unwrap_or(&bytes);
    if let Some(reception) = follower.accept(&mut state, black_box(0x101), received) {
        black_box(reception);
    }
    black_box((follower.no_frame(&mut state), state.echo()));
    let sent = profile.next_counter(black_box(0));
    black_box(profile.counter_steps(black_box(0), sent));
}

/// A sealed frame and its receiver.
fn session(profile: Profile, node: Node) {
    let mut history = black_box(SessionHistory::default());
    let code = SessionCode::of(black_box(1), black_box(2));
    if history.allows(code) {
        history.remember(code);
    }
    let seal = Seal { code, cycle: black_box(1000) };
    for message in black_box(messages(node, Sender::Host, RunState::Run)) {
        let frame = match message {
            Message::Command(command) => command.encode_sealed(profile, seal).0,
            Message::Measurement(measurement) => measurement.encode_sealed(profile, seal).0,
            Message::TrackSample(sample) => {
                let seal = TrackSeal::new(black_box(1), black_box(2));
                let frame = sample.encode_sealed(seal, black_box(3)).0;
                let decoded = TrackSample::decode_sealed(frame.id(), frame.data(), seal, 3);
                black_box(decoded.is_ok());
                frame
            }
            _ => continue,
        };
        black_box(&frame);
    }
    let Ok(follower) = Receiver::<Command>::new(profile, node, black_box(5)) else { return };
    let follower = follower.sealed(code);
    let mut state = ReceiverState::default();
    black_box(&mut state);
    let bytes = black_box([0; 64]);
    let length = black_box(8).min(bytes.len());
    let received = bytes.get(..length).unwrap_or(&bytes);
    if let Some(reception) = follower.accept(&mut state, black_box(0x101), received) {
        black_box(reception);
    }
    black_box(state.cycle());
    let mut fingerprint = TrackFingerprint::new(black_box(0), black_box(1), black_box(2));
    fingerprint.add(black_box([0.0; 4]));
    black_box(fingerprint.value());
}

/// Both sides of the arming exchange.
fn arm(node: Node) {
    let number = black_box(1_u32);
    let limits = Limits {
        stroke_um: number,
        velocity_um_per_s: number,
        acceleration_mm_per_s2: number,
        force_n: number,
    };
    let configuration = Configuration {
        profile: Profile::Classical,
        pace: Pace::Clock,
        period_us: NonZeroU16::MIN,
        slow_down: NonZeroU8::MIN,
        watchdog_cycles: 5,
        limits,
    };
    let requirements = Requirements {
        enabled: true,
        zero_age_s: number,
        shunt_passed: true,
        force_at_rest_n: number,
        stroke_um: number,
    };
    let readiness = Readiness {
        boot: number,
        enabled: true,
        zero_age_s: Some(number),
        shunt_passed: true,
        force_at_rest_n: Some(number),
        stroke_out_um: number,
        stroke_in_um: number,
    };
    let state = black_box(RunState::Standby);
    let status = RigStatus { state, may_reset: true, readiness, requirements, configuration };
    let (asked, needed, patience) = (limits, limits, Patience::default());
    let plan = HostPlan { node, number, asked, needed, requirements, configuration, patience };
    let mut quiet = Quiet::new(black_box(Listener::Rig(node)));
    let mut rig = RigArming::new(node, SessionHistory::default());
    for mut host in [HostArming::new(plan, SessionHistory::default()), HostArming::reset(plan)] {
        black_box((&mut host, &mut rig, &mut quiet));
        quiet.cycle();
        quiet.hear(black_box(0x701), black_box(&[0; 8]));
        black_box(rig.cycle());
        rig.commanded();
        if let Some(request) = host.cycle(&quiet) {
            let (answer, event) = rig.receive(&request, &status, &mut quiet, || black_box(7));
            if let Some(answer) = answer {
                host.receive(&answer);
            }
            black_box(event);
        }
        black_box((host.outcome(), rig.session(), rig.history()));
        rig.end_session();
    }
}

/// One of each message.
fn messages(node: Node, sender: Sender, state: RunState) -> [Message; 12] {
    [
        Message::Sync(Sync {
            version: 1,
            profile: Profile::Classical,
            pace: Pace::Clock,
            period_us: NonZeroU16::MIN,
            slow_down: NonZeroU8::MIN,
            time_us: 0,
        }),
        Message::Command(Command {
            node,
            counter: 0,
            state,
            mode: Mode::Follow,
            echo: None,
            displacement_m: Some(0.0),
            velocity_m_per_s: Some(0.0),
            time_us: None,
        }),
        Message::Measurement(Measurement {
            node,
            counter: 0,
            state,
            flags: MeasurementFlags::empty(),
            echo: None,
            force_n: Some(0.0),
            displacement_m: Some(0.0),
            time_us: None,
        }),
        Message::Fault(Fault { sender, counter: 0, state, code: FaultCode::PeerSilent, detail: 0 }),
        Message::Telemetry(Telemetry {
            node,
            counter: 0,
            state,
            temperature_degc: Some(0.0),
            pressure: Pressure::Ready,
            trips: Trips::empty(),
        }),
        Message::Residual(Residual {
            node,
            counter: 0,
            state,
            rms_n: Some(0.0),
            watch: Watch::Steady,
        }),
        Message::PressureOff(PressureOff {
            node: Some(node),
            counter: 0,
            state,
            code: FaultCode::Sensor,
            detail: 0,
        }),
        Message::TrackRequest(TrackRequest { session: 0, first: 0, count: 0 }),
        Message::TrackOffer(TrackOffer { session: 0, item: TrackItem::First, value: 0 }),
        Message::TrackSample(TrackSample {
            part: TrackPart::Rails,
            number: 0,
            channels_m: [Some(0.0); 2],
        }),
        Message::Arm(ArmMessage {
            side: ArmSide::Host,
            node,
            counter: 0,
            state,
            item: ArmItem::Arm,
            value: 0,
        }),
        Message::Heartbeat(Heartbeat::new(sender, 0, state, 0)),
    ]
}

/// A driver's frame, as small as the trait allows.
struct Driver {
    id: Id,
    remote: bool,
    length: usize,
    data: [u8; 64],
}

impl embedded_can::Frame for Driver {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut frame = Self::new_remote(id, data.len())?;
        frame.remote = false;
        frame.data.iter_mut().zip(data).for_each(|(to, from)| *to = *from);
        Some(frame)
    }

    fn new_remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 64).then_some(Self { id: id.into(), remote: true, length, data: [0; 64] })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        self.data.get(..self.length).unwrap_or(&self.data)
    }
}
