//! A minimal host, for tests of the rig in virtual time.

use can_protocol::arming::{
    Configuration, HostArming, HostOutcome, HostPlan, Limits, Listener, Patience, Quiet,
    Requirements,
};
use can_protocol::{
    ArmMessage, Command, Frame, Mode, Node, PROTOCOL_VERSION, Pace, Profile, RunState, Seal,
    SessionCode, SessionHistory, Sync,
};
use core::num::{NonZeroU8, NonZeroU16};
use hil_host::bus::WireFrame;
use scenario::rig::{RigFile, RigSetup};

/// The laboratory rig.
pub(crate) fn setup() -> RigSetup {
    RigFile::default_setup().unwrap()
}

/// The motion of all tests: 3.5 Hz, 3.46 mm.
pub(crate) fn motion(time_s: f64) -> (f64, f64) {
    let (amplitude_m, omega) = (3.46e-3, core::f64::consts::TAU * 3.5);
    (amplitude_m * libm::sin(omega * time_s), amplitude_m * omega * libm::cos(omega * time_s))
}

/// What a host sends.
#[derive(Debug, Clone)]
pub(crate) struct Host {
    pub(crate) node: Node,
    pub(crate) profile: Profile,
    /// Number of the next command: of the session, once there is one.
    pub(crate) sent: u32,
    pub(crate) cycle: u32,
    /// Its number in the exchange.
    pub(crate) number: u32,
    /// The session; commands are plain without one.
    pub(crate) code: Option<SessionCode>,
}

impl Host {
    pub(crate) fn new(profile: Profile) -> Self {
        Self { node: Node::ALL[0], profile, sent: 0, cycle: 0, number: 0x1234_5678, code: None }
    }

    pub(crate) fn sync_message(&self, pace: Pace) -> Sync {
        Sync {
            version: PROTOCOL_VERSION,
            profile: self.profile,
            pace,
            period_us: NonZeroU16::new(1000).unwrap(),
            slow_down: NonZeroU8::MIN,
            time_us: self.cycle * 1000,
        }
    }

    /// What it asks of a rig that has had this sync.
    pub(crate) fn plan(&self, sync: &Sync) -> HostPlan {
        let limits = Limits {
            stroke_um: 100_000,
            velocity_um_per_s: 500_000,
            acceleration_mm_per_s2: 20_000,
            force_n: 100_000,
        };
        HostPlan {
            node: self.node,
            number: self.number,
            asked: limits,
            needed: limits,
            requirements: Requirements {
                enabled: true,
                zero_age_s: 3600,
                shunt_passed: true,
                force_at_rest_n: 2000,
                stroke_um: 5000,
            },
            configuration: Configuration {
                profile: sync.profile,
                pace: sync.pace,
                period_us: sync.period_us,
                slow_down: sync.slow_down,
                watchdog_cycles: 5,
                limits,
            },
            patience: Patience::default(),
        }
    }

    /// Arms a rig that has had this sync; `pass` sends a frame, lets a cycle pass and gives what
    /// has arrived.
    pub(crate) fn arm(
        &mut self,
        sync: &Sync,
        pass: impl FnMut(Option<Frame>) -> Vec<WireFrame>,
    ) -> SessionCode {
        let exchange = HostArming::new(self.plan(sync), SessionHistory::default());
        match Self::exchange(exchange, pass) {
            HostOutcome::Armed(agreement) => {
                (self.code, self.sent) = (Some(agreement.code()), 0);
                agreement.code()
            }
            refused => panic!("{refused:?}"),
        }
    }

    /// One exchange to its end.
    pub(crate) fn exchange(
        mut exchange: HostArming,
        mut pass: impl FnMut(Option<Frame>) -> Vec<WireFrame>,
    ) -> HostOutcome {
        let mut quiet = Quiet::new(Listener::Host);
        while let HostOutcome::Pending(_) = exchange.outcome() {
            quiet.cycle();
            let question = exchange.cycle(&quiet).map(|message| message.encode().0);
            for frame in pass(question) {
                quiet.hear(frame.id(), frame.data());
                if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data()) {
                    exchange.receive(&answer);
                }
            }
        }
        exchange.outcome()
    }

    /// The next command of the motion.
    pub(crate) fn run(&mut self) -> Frame {
        let (x, v) = motion(f64::from(self.cycle) * 1e-3);
        self.say(RunState::Run, Mode::FollowWithVelocity, Some(x), Some(v))
    }

    pub(crate) fn state(&mut self, state: RunState) -> Frame {
        self.say(state, Mode::Hold, None, None)
    }

    pub(crate) fn say(
        &mut self,
        state: RunState,
        mode: Mode,
        displacement_m: Option<f64>,
        velocity_m_per_s: Option<f64>,
    ) -> Frame {
        let modulus = u32::from(self.profile.counter_modulus());
        let command = Command {
            node: self.node,
            counter: (self.sent % modulus) as u8,
            state,
            mode,
            echo: None,
            displacement_m,
            velocity_m_per_s,
            time_us: Some(self.cycle * 1000),
        };
        let seal = self.code.map(|code| Seal { code, cycle: self.sent });
        self.sent += 1;
        self.cycle += 1;
        match seal {
            Some(seal) => command.encode_sealed(self.profile, seal).0,
            None => command.encode(self.profile).0,
        }
    }
}
