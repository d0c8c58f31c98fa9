//! What stopped a bench: one signal, its value and its limit.

use super::rule::Action;

/// What can end a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Signal {
    /// Measurements that do not arrive.
    LostMeasurements,
    /// Commands that the rig does not echo.
    LostCommands,
    /// Measurements that are old or out of step.
    OldMeasurements,
    /// The rig says that its force is invalid, or sends none.
    InvalidForce,
    /// The rig sends no displacement.
    InvalidDisplacement,
    /// Measured force.
    Force,
    /// Change of the measured force.
    ForceRate,
    /// Measured displacement.
    Displacement,
    /// The force sensor repeats one code.
    StuckForce,
    /// Speed of the measured displacement.
    Velocity,
    /// Acceleration of the measured displacement.
    Acceleration,
    /// Measured displacement less the command that it answers.
    Tracking,
    /// The displacement sensor repeats one code.
    StuckDisplacement,
    /// Work that the damper gives back.
    Work,
    /// Temperature of the damper.
    Temperature,
    /// Measured force less that of the slot's model.
    Residual,
    /// The rig has left RUN.
    RigState,
    /// A guard or limit of the rig.
    RigTrip,
    /// A fault that the rig reports.
    RigFault,
    /// A rig that is silent.
    SilentRig,
    /// Measurements that come and all fail their CRC: damaged, or not sealed by this session.
    WrongSeal,
    /// Commands that the bus has no room for.
    BusQueue,
    /// A bus that is down.
    BusDown,
    /// Samples of the track that are not there when the vehicle comes.
    Track,
    /// A motion that grows towards the end of the stroke.
    Growth,
    /// A command that its limits would change.
    CommandLimit,
    /// Frames of a second sender under an id of this session.
    SecondSender,
    /// The residual delay, measured before the force acts.
    Delay,
    /// The gain of the loop over wear in software, measured before the force acts.
    WearLoopGain,
    /// The error that wear in software makes, measured before the force acts.
    WearForceError,
    /// An estimate of an adaptive compensator that stays beyond its bounds.
    Compensation,
    /// The vehicle has left its track, or its numbers.
    Vehicle,
    /// An operator.
    Operator,
}

impl Signal {
    /// All signals.
    pub const ALL: [Self; 33] = [
        Self::LostMeasurements,
        Self::LostCommands,
        Self::OldMeasurements,
        Self::InvalidForce,
        Self::InvalidDisplacement,
        Self::Force,
        Self::ForceRate,
        Self::Displacement,
        Self::StuckForce,
        Self::Velocity,
        Self::Acceleration,
        Self::Tracking,
        Self::StuckDisplacement,
        Self::Work,
        Self::Temperature,
        Self::Residual,
        Self::RigState,
        Self::RigTrip,
        Self::RigFault,
        Self::SilentRig,
        Self::WrongSeal,
        Self::BusQueue,
        Self::BusDown,
        Self::Track,
        Self::Growth,
        Self::CommandLimit,
        Self::SecondSender,
        Self::Delay,
        Self::WearLoopGain,
        Self::WearForceError,
        Self::Compensation,
        Self::Vehicle,
        Self::Operator,
    ];

