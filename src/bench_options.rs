//! Options that `run` and `rig` share: frames on the wire and real time.

use can_protocol::Profile;
use clap::{Args, ValueEnum};
use hil_host::realtime::RealtimeOptions;

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ProfileChoice {
    /// Classical CAN, 8 bytes, 1 kHz.
    Classical,
    /// CAN FD with bit-rate switch, 16 bytes.
    Fd,
}

#[derive(Debug, Args)]
pub(crate) struct WireArgs {
    /// Frames on the wire.
    #[arg(long, value_enum, default_value_t = ProfileChoice::Classical)]
    profile: ProfileChoice,
    /// Bit rate, for the bus load (bit/s).
    #[arg(long, value_name = "BITS", default_value_t = 1_000_000)]
    pub(crate) bitrate: u32,
    /// Bit rate of the data phase, for the bus load (bit/s).
    #[arg(long, value_name = "BITS", default_value_t = 5_000_000)]
    pub(crate) data_bitrate: u32,
}

impl WireArgs {
    pub(crate) fn profile(&self) -> Profile {
        match self.profile {
            ProfileChoice::Classical => Profile::Classical,
            ProfileChoice::Fd => Profile::Fd,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct RealtimeArgs {
    /// SCHED_FIFO priority of the loop; 0 leaves the scheduler alone.
    #[arg(long, value_name = "0..99", default_value_t = 80,
        value_parser = clap::value_parser!(u8).range(0..=99))]
    fifo_priority: u8,
    /// Processor for the loop.
    #[arg(long, value_name = "N")]
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
