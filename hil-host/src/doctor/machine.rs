//! Is the machine ready for a cycle of 1 ms? From facts to checks.
//!
//! What delays a thread that wakes by a timer: code of the kernel that cannot be preempted, other
//! threads and interrupts on its processor, a processor that has to wake from sleep or change its
//! frequency, pages that are fetched, a scheduler that throttles it, and a hypervisor that takes
//! the processor away. One row for each.

use super::check::{Check, Verdict};
use super::machine_facts::Machine;
use std::fmt::Write as _;

/// Priority that a run asks for by default.
const PRIORITY: u64 = 80;

/// Memory that a process of this program has in the course of a run, at least (bytes).
const LOCKED_BYTES: u64 = 1 << 30;

/// A wake-up that is no more than a tenth of the usual budget for lateness (µs).
const SHORT_WAKE_UP_US: u64 = 10;

/// Run time per second from which a loop that sleeps in every cycle is never throttled (µs).
const RT_RUNTIME_US: i64 = 500_000;

/// Judges a machine: one check per row, in the order in which they are worth changing.
pub fn judge_machine(machine: &Machine) -> Vec<Check> {
    vec![
        hypervisor(machine),
        preemption(machine),
        processors(machine),
        isolated(machine),
        nohz_full(machine),
        clock_source(machine),
        governor(machine),
        idle(machine),
        priority(machine),
        memory(machine),
        throttling(machine),
        quota(machine),
    ]
}

fn hypervisor(machine: &Machine) -> Check {
    let (what, expected) = ("hypervisor", "none");
    let advice = "a hypervisor takes the processor away for milliseconds, and nothing in the guest \
                  prevents it: run a real rig from a machine of its own";
    match machine.is_virtual {
        Some(true) => Check::good(what, "virtual machine", expected).or_change(false, advice, ""),
        Some(false) => Check::good(what, "none", expected),
        None => {
            let why = "this processor has no flag for it";
            Check::unknown(what, "-", expected, why)
        }
    }
}

fn preemption(machine: &Machine) -> Check {
    let (what, expected) = ("preemption", "PREEMPT_RT");
    let Some(version) = &machine.version else {
        return Check::unknown(what, "-", expected, "/proc/version cannot be read");
    };
    // Kernels before 6.12 with the patch name it in their version only.
    let is_realtime = machine.is_realtime || has_word(version, "PREEMPT_RT");
    let release = version.split_whitespace().nth(2).unwrap_or_default();
    let model = ["PREEMPT_RT", "PREEMPT_DYNAMIC", "PREEMPT"];
    let model = model.into_iter().find(|model| has_word(version, model)).unwrap_or("no PREEMPT");
    let mut found = format!("{}, kernel {release}", if is_realtime { expected } else { model });
    if let (Some(mode), false) = (&machine.preemption, is_realtime) {
        // Writing to a string cannot fail.
        let _ = write!(found, ", {mode}");
    }
    let advice = "install a PREEMPT_RT kernel (in mainline from 6.12 on; Debian: package \
                  linux-image-rt-amd64, Ubuntu: `pro enable realtime-kernel`, Raspberry Pi OS: \
                  build one with CONFIG_PREEMPT_RT=y), then restart";
    let is_debian = version.contains("Debian") && version.contains("amd64");
    let command = if is_debian { "sudo apt install linux-image-rt-amd64" } else { "" };
    Check::good(what, found, expected).or_change(is_realtime, advice, command)
}

/// Whether a text has a word that is not a part of another one: `PREEMPT` in `PREEMPT_RT` is.
fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).any(|part| part == word)
}

fn processors(machine: &Machine) -> Check {
    let (what, expected) = ("processors", "2 or more");
    if machine.cpus == 0 {
        return Check::unknown(what, "-", expected, "/sys/devices/system/cpu cannot be read");
    }
    let advice = "the loop needs one of its own: interrupts, the recorder and other programs share \
                  the only one with it";
    Check::good(what, machine.cpus.to_string(), expected).or_change(machine.cpus >= 2, advice, "")
}

