//! What a run does without where the rig speaks its own messages.

use files::{did_you_mean, quoted};
use report::{Cell, Table};
use std::fmt;
use std::str::FromStr;

/// Declares [`Loss`]: name, what is missing, what is lost by it.
macro_rules! losses {
    ($($(#[$doc:meta])* $variant:ident = $name:literal, $missing:literal, $cost:literal;)*) => {
        /// Something that our protocol has and the messages of a rig do not.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Loss {
            $($(#[$doc])* $variant,)*
        }

        impl Loss {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The name, as `--accept` takes it.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What the messages lack.
            pub const fn missing(self) -> &'static str {
                match self { $(Self::$variant => $missing,)* }
            }

            /// What is lost by it.
            pub const fn cost(self) -> &'static str {
                match self { $(Self::$variant => $cost,)* }
            }
        }
    };
}

losses! {
    /// No session: nothing binds a command to this host and this run.
    NoSession = "no-session", "seal of a session",
        "any node can command the rig, and an old log moves it, until the run is stopped for it";
    /// No CRC that the host knows.
    NoCrc = "no-crc", "CRC over the content",
        "a damaged or mixed-up frame that passes the CRC of CAN is believed";
    /// No readiness.
    NoReadiness = "no-readiness", "key switch, age of the zero, shunt check",
        "the rig is armed whatever they are";
    /// No request to drop the pressure.
    NoPressureOff = "no-pressure-off", "request to drop the pressure",
        "a rig whose displacement is not believed is only commanded to stop";
    /// No echo of commands.
    NoEcho = "no-echo", "echo of the command's counter",
        "the age of a measurement is unknown, and lost commands are not seen";
    /// No counter of measurements.
    NoCounter = "no-counter", "counter of measurements",
        "a rig that repeats its last measurement looks alive, and lost ones are not seen";
    /// No counter of commands.
    NoCommandCounter = "no-command-counter", "counter of commands",
        "the rig cannot tell a new command from one that is repeated";
    /// No velocity in commands.
    NoVelocity = "no-velocity", "velocity of commands",
        "the ram follows positions alone, about a cycle later";
    /// No state of the rig.
    NoState = "no-state", "state of the rig",
        "a rig that has stopped by itself is seen by its motion alone";
    /// No validity of measurements.
    NoValidity = "no-validity", "validity of measurements",
        "a sensor that the rig knows to be bad is believed";
    /// No way to say stop.
    NoStop = "no-stop", "signal that stops the rig",
        "in SAFE the command is brought to rest and held; the rig stays enabled";
    /// No limits of the rig.
    NoLimits = "no-limits", "limits of the rig",
        "those of the scenario alone rule, and the stroke left to the ends is unknown";
    /// No time-out in the rig.
    NoTimeOut = "no-timeout", "time-out for commands in the rig",
        "when this host or the bus fails, the rig goes on with the last command";
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text that names no loss.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InvalidLoss {
    /// The text.
    pub found: String,
}

impl fmt::Display for InvalidLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = Loss::ALL.iter().map(|loss| loss.name()).collect();
        let similar = did_you_mean(&self.found, names.iter().copied());
        write!(
            f,
            "found \"{}\", expected one of {}{similar}",
            quoted(&self.found),
            names.join(", ")
        )
    }
}

impl std::error::Error for InvalidLoss {}

/// ```
/// use hil_host::gateway::Loss;
/// assert_eq!("no-echo".parse(), Ok(Loss::NoEcho));
/// let refused = "no-ecko".parse::<Loss>().unwrap_err().to_string();
/// assert!(refused.ends_with("; did you mean no-echo?"));
/// ```
impl FromStr for Loss {
    type Err = InvalidLoss;

    fn from_str(text: &str) -> Result<Self, InvalidLoss> {
        let named = Self::ALL.iter().find(|loss| loss.name() == text);
        named.copied().ok_or_else(|| InvalidLoss { found: text.to_owned() })
    }
}

/// Names of losses, as `--accept` takes them.
pub(super) fn names(losses: &[Loss]) -> String {
    let names: Vec<&str> = losses.iter().map(|loss| loss.name()).collect();
    names.join(",")
}

/// What a run does without, for the terminal, and what was accepted without need.
pub fn loss_lines(losses: &[Loss], accepted: &[Loss]) -> Vec<String> {
    let table = Table::new("").text("loss").text("accepted").text("missing").text("what it costs");
    let table = table.rows(losses.iter().map(|loss| -> [Cell; 4] {
        let is_accepted = if accepted.contains(loss) { "yes" } else { "no" };
        [loss.name().into(), is_accepted.into(), loss.missing().into(), loss.cost().into()]
    }));
    let mut lines = table.lines();
    let idle = |loss: &&Loss| !losses.contains(loss);
    let idle: Vec<Loss> = accepted.iter().filter(idle).copied().collect();
    if !idle.is_empty() {
        lines.push(format!("note: --accept {}: not lost with these messages", names(&idle)));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_loss_is_named_once() {
        for (number, loss) in Loss::ALL.iter().enumerate() {
            assert_eq!(loss.name().parse(), Ok(*loss));
            assert!(Loss::ALL.iter().skip(number + 1).all(|other| other.name() != loss.name()));
        }
    }

    #[test]
    fn a_loss_that_is_accepted_without_need_is_noted() {
        let (lost, accepted) = ([Loss::NoCrc, Loss::NoEcho], [Loss::NoCrc, Loss::NoState]);
        let lines = loss_lines(&lost, &accepted);
        let row = |name: &str| lines.iter().find(|line| line.starts_with(name)).unwrap();
        assert!(row("no-crc").contains("yes") && row("no-echo").contains("no  "), "{lines:?}");
        assert_eq!(row("note"), "note: --accept no-state: not lost with these messages");
        assert_eq!(loss_lines(&lost, &lost).len(), 3);
    }
}
