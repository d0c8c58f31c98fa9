//! The text of `yawbench.dbc`, written from the crate's own constants.
use super::rules::{duties, rules};
use can_protocol::signal::{Field, FixedPoint, Quantity};
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Command, CommandLayout, Fault, FaultCode, Heartbeat,
    HeartbeatFlags, Measurement, MeasurementFlags, MeasurementLayout, Message, MessageId, Mode,
    PROTOCOL_VERSION, Pace, Pressure, PressureOff, Profile, Residual, RunState, Seal, Sender,
    SessionCode, Sync, Telemetry, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample,
    TrackSeal, Trips, Watch, protection,
};
use std::fmt::Write as _;
use std::num::{NonZeroU8, NonZeroU16};

/// One `SG_` line with its value table and comment.
struct Row {
    name: String,
    start_bit: u32,
    bits: u32,
    /// Factor, minimum and maximum as text; signed when the minimum is below zero.
    factor: String,
    minimum: String,
    maximum: String,
    unit: &'static str,
    values: Vec<(i64, String)>,
    comment: String,
}

/// The whole file.
pub(crate) fn dbc_text() -> String {
    let mut out = format!("VERSION \"yawbench {PROTOCOL_VERSION}\"\n\nNS_ :\n\nBS_:\n\n");
    out += "BU_: HOST RIG_1 RIG_2 RIG_3 RIG_4 TRACK\n";
    for message in MessageId::all() {
        let (id, length) = (message.raw(), message.payload_len());
        write!(out, "\nBO_ {id} {message}: {length} {}\n", transmitter(message)).expect("string");
        for row in rows(message) {
            let sign = if row.minimum.starts_with('-') { '-' } else { '+' };
            let Row { name, start_bit, bits, factor, minimum, maximum, unit, .. } = &row;
            writeln!(
                out,
                " SG_ {name} : {start_bit}|{bits}@1{sign} ({factor},0) [{minimum}|{maximum}] \
                 \"{unit}\" {}",
                receivers(message)
            )
            .expect("string");
        }
    }
    out += "\n";
    out += &comments();
    out += &attributes();
    out += &value_tables();
    out
}

fn transmitter(message: MessageId) -> String {
    match message {
        MessageId::Sync
        | MessageId::PressureOff(_)
        | MessageId::Command(..)
        | MessageId::Residual(_)
        | MessageId::TrackRequest
        | MessageId::ArmRequest(_) => "HOST".into(),
        MessageId::TrackOffer | MessageId::TrackSample(_) => "TRACK".into(),
        MessageId::Measurement(_, node)
        | MessageId::Telemetry(node)
        | MessageId::ArmAnswer(node) => format!("RIG_{node}"),
        MessageId::Fault(sender) | MessageId::Heartbeat(sender) => match sender {
            Sender::Host => "HOST".into(),
            Sender::Rig(node) => format!("RIG_{node}"),
        },
    }
}

fn receivers(message: MessageId) -> String {
    match message {
        MessageId::Command(_, node)
        | MessageId::ArmRequest(node)
        | MessageId::PressureOff(Some(node)) => format!("RIG_{node}"),
        MessageId::TrackRequest => "TRACK".into(),
        _ if transmitter(message) == "HOST" => "RIG_1,RIG_2,RIG_3,RIG_4".into(),
        _ => "HOST".into(),
    }
}

fn code(name: &str, field: Field, comment: &str) -> Row {
    Row {
        name: name.into(),
        start_bit: field.start_bit(),
        bits: field.bits(),
        factor: "1".into(),
        minimum: "0".into(),
        maximum: field.ones().to_string(),
        unit: "",
        values: Vec::new(),
        comment: comment.into(),
    }
}

/// A code whose last value means none: the maximum is one less.
fn counted(name: &str, field: Field, none: &str, comment: &str) -> Row {
    Row {
        maximum: (field.ones() - 1).to_string(),
        values: vec![(i64::from(field.ones()), none.into())],
        ..code(name, field, comment)
    }
}