fn isolated(machine: &Machine) -> Check {
    let (what, expected) = ("isolated processors", "one for the loop");
    let Some(list) = &machine.isolated else {
        return Check::unknown(what, "-", expected, "this kernel does not list them");
    };
    let Some(last) = machine.cpus.checked_sub(1).filter(|last| *last > 0) else {
        let why = "the only processor cannot be isolated";
        return Check::unknown(what, shown(list), expected, why);
    };
    let others = if last == 1 { "0".to_owned() } else { format!("0-{}", last - 1) };
    let advice = format!(
        "add to the command line of the kernel (GRUB_CMDLINE_LINUX in /etc/default/grub, then \
         `sudo update-grub`; Raspberry Pi: /boot/firmware/cmdline.txt), restart, and start runs \
         with --cpu {last}"
    );
    let command = format!(
        "isolcpus=domain,managed_irq,{last} nohz_full={last} rcu_nocbs={last} irqaffinity={others}"
    );
    Check::good(what, shown(list), expected).or_change(!list.is_empty(), &advice, &command)
}

fn nohz_full(machine: &Machine) -> Check {
    let (what, expected) = ("processors without tick", "the isolated ones");
    let Some(list) = &machine.nohz_full else {
        let why = "this kernel keeps its tick (no CONFIG_NO_HZ_FULL), which costs the loop some \
                   microseconds each time";
        return Check::unknown(what, "-", expected, why);
    };
    let Some(isolated) = machine.isolated.as_ref().filter(|list| !list.is_empty()) else {
        return Check::unknown(what, shown(list), expected, "no processor is isolated");
    };
    let advice = "add to the command line of the kernel, next to isolcpus, and restart";
    let command = format!("nohz_full={isolated} rcu_nocbs={isolated}");
    Check::good(what, shown(list), expected).or_change(list == isolated, advice, &command)
}

fn shown(list: &str) -> &str {
    if list.is_empty() { "none" } else { list }
}

fn clock_source(machine: &Machine) -> Check {
    let (what, expected) = ("clock source", "tsc or arch_sys_counter");
    let Some((now, all)) = &machine.clock_source else {
        return Check::unknown(what, "-", expected, "this kernel does not name it");
    };
    match now.as_str() {
        "tsc" | "arch_sys_counter" => Check::good(what, now, expected),
        "hpet" | "acpi_pm" | "jiffies" => {
            let file = "/sys/devices/system/clocksource/clocksource0/current_clocksource";
            if all.iter().any(|name| name == "tsc") {
                let advice = "every look at the clock takes a microsecond or more";
                let command = format!("echo tsc | sudo tee {file}");
                Check::good(what, now, expected).or_change(false, advice, &command)
            } else {
                let advice = "every look at the clock takes a microsecond or more, and the kernel \
                              does not trust this processor's counter: `dmesg | grep -i tsc` says \
                              why; update the firmware, or take another machine";
                Check::good(what, now, expected).or_change(false, advice, "")
            }
        }
        _ => {
            let why =
                "a clock that this check does not know; `yawbench rtcheck` shows what it does";
            Check::unknown(what, now, expected, why)
        }
    }
}

fn governor(machine: &Machine) -> Check {
    let (what, expected) = ("frequency governor", "performance");
    if machine.governors.is_empty() {
        let why = "the kernel does not control the frequency: see the power settings of the \
                   firmware, or of the hypervisor";
        return Check::unknown(what, "-", expected, why);
    }
    let found: Vec<String> =
        machine.governors.iter().map(|(name, count)| format!("{name} on {count}")).collect();
    let is_good = machine.governors.keys().all(|name| name == expected);
    let advice = "a processor that is idle between two cycles is clocked down (until the next \
                  restart; package linux-cpupower makes it last)";
    let file = "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor";
    let command = format!("echo performance | sudo tee {file}");
    Check::good(what, found.join(", "), expected).or_change(is_good, advice, &command)
}