    /// Its key in `summary.json`.
    pub const fn key(self) -> &'static str {
        match self {
            Self::LostMeasurements => "lost_measurements",
            Self::LostCommands => "lost_commands",
            Self::OldMeasurements => "old_measurements",
            Self::InvalidForce => "invalid_force",
            Self::InvalidDisplacement => "invalid_displacement",
            Self::Force => "force",
            Self::ForceRate => "force_rate",
            Self::Displacement => "displacement",
            Self::StuckForce => "stuck_force",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Tracking => "tracking",
            Self::StuckDisplacement => "stuck_displacement",
            Self::Work => "work",
            Self::Temperature => "temperature",
            Self::Residual => "residual",
            Self::RigState => "rig_state",
            Self::RigTrip => "rig_trip",
            Self::RigFault => "rig_fault",
            Self::SilentRig => "silent_rig",
            Self::WrongSeal => "wrong_seal",
            Self::BusQueue => "bus_queue",
            Self::BusDown => "bus_down",
            Self::Track => "track",
            Self::Growth => "growth",
            Self::CommandLimit => "command_limit",
            Self::SecondSender => "second_sender",
            Self::Delay => "delay",
            Self::WearLoopGain => "wear_loop_gain",
            Self::WearForceError => "wear_force_error",
            Self::Compensation => "compensation",
            Self::Vehicle => "vehicle",
            Self::Operator => "operator",
        }
    }

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LostMeasurements => "lost measurements",
            Self::LostCommands => "lost commands",
            Self::OldMeasurements => "old measurements",
            Self::InvalidForce => "cycles with an invalid force",
            Self::InvalidDisplacement => "cycles without a displacement",
            Self::Force => "measured force",
            Self::ForceRate => "change of the measured force",
            Self::Displacement => "measured displacement",
            Self::StuckForce => "cycles with the same force",
            Self::Velocity => "speed of the measured displacement",
            Self::Acceleration => "acceleration of the measured displacement",
            Self::Tracking => "measured displacement less command",
            Self::StuckDisplacement => "cycles with the same displacement",
            Self::Work => "work of the damper over a cycle of the motion",
            Self::Temperature => "temperature of the damper",
            Self::Residual => "rms of the measured force less that of the model",
            Self::RigState => "state of the rig",
            Self::RigTrip => "guard or limit of the rig",
            Self::RigFault => "fault of the rig",
            Self::SilentRig => "silent rig",
            Self::WrongSeal => "measurements with a wrong CRC",
            Self::BusQueue => "commands without room on the bus",
            Self::BusDown => "bus down",
            Self::Track => "track not there in time",
            Self::Growth => "size of a motion that is growing beyond the stroke",
            Self::CommandLimit => "command beyond its limits",
            Self::SecondSender => "second sender on",
            Self::Delay => "residual delay",
            Self::WearLoopGain => "gain of the loop over wear in software",
            Self::WearForceError => "error of the wear in software",
            Self::Compensation => "estimate of the compensator beyond its bounds",
            Self::Vehicle => "vehicle off its track",
            Self::Operator => "stopped by the operator",
        }
    }

    /// Whether it is the measured force that cannot be believed.
    pub const fn is_of_force(self) -> bool {
        matches!(
            self,
            Self::InvalidForce
                | Self::Force
                | Self::ForceRate
                | Self::StuckForce
                | Self::Work
                | Self::Residual
        )
    }

    /// The unit of its value and limit; none where they are codes or mean nothing.
    pub const fn unit(self) -> Option<&'static str> {
        match self {
            Self::Force | Self::Residual => Some("N"),
            Self::ForceRate => Some("N per cycle"),
            Self::Velocity => Some("m/s"),
            Self::Acceleration => Some("m/s2"),
            Self::Displacement | Self::Tracking | Self::Growth => Some("m"),
            Self::Temperature => Some("degC"),
            Self::Delay => Some("s"),
            Self::Work => Some("J"),
            Self::LostMeasurements
            | Self::LostCommands
            | Self::OldMeasurements
            | Self::InvalidForce
            | Self::InvalidDisplacement
            | Self::StuckForce
            | Self::StuckDisplacement
            | Self::WrongSeal
            | Self::BusQueue => Some("cycles"),
            Self::RigState
            | Self::RigTrip
            | Self::RigFault
            | Self::SilentRig
            | Self::CommandLimit
            | Self::BusDown
            | Self::Track
            | Self::SecondSender
            | Self::WearLoopGain
            | Self::WearForceError
            | Self::Compensation
            | Self::Vehicle
            | Self::Operator => None,
        }
    }
}

/// What stopped a bench, or asks for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cause {
    /// The signal.
    pub signal: Signal,
    /// Its value, in the unit of the signal, or a code.
    pub value: f64,
    /// The limit, in the same unit; infinite where there is none.
    pub limit: f64,
    /// What it asks for.
    pub action: Action,
}

impl Cause {
    /// A fact, which has no limit and asks for a stop; its value is a code, or 1.
    pub const fn fact(signal: Signal, value: f64) -> Self {
        Self { signal, value, limit: f64::INFINITY, action: Action::Stop }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_are_listed_in_their_own_order() {
        assert!(Signal::ALL.iter().enumerate().all(|(n, signal)| *signal as usize == n));
    }

    #[test]
    fn keys_and_names_are_unique() {
        for (n, one) in Signal::ALL.into_iter().enumerate() {
            for other in Signal::ALL.into_iter().skip(n + 1) {
                assert!(one.key() != other.key() && one.name() != other.name(), "{one:?}");
            }
        }
    }

    #[test]
    fn units_and_forces_that_are_not_believed_go_with_the_name() {
        for signal in Signal::ALL {
            let named = signal.name().contains("force");
            // What a command or the work says of the force, its name does not say.
            assert_eq!(signal.is_of_force(), named || signal == Signal::Work, "{signal:?}");
            let is_counted = signal.name().contains("cycles")
                || signal.name().contains("measurements")
                || signal.name().starts_with("lost")
                || signal == Signal::BusQueue;
            assert_eq!(signal.unit() == Some("cycles"), is_counted, "{signal:?}");
        }
        let forces = [Signal::Force, Signal::Residual].map(Signal::unit);
        assert_eq!((forces, Signal::Operator.unit()), ([Some("N"); 2], None));
    }
}