fn counter(field: Field) -> Row {
    counted("counter", field, "INVALID", "Sequence number.")
}

fn table<'a>(
    name: &str,
    field: Field,
    values: impl Iterator<Item = (u16, &'a str)>,
    comment: &str,
) -> Row {
    let values = values.map(|(code, name)| (i64::from(code), name.into())).collect();
    Row { values, ..code(name, field, comment) }
}

fn state(field: Field) -> Row {
    let states = RunState::ALL.iter().map(|state| (u16::from(state.code()), state.name()));
    table("state", field, states, "Run state of the sender; codes 9 to 15 are reserved.")
}

/// One signal per bit.
fn bits<'a>(prefix: &str, field: Field, names: impl Iterator<Item = &'a str>) -> Vec<Row> {
    let rows = names.zip(field.start_bit()..).map(|(name, start_bit)| Row {
        name: format!("{prefix}_{}", name.to_lowercase()),
        start_bit,
        bits: 1,
        maximum: "1".into(),
        values: vec![(0, "NO".into()), (1, "YES".into())],
        ..code("", field, "")
    });
    rows.collect()
}

fn fixed(name: &str, signal: FixedPoint, comment: &str) -> Row {
    let (unit, per_si) = match signal.quantity() {
        Quantity::Displacement => ("mm", 1e3),
        Quantity::Velocity => ("mm/s", 1e3),
        Quantity::Force => ("N", 1.0),
        Quantity::Temperature => ("degC", 1.0),
    };
    let physical = |code: i32| (f64::from(code) * per_si / signal.lsb_per_unit()).to_string();
    Row {
        name: name.into(),
        start_bit: signal.field().start_bit(),
        bits: signal.field().bits(),
        factor: physical(1),
        minimum: physical(-signal.max_code()),
        maximum: physical(signal.max_code()),
        unit,
        values: vec![(i64::from(signal.invalid_code()), "INVALID".into())],
        comment: format!("{comment} Saturates at the limits; the most negative code is invalid."),
    }
}

fn time(field: Field) -> Row {
    let comment = "Clock of the sender, modulo the field; all ones mean none.";
    Row { unit: "us", ..counted("time_us", field, "NONE", comment) }
}