fn idle(machine: &Machine) -> Check {
    let what = "idle states";
    let expected = format!("{SHORT_WAKE_UP_US} us to wake, or held awake");
    let may_hold = machine.may_hold_latency == Some(true);
    let Some((name, latency_us)) = &machine.deepest_idle else {
        let why = "the kernel shows no idle states of processor 0: the firmware or the hypervisor \
                   decides";
        return Check::unknown(what, "-", &expected, why);
    };
    let held = if may_hold { "; a run holds it awake" } else { "" };
    let found = format!("{name}: {latency_us} us{held}");
    let is_good = may_hold || *latency_us <= SHORT_WAKE_UP_US;
    let advice = "allow the group of the bench's users to write /dev/cpu_dma_latency, where a run \
                  asks the processors not to sleep (as root, then restart; group `realtime`)";
    let command = r#"echo 'KERNEL=="cpu_dma_latency", GROUP="realtime", MODE="0660"' | sudo tee /etc/udev/rules.d/99-realtime.rules"#;
    Check::good(what, found, expected).or_change(is_good, advice, command)
}

/// How to give the limits that a login has.
const LIMITS: &str = "give the group of the bench's users the limits, add yourself to it \
                      (`sudo groupadd -f realtime; sudo usermod -aG realtime $USER`), and log in \
                      again";
const LIMITS_COMMAND: &str = "printf '@realtime - rtprio 95\\n@realtime - memlock unlimited\\n' | \
                              sudo tee /etc/security/limits.d/realtime.conf";

fn priority(machine: &Machine) -> Check {
    let process = &machine.process;
    let expected = format!("SCHED_FIFO {PRIORITY} allowed");
    let limit = process.rtprio.map_or_else(|| "unlimited".to_owned(), |limit| limit.to_string());
    let right = if process.may_set_priority() { "CAP_SYS_NICE" } else { "no CAP_SYS_NICE" };
    let is_good =
        process.may_set_priority() || process.rtprio.is_none_or(|limit| limit >= PRIORITY);
    Check::good("real-time priority", format!("limit {limit}, {right}"), expected).or_change(
        is_good,
        LIMITS,
        LIMITS_COMMAND,
    )
}

fn memory(machine: &Machine) -> Check {
    let process = &machine.process;
    let limit = process
        .memlock_bytes
        .map_or_else(|| "unlimited".to_owned(), |bytes| format!("{} MiB", bytes >> 20));
    let right = if process.may_lock_memory() { "CAP_IPC_LOCK" } else { "no CAP_IPC_LOCK" };
    let is_good = process.may_lock_memory()
        || process.memlock_bytes.is_none_or(|bytes| bytes >= LOCKED_BYTES);
    Check::good("locked memory", format!("limit {limit}, {right}"), "1 GiB or more allowed")
        .or_change(is_good, LIMITS, LIMITS_COMMAND)
}

fn throttling(machine: &Machine) -> Check {
    let what = "real-time throttling";
    let expected = format!("{RT_RUNTIME_US} us per s or more, or -1");
    let Some(runtime_us) = machine.rt_runtime_us else {
        let why = "this kernel has no sched_rt_runtime_us";
        return Check::unknown(what, "-", &expected, why);
    };
    let found = if runtime_us < 0 { "-1 (none)".to_owned() } else { format!("{runtime_us} us") };
    let is_good = !(0..RT_RUNTIME_US).contains(&runtime_us);
    let advice = "the kernel stops real-time threads for the rest of each second";
    let command = "sudo sysctl -w kernel.sched_rt_runtime_us=950000";
    Check::good(what, found, expected).or_change(is_good, advice, command)
}

fn quota(machine: &Machine) -> Check {
    let (what, expected) = ("quota of the control group", "none");
    if !machine.has_cgroups {
        return Check::unknown(what, "-", expected, "/proc/self/cgroup cannot be read");
    }
    let Some(first) = machine.quotas.first() else { return Check::good(what, "none", expected) };
    let found = format!("{} = {}", first.file, first.content);
    let advice = "the kernel stops the process for the rest of each period, or refuses its \
                  real-time priority; in a container: start it without --cpus and with \
                  --ulimit rtprio=95 --cap-add SYS_NICE";
    let command = format!("echo {} | sudo tee {}", first.wanted, first.file);
    let check = Check::good(what, found, expected).or_change(false, advice, &command);
    debug_assert_eq!(check.verdict, Verdict::Change, "a quota is to be changed");
    check
}

#[cfg(test)]
mod tests;
