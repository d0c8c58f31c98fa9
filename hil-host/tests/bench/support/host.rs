//! A minimal host, for tests of the rig in virtual time.

use can_protocol::{Command, Frame, Mode, Node, PROTOCOL_VERSION, Pace, Profile, RunState, Sync};
use core::num::{NonZeroU8, NonZeroU16};
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
    pub(crate) counter: u8,
    pub(crate) cycle: u32,
}

impl Host {
    pub(crate) fn new(profile: Profile) -> Self {
        Self { node: Node::ALL[0], profile, counter: 0, cycle: 0 }
    }

    pub(crate) fn sync(&self, pace: Pace) -> Frame {
        self.sync_message(pace).encode()
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
        let command = Command {
            node: self.node,
            counter: self.counter,
            state,
            mode,
            echo: None,
            displacement_m,
            velocity_m_per_s,
            time_us: Some(self.cycle * 1000),
        };
        self.counter = self.profile.next_counter(self.counter);
        self.cycle += 1;
        command.encode(self.profile).0
    }
}