fn rows(message: MessageId) -> Vec<Row> {
    let echo = |field| counted("echo", field, "NONE", "Counter last accepted from the peer.");
    let displacement = "Damper displacement, extension positive, from mid-stroke.";
    let mut rows = match message {
        MessageId::Sync => vec![
            code("version", Sync::VERSION, "Protocol version; peers of different ones do not arm."),
            table("profile", Sync::PROFILE, [(0, "CLASSICAL"), (1, "FD")].into_iter(), ""),
            table(
                "pace",
                Sync::PACE,
                [Pace::Clock, Pace::LockStep].into_iter().map(|pace| (pace as u16, pace.name())),
                "CLOCK: a command every period. LOCK_STEP: the next command when all have echoed.",
            ),
            Row {
                unit: "us",
                minimum: "1".into(),
                ..code("period_us", Sync::PERIOD, "Length of a cycle in the model.")
            },
            Row {
                minimum: "1".into(),
                ..code("slow_down", Sync::SLOW_DOWN, "Wall time over model time; real rigs: 1.")
            },
            Row { unit: "us", ..code("time_us", Sync::TIME, "Clock of the host, modulo 2^24.") },
        ],
        MessageId::Command(profile, _) => {
            let layout = CommandLayout::of(profile);
            let modes = Mode::ALL.iter().map(|mode| (u16::from(mode.code()), mode.name()));
            let mut rows = vec![
                counter(layout.counter),
                state(layout.state),
                echo(layout.echo),
                table(
                    "mode",
                    layout.mode,
                    modes,
                    "HOLD: hold position, values unused. FOLLOW: reach the displacement. \
                 FOLLOW_WITH_VELOCITY: the same with velocity feed-forward. CENTRE: go to \
                 mid-stroke at the rig's own slow rate.",
                ),
                fixed("displacement_mm", layout.displacement, displacement),
                fixed("velocity_mm_per_s", layout.velocity, "Rate of the displacement."),
            ];
            rows.extend(layout.time.map(time));
            rows
        }
        MessageId::Measurement(profile, _) => {
            let layout = MeasurementLayout::of(profile);
            let mut rows = vec![
                counter(layout.counter),
                state(layout.state),
                echo(layout.echo),
                fixed("force_n", layout.force, "Damper force, tension positive."),
                fixed("displacement_mm", layout.displacement, displacement),
            ];
            let flags = MeasurementFlags::all();
            let meanings = [
                "A value of this frame is at the end of its range on the wire.",
                "A limit of the rig (stroke, rate, force) changed the command.",
                "A sensor failed its own check.",
                "The actuator is further behind its command than the rig allows.",
            ];
            let mut flags = bits("flag", layout.flags, flags.iter_names().map(|(name, _)| name));
            for (row, meaning) in flags.iter_mut().zip(meanings) {
                row.comment = meaning.into();
            }
            rows.extend(flags);
            rows.extend(layout.time.map(time));
            rows
        }
        MessageId::Fault(_) => fault(),
        MessageId::Telemetry(_) => telemetry(),
        MessageId::Residual(_) => residual(),
        MessageId::PressureOff(_) => vec![
            counter(PressureOff::COUNTER),
            state(PressureOff::STATE),
            fault_code(PressureOff::CODE, "Why; any code, listed or not, drops the pressure."),
            code("detail", PressureOff::DETAIL, "How much, as in FAULT."),
        ],
        MessageId::TrackRequest => track_request(),
        MessageId::TrackOffer => track_offer(),
        MessageId::TrackSample(part) => track_sample(part),
        MessageId::ArmRequest(_) | MessageId::ArmAnswer(_) => vec![
            counter(ArmMessage::COUNTER),
            state(ArmMessage::STATE),
            table(
                "item",
                ArmMessage::ITEM,
                ArmItem::ALL.iter().map(|item| (item.code(), item.name())),
                "What is asked or answered; the high byte is the page. Other codes are reserved.",
            ),
            code("value", ArmMessage::VALUE, "The item's value, by the comment on the bus."),
        ],
        MessageId::Heartbeat(_) => heartbeat(),
    };
    rows.push(code("crc", protection::crc_field(message), ""));
    rows.sort_by_key(|row| row.start_bit);
    rows
}

fn fault() -> Vec<Row> {
    vec![
        counter(Fault::COUNTER),
        state(Fault::STATE),
        fault_code(Fault::CODE, "What went wrong; a code that is not listed is still a fault."),
        code("detail", Fault::DETAIL, "How much, by the code: limits in per mille."),
    ]
}

fn fault_code(field: Field, comment: &str) -> Row {
    let codes = FaultCode::LISTED.iter().map(|fault| (fault.code(), fault.name()));
    table("code", field, codes, comment)
}

fn heartbeat() -> Vec<Row> {
    let mut rows = vec![
        counter(Heartbeat::COUNTER),
        state(Heartbeat::STATE),
        code("boot", Heartbeat::BOOT, "Number that the sender drew at its start."),
        code("version", Heartbeat::VERSION, "Protocol version of the sender."),
        code("sender", Heartbeat::SENDER, "0 host, else the rig; the same as in the id."),
    ];
    let meanings = [
        "Motion is enabled by the key switch of the rig; the host sends NO.",
        "The rig is latched in SAFE or FAULT until it is reset; the host sends NO.",
    ];
    let flags = HeartbeatFlags::all();
    let mut flags = bits("flag", Heartbeat::FLAGS, flags.iter_names().map(|(name, _)| name));
    for (row, meaning) in flags.iter_mut().zip(meanings) {
        row.comment = meaning.into();
    }
    rows.extend(flags);
    rows
}

