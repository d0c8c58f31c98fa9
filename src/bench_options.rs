//! Options that the commands of the bench share: numbers of the scenario, frames on the wire, real
//! time.

use crate::error::CommandError;
use crate::output::stem;
use crate::value::{ValueError, number};
use can_protocol::Profile;
use clap::{Args, ValueEnum};
use files::{ResultFolder, quoted};
use hil_host::realtime::RealtimeOptions;
use scenario::run::{Overrides, Rate};
use std::fmt;
use std::num::NonZeroU8;
use std::path::{Path, PathBuf};
use std::str::FromStr;

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ProfileChoice {
    /// Classical CAN, 8 bytes, 1 kHz alone.
    Classical,
    /// CAN FD with bit-rate switch, 16 bytes.
    Fd,
}

/// A result that is printed, and written where a folder is named.
#[derive(Debug, Args)]
pub(crate) struct PrintedArgs {
    /// Folder for the files of the result [default: nothing is written].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier result in that folder.
    #[arg(long, requires = "out")]
    overwrite: bool,
    /// Print the result as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

impl PrintedArgs {
    /// The folder for these files, which does not hold the scenario; none where none is named.
    ///
    /// # Errors
    /// The folder holds other files, or the scenario.
    pub(crate) fn folder(
        &self,
        scenario: &Path,
        command: &'static str,
        files: &[&str],
    ) -> Result<Option<ResultFolder>, CommandError> {
        let Some(out) = &self.out else { return Ok(None) };
        let folder = ResultFolder::fresh(Some(out), &stem(scenario), command, self.overwrite)?;
        folder.check(files)?;
        folder.refuse_inputs([scenario])?;
        Ok(Some(folder))
    }
}

/// Numbers in the place of the scenario's.
#[derive(Debug, Args)]
pub(crate) struct OverrideArgs {
    /// Another duration (s).
    #[arg(long, value_name = "S",
        value_parser = number("a duration from 0.001 to 86400 s", |s| (1e-3..=86_400.0).contains(&s)))]
    duration: Option<f64>,
    /// Another speed (km/h).
    #[arg(long, value_name = "KMH",
        value_parser = number("a speed over 0 and up to 600 km/h", |kmh| kmh > 0.0 && kmh <= 600.0))]
    speed_kmh: Option<f64>,
    /// Another rate of the control loop (Hz). Rigs need --profile fd above 1000.
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<Rate>,
}

impl OverrideArgs {
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides { duration_s: self.duration, speed_kmh: self.speed_kmh, rate: self.rate }
    }
}

#[derive(Debug, Args)]
pub(crate) struct WireArgs {
    /// Frames on the wire.
    #[arg(long, value_enum, default_value_t = ProfileChoice::Classical)]
    profile: ProfileChoice,
    /// Bit rate, for the bus load (bit/s), such as 500k or 1M.
    #[arg(long, value_name = "BITS", default_value = "1M")]
    pub(crate) bitrate: BitRate,
    /// Bit rate of the data phase, for the bus load (bit/s), such as 2M or 5M.
    #[arg(long, value_name = "BITS", default_value = "5M")]
    pub(crate) data_bitrate: BitRate,
}

impl WireArgs {
    pub(crate) fn profile(&self) -> Profile {
        self.profile.into()
    }
}

impl From<ProfileChoice> for Profile {
    fn from(choice: ProfileChoice) -> Self {
        match choice {
            ProfileChoice::Classical => Self::Classical,
            ProfileChoice::Fd => Self::Fd,
        }
    }
}

/// A value of an option: what was found and what was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct InvalidValue {
    found: String,
    expected: &'static str,
}

impl fmt::Display for InvalidValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {}, expected {}", quoted(&self.found), self.expected)
    }
}

impl std::error::Error for InvalidValue {}

/// A bit rate (bit/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BitRate(pub(crate) f64);

impl FromStr for BitRate {
    type Err = InvalidValue;

