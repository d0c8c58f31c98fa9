//! The judgement of three machines whose files are laid out in a folder: a bench PC, a container in
//! a cloud, a Raspberry Pi.

use super::*;
use crate::doctor::Process;
use std::fs;
use std::path::PathBuf;

/// A machine that is laid out below a folder of its own, from file and content.
fn machine(name: &str, files: &[(&str, &str)], process: Process) -> Machine {
    let root: PathBuf = std::env::temp_dir().join(format!("doctor-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&root);
    for (path, content) in files {
        let file = root.join(path);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, content).unwrap();
    }
    let machine = Machine::read(&root, process);
    fs::remove_dir_all(&root).unwrap();
    machine
}

fn user(rtprio: u64, memlock_bytes: Option<u64>) -> Process {
    Process { rtprio: Some(rtprio), memlock_bytes, capabilities: Some(0) }
}

/// A bench PC of four processors: `PREEMPT_RT`, the last processor isolated.
const BENCH_PC: &[(&str, &str)] = &[
    (
        "proc/version",
        "Linux version 6.12.48+deb13-rt-amd64 (debian-kernel@lists.debian.org) (x86_64-linux-\
         gnu-gcc-14) #1 SMP PREEMPT_RT Debian 6.12.48-1 (2025-09-20)\n",
    ),
    ("sys/kernel/realtime", "1\n"),
    ("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu tsc constant_tsc nonstop_tsc\n"),
    ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n"),
    ("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n"),
    ("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "performance\n"),
    ("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "performance\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state0/name", "POLL\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state0/latency", "0\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state1/name", "C1E\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state1/latency", "10\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state2/name", "C10\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state2/latency", "890\n"),
    ("sys/devices/system/cpu/cpu0/cpuidle/state2/disable", "0\n"),
    ("sys/devices/system/cpu/cpuidle/current_driver", "intel_idle\n"),
    ("sys/devices/system/cpu/isolated", "3\n"),
    ("sys/devices/system/cpu/nohz_full", "3\n"),
    ("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n"),
    ("sys/devices/system/clocksource/clocksource0/available_clocksource", "tsc hpet acpi_pm\n"),
    ("proc/sys/kernel/sched_rt_runtime_us", "950000\n"),
    ("proc/self/cgroup", "0::/user.slice/user-1000.slice/session-2.scope\n"),
    ("sys/fs/cgroup/user.slice/cpu.max", "max 100000\n"),
    ("dev/cpu_dma_latency", ""),
];

/// A virtual machine of two processors in a cloud, with a container's quota.
const CLOUD: &[(&str, &str)] = &[
    (
        "proc/version",
        "Linux version 6.8.0-1021-aws (buildd@lcy02) (x86_64-linux-gnu-gcc-13) #23-Ubuntu SMP \
         PREEMPT_DYNAMIC Mon Dec 9 23:59:34 UTC 2024\n",
    ),
    ("sys/kernel/debug/sched/preempt", "none (voluntary) full \n"),
    ("proc/cpuinfo", "flags\t\t: fpu tsc hypervisor nonstop_tsc\n"),
    ("sys/devices/system/cpu/cpu0/online", "1\n"),
    ("sys/devices/system/cpu/cpu1/online", "1\n"),
    ("sys/devices/system/cpu/isolated", "\n"),
    ("sys/devices/system/cpu/nohz_full", "(null)\n"),
    ("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n"),
    ("sys/devices/system/clocksource/clocksource0/available_clocksource", "hpet acpi_pm\n"),
    ("proc/sys/kernel/sched_rt_runtime_us", "0\n"),
    ("proc/self/cgroup", "0::/system.slice/docker-1f.scope\n"),
    ("sys/fs/cgroup/system.slice/cpu.max", "max 100000\n"),
    ("sys/fs/cgroup/system.slice/docker-1f.scope/cpu.max", "50000 100000\n"),
];

/// A Raspberry Pi 4 with its usual kernel; groups of version 1.
const PI: &[(&str, &str)] = &[
    (
        "proc/version",
        "Linux version 6.6.51+rpt-rpi-v8 (serge@raspberrypi.com) (gcc-12) #1 SMP PREEMPT \
         Debian 1:6.6.51-1+rpt3 (2024-10-08)\n",
    ),
    ("proc/cpuinfo", "processor\t: 0\nFeatures\t: fp asimd evtstrm crc32 cpuid\n"),
    ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "ondemand\n"),
    ("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "ondemand\n"),
    ("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "ondemand\n"),
    ("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "ondemand\n"),
    ("sys/devices/system/cpu/isolated", "\n"),
    ("sys/devices/system/clocksource/clocksource0/current_clocksource", "arch_sys_counter\n"),
    ("proc/sys/kernel/sched_rt_runtime_us", "-1\n"),
    ("proc/self/cgroup", "4:cpu,cpuacct:/user.slice\n1:name=systemd:/user.slice\n"),
    ("sys/fs/cgroup/cpu,cpuacct/user.slice/cpu.cfs_quota_us", "-1\n"),
    ("sys/fs/cgroup/cpu,cpuacct/user.slice/cpu.rt_runtime_us", "0\n"),
];

/// Name, found and verdict of every row.
fn rows(machine: &Machine) -> Vec<(String, String, Verdict)> {
    let checks = judge_machine(machine);
    for check in &checks {
        assert_eq!(check.advice.is_empty(), check.verdict == Verdict::Good, "{check:?}");
        assert!(check.advice.len() < 400 && !check.found.is_empty(), "{check:?}");
    }
    checks.into_iter().map(|check| (check.what, check.found, check.verdict)).collect()
}

fn expect(found: &[(String, String, Verdict)], expected: &[(&str, &str, Verdict)]) {
    let found: Vec<(&str, &str, Verdict)> =
        found.iter().map(|(what, found, verdict)| (&**what, &**found, *verdict)).collect();
    assert_eq!(found, expected);
}

use Verdict::{Change, Good, Unknown};

#[test]
fn a_bench_pc_has_nothing_to_change() {
    let machine = machine("bench", BENCH_PC, user(95, None));
    expect(
        &rows(&machine),
        &[
            ("hypervisor", "none", Good),
            ("preemption", "PREEMPT_RT, kernel 6.12.48+deb13-rt-amd64", Good),
            ("processors", "4", Good),
            ("isolated processors", "3", Good),
            ("processors without tick", "3", Good),
            ("clock source", "tsc", Good),
            ("frequency governor", "performance on 4", Good),
            ("idle states", "C10: 890 us; a run holds it awake", Good),
            ("real-time priority", "limit 95, no CAP_SYS_NICE", Good),
            ("locked memory", "limit unlimited, no CAP_IPC_LOCK", Good),
            ("real-time throttling", "950000 us", Good),
            ("quota of the control group", "none", Good),
        ],
    );
}

#[test]
fn a_container_in_a_cloud_is_held_back_by_everything() {
    let machine = machine("cloud", CLOUD, user(0, Some(8 << 20)));
    let group = "/sys/fs/cgroup/system.slice/docker-1f.scope/cpu.max = 50000 100000";
    expect(
        &rows(&machine),
        &[
            ("hypervisor", "virtual machine", Change),
            ("preemption", "PREEMPT_DYNAMIC, kernel 6.8.0-1021-aws, voluntary", Change),
            ("processors", "2", Good),
            ("isolated processors", "none", Change),
            ("processors without tick", "none", Unknown),
            ("clock source", "hpet", Change),
            ("frequency governor", "-", Unknown),
            ("idle states", "-", Unknown),
            ("real-time priority", "limit 0, no CAP_SYS_NICE", Change),
            ("locked memory", "limit 8 MiB, no CAP_IPC_LOCK", Change),
            ("real-time throttling", "0 us", Change),
            ("quota of the control group", group, Change),
        ],
    );
    let checks = judge_machine(&machine);
    assert_eq!(
        checks[3].command,
        "isolcpus=domain,managed_irq,1 nohz_full=1 rcu_nocbs=1 irqaffinity=0"
    );
    let command =
        "echo max | sudo tee /sys/fs/cgroup/system.slice/docker-1f.scope/cpu.max".to_owned();
    assert_eq!(checks[11].command, command);
}

#[test]
fn a_raspberry_pi_needs_a_kernel_a_governor_and_an_isolated_processor() {
    let capable = Process { capabilities: Some(1 << 23), ..user(0, Some(64 << 10)) };
    let machine = machine("pi", PI, capable);
    let group = "/sys/fs/cgroup/cpu,cpuacct/user.slice/cpu.rt_runtime_us = 0";
    expect(
        &rows(&machine),
        &[
            ("hypervisor", "-", Unknown),
            ("preemption", "PREEMPT, kernel 6.6.51+rpt-rpi-v8", Change),
            ("processors", "4", Good),
            ("isolated processors", "none", Change),
            ("processors without tick", "-", Unknown),
            ("clock source", "arch_sys_counter", Good),
            ("frequency governor", "ondemand on 4", Change),
            ("idle states", "-", Unknown),
            ("real-time priority", "limit 0, CAP_SYS_NICE", Good),
            ("locked memory", "limit 0 MiB, no CAP_IPC_LOCK", Change),
            ("real-time throttling", "-1 (none)", Good),
            ("quota of the control group", group, Change),
        ],
    );
    let isolate =
        "isolcpus=domain,managed_irq,3 nohz_full=3 rcu_nocbs=3 irqaffinity=0-2".to_owned();
    assert_eq!(judge_machine(&machine)[3].command, isolate);
}

#[test]
fn nothing_to_read_is_nothing_to_judge() {
    let machine = machine("nothing", &[("none", "")], user(0, Some(0)));
    for check in judge_machine(&machine) {
        let is_limit = matches!(&*check.what, "real-time priority" | "locked memory");
        assert_eq!(check.verdict, if is_limit { Change } else { Unknown }, "{check:?}");
    }
}

#[test]
fn a_processor_that_sleeps_deeply_and_is_not_held_awake_is_named() {
    let deep: Vec<(&str, &str)> =
        BENCH_PC.iter().copied().filter(|(path, _)| !path.starts_with("dev/")).collect();
    let idle = &judge_machine(&machine("deep", &deep, user(95, None)))[7];
    assert_eq!((&*idle.found, idle.verdict), ("C10: 890 us", Change));
    let disabled: Vec<(&str, &str)> = deep
        .iter()
        .map(|&(path, content)| {
            (path, if path.ends_with("state2/disable") { "1\n" } else { content })
        })
        .collect();
    let idle = &judge_machine(&machine("light", &disabled, user(95, None)))[7];
    assert_eq!((&*idle.found, idle.verdict), ("C1E: 10 us", Good));
}

#[test]
fn a_slow_clock_is_left_by_a_command_where_a_better_one_is_offered() {
    let slow: Vec<(&str, &str)> = BENCH_PC
        .iter()
        .map(|&(path, content)| {
            (path, if path.ends_with("current_clocksource") { "acpi_pm\n" } else { content })
        })
        .collect();
    let clock = &judge_machine(&machine("slow", &slow, user(95, None)))[5];
    assert_eq!((&*clock.found, clock.verdict), ("acpi_pm", Change));
    assert!(clock.command.starts_with("echo tsc | sudo tee /sys/"), "{}", clock.command);
}