fn telemetry() -> Vec<Row> {
    let states = Pressure::ALL.iter().map(|state| (u16::from(state.code()), state.name()));
    let mut rows = vec![
        counter(Telemetry::COUNTER),
        state(Telemetry::STATE),
        fixed("temperature_degc", Telemetry::TEMPERATURE, "Temperature of the damper."),
        table("pressure", Telemetry::PRESSURE, states, "State of the supply pressure."),
    ];
    let trips = Trips::all();
    rows.extend(bits("trip", Telemetry::TRIPS, trips.iter_names().map(|(name, _)| name)));
    rows
}

fn residual() -> Vec<Row> {
    let states = Watch::ALL.iter().map(|state| (u16::from(state.code()), state.name()));
    let rms = "Running rms of the rig's measured force less that of the host's model.";
    vec![
        counter(Residual::COUNTER),
        state(Residual::STATE),
        fixed("residual_rms_n", Residual::RMS, rms),
        table("watch", Residual::WATCH, states, "How the residual stands to its limit."),
    ]
}

fn track_request() -> Vec<Row> {
    vec![
        code("count", TrackRequest::COUNT, "Samples wanted; 0 asks which track this is."),
        code(
            "session",
            TrackRequest::SESSION,
            "Number that the locomotive has drawn for this run.",
        ),
        code("first", TrackRequest::FIRST, "Number of the first sample wanted."),
    ]
}

fn track_offer() -> Vec<Row> {
    let items = TrackItem::ALL.iter().map(|item| (u16::from(item.code()), item.name()));
    vec![
        table("item", TrackOffer::ITEM, items, "Which property; other codes are reserved."),
        code("session", TrackOffer::SESSION, "Session of the request."),
        code("value", TrackOffer::VALUE, "Value of the property."),
    ]
}

fn track_sample(part: TrackPart) -> Vec<Row> {
    let [first, second] = TrackSample::CHANNELS;
    let number = code("number", TrackSample::NUMBER, "Number of the sample, modulo 256.");
    match part {
        TrackPart::CentreLine => vec![
            number,
            fixed("vertical_mm", first, "Mean of both rails, positive down."),
            fixed("alignment_mm", second, "Mean of both rails, positive right."),
        ],
        TrackPart::Rails => vec![
            number,
            fixed(
                "cross_level_mm",
                first,
                "Right rail less left, positive where the right one is lower.",
            ),
            fixed("gauge_mm", second, "Gauge less nominal, positive where it is wider."),
        ],
    }
}