    fn from_str(text: &str) -> Result<Self, InvalidValue> {
        let expected = "a bit rate in bit/s from 1k to 20M, such as 500k or 1M";
        let invalid = || InvalidValue { found: text.to_owned(), expected };
        let (number, unit) = match text.strip_suffix(['k', 'K']) {
            Some(number) => (number, 1e3),
            None => text.strip_suffix('M').map_or((text, 1.0), |number| (number, 1e6)),
        };
        let rate = number.parse::<f64>().map_err(|_| invalid())? * unit;
        if (1e3..=20e6).contains(&rate) { Ok(Self(rate)) } else { Err(invalid()) }
    }
}

/// The rate of `--rate`.
pub(crate) fn rate(text: &str) -> Result<Rate, InvalidValue> {
    let found = text.parse().ok().and_then(Rate::of_hz);
    found.ok_or_else(|| InvalidValue { found: text.to_owned(), expected: "1000, 2000 or 4000 Hz" })
}

/// The factor of `--slow-down`.
pub(crate) fn slow_down(text: &str) -> Result<NonZeroU8, InvalidValue> {
    let expected = "a whole number from 1 to 255";
    text.parse().map_err(|_| InvalidValue { found: text.to_owned(), expected })
}

/// Where Linux lists its processors, those that are isolated included.
const PROCESSORS: &str = "/sys/devices/system/cpu";

/// The number of a processor that this machine has.
fn processor(text: &str) -> Result<usize, ValueError> {
    let is_listed = |number: usize| {
        let listed = Path::new(PROCESSORS);
        // Without a list the kernel decides, and the run reports what it refuses.
        !listed.join("cpu0").exists() || listed.join(format!("cpu{number}")).exists()
    };
    let last = || (0_usize..).take_while(|number| is_listed(*number)).take(4096).last();
    let expected = || match last() {
        None | Some(0) => "0, the only processor of this machine".to_owned(),
        Some(last) => format!("a processor of this machine, 0 to {last}"),
    };
    let number = text.parse().ok().filter(|number| is_listed(*number));
    number.ok_or_else(|| ValueError::new(expected()))
}

#[derive(Debug, Args)]
pub(crate) struct RealtimeArgs {
    /// SCHED_FIFO priority of the loop; 0 leaves the scheduler alone.
    #[arg(long, value_name = "0..99", default_value_t = 80,
        value_parser = clap::value_parser!(u8).range(0..=99))]
    fifo_priority: u8,
    /// Processor for the loop.
    #[arg(long, value_name = "N", value_parser = processor)]
    cpu: Option<usize>,
    /// Fail unless the whole real-time set-up was granted.
    #[arg(long)]
    require_realtime: bool,
}

impl RealtimeArgs {
    pub(crate) fn options(&self) -> RealtimeOptions {
        RealtimeOptions {
            fifo_priority: (self.fifo_priority > 0).then_some(self.fifo_priority),
            cpu: self.cpu,
            require: self.require_realtime,
            ..RealtimeOptions::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bit_rates_take_k_and_m_and_refuse_zero() {
        for (text, rate) in [("1000000", 1e6), ("500k", 500e3), ("1M", 1e6), ("2.5M", 2.5e6)] {
            assert_eq!(text.parse(), Ok(BitRate(rate)), "{text}");
        }
        for text in ["0", "-1M", "1G", "M", "nan", "inf", "21M"] {
            let refused = text.parse::<BitRate>().unwrap_err().to_string();
            let expected = format!(
                "found {text}, expected a bit rate in bit/s from 1k to 20M, such as 500k or 1M"
            );
            assert_eq!(refused, expected);
        }
    }

    #[test]
    fn a_rate_is_one_of_three() {
        assert_eq!(rate("4000"), Ok(Rate::Fourfold));
        for text in ["0", "3000", "8000", "1e3", "fast"] {
            let refused = rate(text).unwrap_err().to_string();
            assert_eq!(refused, format!("found {text}, expected 1000, 2000 or 4000 Hz"));
        }
    }

    #[test]
    fn a_slow_down_beyond_its_range_is_named_with_the_range() {
        assert_eq!(slow_down("255"), Ok(NonZeroU8::MAX));
        for text in ["0", "256", "300", "1.5", "many"] {
            let refused = slow_down(text).unwrap_err().to_string();
            assert_eq!(refused, format!("found {text}, expected a whole number from 1 to 255"));
        }
    }
}
