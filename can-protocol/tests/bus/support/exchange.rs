//! A host and a rig that arm each other over frames, cycle by cycle.
use can_protocol::arming::{
    Agreement, Configuration, HostArming, HostOutcome, HostPlan, Limits, Listener, Patience, Quiet,
    Readiness, Refusal, Requirements, RigArming, RigEvent, RigStatus,
};
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Frame, Heartbeat, Node, Pace, Profile, RunState, Sender,
    SessionHistory,
};
use std::num::{NonZeroU8, NonZeroU16};

pub(crate) const NODE: Node = Node::ALL[0];
pub(crate) const BOOT: u32 = 0xB007;
pub(crate) const HOST_NUMBER: u32 = 0x1234_5678;
pub(crate) const RIG_NUMBER: u32 = 0xDEAD_BEEF;

pub(crate) const LIMITS: Limits = Limits {
    stroke_um: 20_000,
    velocity_um_per_s: 300_000,
    acceleration_mm_per_s2: 9000,
    force_n: 30_000,
};

pub(crate) const CONFIGURATION: Configuration = Configuration {
    profile: Profile::Classical,
    pace: Pace::Clock,
    period_us: NonZeroU16::new(1000).unwrap(),
    slow_down: NonZeroU8::MIN,
    watchdog_cycles: 5,
    limits: LIMITS,
};

const REQUIREMENTS: Requirements = Requirements {
    enabled: true,
    zero_age_s: 3600,
    shunt_passed: true,
    force_at_rest_n: 200,
    stroke_um: 5000,
};

pub(crate) fn plan(number: u32) -> HostPlan {
    HostPlan {
        node: NODE,
        number,
        asked: LIMITS,
        needed: Limits { force_n: 20_000, ..LIMITS },
        requirements: REQUIREMENTS,
        configuration: CONFIGURATION,
        patience: Patience::default(),
    }
}

pub(crate) fn status() -> RigStatus {
    RigStatus {
        state: RunState::Standby,
        may_reset: true,
        readiness: Readiness {
            boot: BOOT,
            enabled: true,
            zero_age_s: Some(60),
            shunt_passed: true,
            force_at_rest_n: Some(12),
            stroke_out_um: 25_000,
            stroke_in_um: 24_000,
        },
        requirements: REQUIREMENTS,
        configuration: CONFIGURATION,
    }
}

/// A rig with its own state and a source of numbers that counts up from a given one.
pub(crate) struct Rig {
    pub(crate) arming: RigArming,
    pub(crate) status: RigStatus,
    pub(crate) quiet: Quiet,
    pub(crate) next_number: u32,
    pub(crate) events: Vec<RigEvent>,
}

impl Rig {
    pub(crate) fn new(next_number: u32) -> Self {
        Self {
            arming: RigArming::new(NODE, SessionHistory::default()),
            status: status(),
            quiet: Quiet::new(Listener::Rig(NODE)),
            next_number,
            events: Vec::new(),
        }
    }

    /// A rig whose bus has been quiet for long enough.
    pub(crate) fn quiet(next_number: u32) -> Self {
        let mut rig = Self::new(next_number);
        (0..Quiet::CYCLES).for_each(|_| rig.quiet.cycle());
        rig
    }

    pub(crate) fn hear(&mut self, frame: &Frame) -> Option<Frame> {
        self.quiet.hear(frame.id(), frame.data());
        let request = ArmMessage::decode(frame.id(), frame.data()).ok()?;
        let next = &mut self.next_number;
        let draw = || {
            *next = next.wrapping_add(1);
            next.wrapping_sub(1)
        };
        let (answer, event) = self.arming.receive(&request, &self.status, &mut self.quiet, draw);
        self.events.extend(event);
        answer.map(|answer| answer.encode().0)
    }

    pub(crate) fn is_armed(&self) -> bool {
        self.arming.session().is_some()
    }
}

/// A host, its bus and what it counts on it.
pub(crate) struct Host {
    pub(crate) arming: HostArming,
    pub(crate) quiet: Quiet,
}

impl Host {
    pub(crate) fn new(plan: HostPlan) -> Self {
        let arming = HostArming::new(plan, SessionHistory::default());
        Self { arming, quiet: Quiet::new(Listener::Host) }
    }

    pub(crate) fn hear(&mut self, frame: &Frame) {
        self.quiet.hear(frame.id(), frame.data());
        if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data()) {
            self.arming.receive(&answer);
        }
    }

    pub(crate) fn is_done(&self) -> bool {
        !matches!(self.arming.outcome(), HostOutcome::Pending(_))
    }
}

pub(crate) fn heartbeat(sender: Sender, boot: u32) -> Frame {
    Heartbeat::new(sender, 0, RunState::Standby, boot).encode().0
}

/// Runs host and rig until the host is done, and one cycle more. `passes` says of each arming
/// frame, counted from 0 in the order of sending, whether it arrives. Gives all that were sent.
pub(crate) fn run(
    host: &mut Host,
    rig: &mut Rig,
    mut passes: impl FnMut(usize) -> bool,
) -> Vec<Frame> {
    let mut sent = Vec::new();
    for cycle in 0..20_000 {
        let is_last = host.is_done();
        host.quiet.cycle();
        rig.quiet.cycle();
        rig.events.extend(rig.arming.cycle());
        if cycle % 20 == 0 {
            host.hear(&heartbeat(Sender::Rig(NODE), BOOT));
            rig.hear(&heartbeat(Sender::Host, 1));
        }
        if let Some(request) = host.arming.cycle(&host.quiet) {
            let (request, _) = request.encode();
            sent.push(request.clone());
            if passes(sent.len() - 1)
                && let Some(answer) = rig.hear(&request)
            {
                sent.push(answer.clone());
                if passes(sent.len() - 1) {
                    host.hear(&answer);
                }
            }
        }
        if is_last {
            return sent;
        }
    }
    panic!("the exchange does not end: {:?}", host.arming.outcome());
}

/// One whole exchange: how it ended on both sides, and all its frames.
pub(crate) fn exchange(plan: HostPlan, mut rig: Rig) -> (HostOutcome, Rig, Vec<Frame>) {
    let mut host = Host::new(plan);
    let frames = run(&mut host, &mut rig, |_| true);
    (host.arming.outcome(), rig, frames)
}

pub(crate) fn armed(outcome: HostOutcome) -> Agreement {
    let HostOutcome::Armed(agreement) = outcome else { panic!("{outcome:?}") };
    agreement
}

pub(crate) fn refused(plan: HostPlan, rig: Rig) -> Refusal {
    let (outcome, rig, _) = exchange(plan, rig);
    assert!(!rig.is_armed(), "{outcome:?}");
    let HostOutcome::Refused(refusal) = outcome else { panic!("{outcome:?}") };
    refusal
}

pub(crate) fn request(item: ArmItem, value: u32) -> Frame {
    let (side, node, counter, state) = (ArmSide::Host, NODE, 0, RunState::Standby);
    ArmMessage { side, node, counter, state, item, value }.encode().0
}
