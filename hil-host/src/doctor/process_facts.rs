//! What this process may ask the kernel for: limits and capabilities.

use rustix::process::{Resource, getrlimit};
use std::path::Path;

/// Bits of the capabilities in `/proc/self/status`, as `capabilities(7)` numbers them.
const CAP_IPC_LOCK: u32 = 14;
const CAP_SYS_NICE: u32 = 23;

/// The rights of a process. A limit of `None` is no limit.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Process {
    /// Highest real-time priority without a capability.
    pub rtprio: Option<u64>,
    /// Memory that may be locked without a capability, bytes.
    pub memlock_bytes: Option<u64>,
    /// Effective capabilities as a mask; none where the kernel does not show them.
    pub capabilities: Option<u64>,
}

impl Process {
    /// The rights of this process.
    pub fn this() -> Self {
        let status = std::fs::read_to_string(Path::new("/proc/self/status")).ok();
        Self {
            rtprio: getrlimit(Resource::Rtprio).current,
            memlock_bytes: getrlimit(Resource::Memlock).current,
            capabilities: status.as_deref().and_then(effective),
        }
    }

    /// Whether it may set any priority.
    pub(super) fn may_set_priority(&self) -> bool {
        self.has(CAP_SYS_NICE)
    }

    /// Whether it may lock any memory.
    pub(super) fn may_lock_memory(&self) -> bool {
        self.has(CAP_IPC_LOCK)
    }

    fn has(&self, bit: u32) -> bool {
        self.capabilities.is_some_and(|mask| mask >> bit & 1 == 1)
    }
}

/// The line `CapEff` of a status file.
fn effective(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("CapEff:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capabilities_are_read_bit_by_bit() {
        let with = |mask: &str| Process {
            capabilities: effective(&format!("Name:\tyawbench\nCapEff:\t{mask}\nThreads:\t1\n")),
            ..Process::default()
        };
        let root = with("000001ffffffffff");
        assert!(root.may_set_priority() && root.may_lock_memory());
        let nice = with("0000000000800000");
        assert!(nice.may_set_priority() && !nice.may_lock_memory());
        let lock = with("0000000000004000");
        assert!(!lock.may_set_priority() && lock.may_lock_memory());
        assert!(!with("none").may_set_priority());
    }
}