/// A message to show in the comments: some values that fill the fields well.
fn worked(message: MessageId) -> Message {
    let (state, temperature_degc) = (RunState::Run, Some(41.25));
    let (displacement_m, force_n) = (Some(3.46e-3), Some(-17_999.8));
    match message {
        MessageId::Sync => Message::Sync(Sync {
            version: PROTOCOL_VERSION,
            profile: Profile::Fd,
            pace: Pace::Clock,
            period_us: NonZeroU16::new(500).expect("not 0"),
            slow_down: NonZeroU8::MIN,
            time_us: 1_000_000,
        }),
        MessageId::Command(profile, node) => Message::Command(Command {
            node,
            counter: if profile == Profile::Fd { 200 } else { 3 },
            state,
            mode: Mode::FollowWithVelocity,
            echo: Some(2),
            displacement_m,
            velocity_m_per_s: Some(-0.076),
            time_us: (profile == Profile::Fd).then_some(1_234_567_890),
        }),
        MessageId::Measurement(profile, node) => Message::Measurement(Measurement {
            node,
            counter: if profile == Profile::Fd { 199 } else { 2 },
            state,
            flags: MeasurementFlags::LIMIT_REACHED,
            echo: Some(3),
            force_n,
            displacement_m,
            time_us: (profile == Profile::Fd).then_some(1_193_046),
        }),
        MessageId::Fault(sender) => Message::Fault(Fault {
            sender,
            counter: 5,
            state: RunState::Safe,
            code: FaultCode::PeerSilent,
            detail: 7,
        }),
        MessageId::Telemetry(node) => Message::Telemetry(Telemetry {
            node,
            counter: 14,
            state,
            temperature_degc,
            pressure: Pressure::Ready,
            trips: Trips::STROKE_LIMIT | Trips::WATCHDOG,
        }),
        MessageId::Residual(node) => Message::Residual(Residual {
            node,
            counter: 7,
            state,
            rms_n: Some(412.3),
            watch: Watch::Drift,
        }),
        MessageId::PressureOff(node) => Message::PressureOff(PressureOff {
            node,
            counter: 3,
            state: RunState::Safe,
            code: FaultCode::Sensor,
            detail: 2,
        }),
        MessageId::TrackRequest => {
            Message::TrackRequest(TrackRequest { session: 0x1234, first: 1000, count: 64 })
        }
        MessageId::TrackOffer => Message::TrackOffer(TrackOffer {
            session: 0x1234,
            item: TrackItem::Fingerprint,
            value: 0xDEAD_BEEF,
        }),
        MessageId::TrackSample(part) => Message::TrackSample(TrackSample {
            part,
            number: (1000 % 256) as u8,
            channels_m: [Some(-1.5e-3), Some(2.000_01e-3)],
        }),
        MessageId::ArmRequest(node) => Message::Arm(ArmMessage {
            side: ArmSide::Host,
            node,
            counter: 4,
            state: RunState::Standby,
            item: ArmItem::HostNumber,
            value: 0x1234_5678,
        }),
        MessageId::ArmAnswer(node) => Message::Arm(ArmMessage {
            side: ArmSide::Rig,
            node,
            counter: 5,
            state: RunState::Standby,
            item: ArmItem::RigNumber,
            value: 0xDEAD_BEEF,
        }),
        MessageId::Heartbeat(sender) => {
            Message::Heartbeat(Heartbeat::new(sender, 7, state, 0xDEAD_BEEF))
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

fn comments() -> String {
    let mut out = format!("CM_ \"{}\";\n", rules());
    for message in MessageId::all() {
        let profile = message.profile();
        let (frame, _) = worked(message).encode(profile);
        let data = frame.data();
        let data_id = message.data_id();
        let (name, over, range) = match protection::crc_field(message).bits() {
            8 => ("CRC-8 SAE J1850 start 0xFF xor 0xFF", &data[1..], "0 to 14"),
            _ => ("CRC-16/CCITT-FALSE start 0xFFFF xor 0x0000", &data[2..], "0 to 254"),
        };
        let counter = match message {
            MessageId::Sync => "No counter: the time advances.".to_string(),
            MessageId::TrackRequest | MessageId::TrackOffer => "No counter.".to_string(),
            MessageId::TrackSample(_) => "The number counts 0 to 255.".to_string(),
            _ => format!("Counter {range}."),
        };
        let check = format!(
            "{name}, DataID 0x{data_id:04X}. {counter} The CRC below runs over {} {}.",
            hex(&data_id.to_be_bytes()),
            hex(over)
        );
        writeln!(
            out,
            "CM_ BO_ {} \"Little-endian. {check} {}{}Worked frame: {} ({}).\";",
            message.raw(),
            duties(message),
            sealed(message),
            hex(data),
            worked(message)
        )
        .expect("string");
        for row in rows(message).iter().filter(|row| !row.comment.is_empty()) {
            writeln!(out, "CM_ SG_ {} {} \"{}\";", message.raw(), row.name, row.comment)
                .expect("string");
        }
    }
    out
}

/// The worked frame of an armed session, for the messages that are sealed.
fn sealed(message: MessageId) -> String {
    let seal = Seal { code: SessionCode::of(0x1234_5678, 0xDEAD_BEEF), cycle: 1000 };
    let profile = message.profile();
    let (frame, _) = match worked(message) {
        Message::Command(command) => command.encode_sealed(profile, seal),
        Message::Measurement(measurement) => measurement.encode_sealed(profile, seal),
        Message::TrackSample(sample) => return sealed_sample(&sample),
        _ => return String::new(),
    };
    format!(
        "Sealed frame: {} (numbers 0x12345678 and 0xDEADBEEF, session code 0x{:04X}, cycle {}, \
         mask 0x{:02X}). ",
        hex(frame.data()),
        seal.code.bits(),
        seal.cycle,
        seal.mask(profile)
    )
}

/// The same for a sample of the track.
fn sealed_sample(sample: &TrackSample) -> String {
    let seal = TrackSeal::new(0x1234, 0xDEAD_BEEF);
    let (frame, _) = sample.encode_sealed(seal, 1000);
    format!(
        "Sealed frame: {} (session 0x1234, fingerprint 0xDEADBEEF, code 0x{:04X}, sample 1000, \
         mask 0x{:02X}). ",
        hex(frame.data()),
        seal.code(),
        seal.mask(1000)
    )
}

fn attributes() -> String {
    let reserved = "\"reserved\",";
    let mut out = format!(
        "BA_DEF_ \"BusType\" STRING ;\n\
         BA_DEF_ \"ProtocolVersion\" INT 0 15;\n\
         BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",{}\"StandardCAN_FD\",\
         \"ExtendedCAN_FD\";\n\
         BA_DEF_ BO_ \"CANFD_BRS\" ENUM \"0\",\"1\";\n\
         BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n\
         BA_DEF_ BO_ \"CycleTimeUs\" INT 0 1000000;\n\
         BA_DEF_ BO_ \"DataID\" INT 0 65535;\n\
         BA_DEF_DEF_ \"BusType\" \"CAN\";\n\
         BA_DEF_DEF_ \"ProtocolVersion\" {PROTOCOL_VERSION};\n\
         BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n\
         BA_DEF_DEF_ \"CANFD_BRS\" \"0\";\n\
         BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n\
         BA_DEF_DEF_ \"CycleTimeUs\" 0;\n\
         BA_DEF_DEF_ \"DataID\" 0;\n\
         BA_ \"BusType\" \"CAN FD\";\n\
         BA_ \"ProtocolVersion\" {PROTOCOL_VERSION};\n",
        reserved.repeat(12)
    );
    for message in MessageId::all() {
        let id = message.raw();
        if message.profile() == Profile::Fd {
            writeln!(out, "BA_ \"VFrameFormat\" BO_ {id} 14;\nBA_ \"CANFD_BRS\" BO_ {id} 1;")
                .expect("string");
        }
        if let Some(period_us) = message.nominal_period_us() {
            // The standard attribute counts whole milliseconds; the FD pair is faster than that.
            let period_ms = period_us.div_ceil(1000);
            writeln!(out, "BA_ \"GenMsgCycleTime\" BO_ {id} {period_ms};").expect("string");
            writeln!(out, "BA_ \"CycleTimeUs\" BO_ {id} {period_us};").expect("string");
        }
        writeln!(out, "BA_ \"DataID\" BO_ {id} {};", message.data_id()).expect("string");
    }
    out
}

fn value_tables() -> String {
    let mut out = String::new();
    for message in MessageId::all() {
        for row in rows(message).iter().filter(|row| !row.values.is_empty()) {
            write!(out, "VAL_ {} {}", message.raw(), row.name).expect("string");
            for (code, name) in &row.values {
                write!(out, " {code} \"{name}\"").expect("string");
            }
            out += " ;\n";
        }
    }
    out
}
