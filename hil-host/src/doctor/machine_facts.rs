//! What the files of a kernel say about a machine.
//!
//! All paths are read below a root, so that a test can lay out the files of another machine. A file
//! that is absent is a fact too: `None`.

use super::process_facts::Process;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A machine as its kernel shows it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Machine {
    /// `/proc/version`.
    pub version: Option<String>,
    /// Whether `/sys/kernel/realtime` says that the kernel is `PREEMPT_RT`.
    pub is_realtime: bool,
    /// The preemption model in force of a `PREEMPT_DYNAMIC` kernel, where debugfs shows it.
    pub preemption: Option<String>,
    /// Processors.
    pub cpus: usize,
    /// Isolated processors, as a list such as `2-3`; empty for none.
    pub isolated: Option<String>,
    /// Processors without the scheduler's tick; empty for none, `None` where the kernel cannot.
    pub nohz_full: Option<String>,
    /// The clock source in use, and all that there are.
    pub clock_source: Option<(String, Vec<String>)>,
    /// Frequency governors and the number of processors that each has.
    pub governors: BTreeMap<String, usize>,
    /// The deepest idle state that is not disabled: its name and how long it wakes (µs).
    pub deepest_idle: Option<(String, u64)>,
    /// Whether `/dev/cpu_dma_latency` may be written; `None` where there is none.
    pub may_hold_latency: Option<bool>,
    /// Run time of real-time threads per second: `sched_rt_runtime_us`.
    pub rt_runtime_us: Option<i64>,
    /// Quotas of the control groups of this process that would hold a thread back, in words.
    pub quotas: Vec<Quota>,
    /// Whether control groups were found at all.
    pub has_cgroups: bool,
    /// Whether the processor has the flag `hypervisor`; `None` for one that lists no such flags.
    pub is_virtual: Option<bool>,
    /// What this process may ask for.
    pub process: Process,
}

/// A limit of a control group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quota {
    /// The file that has it.
    pub file: String,
    /// Its content.
    pub content: String,
    /// What to write into it.
    pub wanted: &'static str,
}

impl Machine {
    /// Reads the machine below a root, `/` for this one.
    pub fn read(root: &Path, process: Process) -> Self {
        let text = |path: &str| read(&root.join(path));
        let cpu = root.join("sys/devices/system/cpu");
        let source = "sys/devices/system/clocksource/clocksource0";
        let all = text(&format!("{source}/available_clocksource")).unwrap_or_default();
        let all: Vec<String> = all.split_whitespace().map(str::to_owned).collect();
        let (quotas, has_cgroups) = quotas(root);
        Self {
            version: text("proc/version"),
            is_realtime: text("sys/kernel/realtime").as_deref() == Some("1"),
            preemption: text("sys/kernel/debug/sched/preempt").as_deref().and_then(in_brackets),
            cpus: processors(&cpu).len(),
            isolated: text("sys/devices/system/cpu/isolated").map(list),
            nohz_full: text("sys/devices/system/cpu/nohz_full").map(list),
            clock_source: text(&format!("{source}/current_clocksource")).map(|now| (now, all)),
            governors: governors(&cpu),
            deepest_idle: deepest_idle(&cpu.join("cpu0/cpuidle")),
            may_hold_latency: may_write(&root.join("dev/cpu_dma_latency")),
            rt_runtime_us: text("proc/sys/kernel/sched_rt_runtime_us")
                .and_then(|text| text.parse().ok()),
            quotas,
            has_cgroups,
            is_virtual: text("proc/cpuinfo").as_deref().and_then(is_virtual),
            process,
        }
    }
}

/// The text of a file of the kernel without white space around it.
fn read(path: &Path) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}

/// `full` of `none voluntary (full)`.
fn in_brackets(text: &str) -> Option<String> {
    Some(text.split_once('(')?.1.split_once(')')?.0.to_owned())
}

/// A list of processors; the kernel writes `(null)` for an empty one.
fn list(text: String) -> String {
    if text == "(null)" { String::new() } else { text }
}

/// The folders of the processors.
fn processors(cpu: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(cpu).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_processor = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let number = name.strip_prefix("cpu").unwrap_or_default();
        !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
    };
    entries.filter(is_processor).collect()
}

fn governors(cpu: &Path) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    for processor in processors(cpu) {
        if let Some(governor) = read(&processor.join("cpufreq/scaling_governor")) {
            *found.entry(governor).or_default() += 1;
        }
    }
    found
}

fn deepest_idle(cpuidle: &Path) -> Option<(String, u64)> {
    let entries = fs::read_dir(cpuidle).ok()?.flatten().map(|entry| entry.path());
    let enabled = entries.filter(|state| read(&state.join("disable")).as_deref() != Some("1"));
    let states = enabled.filter_map(|state| {
        let latency_us = read(&state.join("latency"))?.parse().ok()?;
        Some((read(&state.join("name"))?, latency_us))
    });
    states.max_by_key(|(_, latency_us)| *latency_us)
}

/// Whether a file may be opened for writing; nothing is written.
fn may_write(path: &Path) -> Option<bool> {
    path.exists().then(|| fs::File::options().write(true).open(path).is_ok())
}

/// Whether the first processor has the flag `hypervisor`. Only x86 lists such flags.
fn is_virtual(cpuinfo: &str) -> Option<bool> {
    let flags = cpuinfo.lines().find(|line| line.starts_with("flags"))?;
    Some(flags.split_whitespace().any(|flag| flag == "hypervisor"))
}

/// The limits of the control groups of this process, and whether the kernel shows its groups. The
/// root group has no limit and no file for one.
fn quotas(root: &Path) -> (Vec<Quota>, bool) {
    let Some(groups) = read(&root.join("proc/self/cgroup")) else { return (Vec::new(), false) };
    let mut found = Vec::new();
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let path = path.trim_start_matches('/');
        if controllers.is_empty() {
            // Version 2: a quota of any group above holds too.
            for group in Path::new(path).ancestors() {
                let file = Path::new("sys/fs/cgroup").join(group).join("cpu.max");
                let Some(content) = read(&root.join(&file)) else { continue };
                if !content.starts_with("max") {
                    found.push(quota(&file, content, "max"));
                }
            }
        } else if controllers.split(',').any(|name| name == "cpu") {
            let group = Path::new("sys/fs/cgroup").join(controllers).join(path);
            let cfs = group.join("cpu.cfs_quota_us");
            if let Some(content) = read(&root.join(&cfs)).filter(|content| content != "-1") {
                found.push(quota(&cfs, content, "-1"));
            }
            let rt = group.join("cpu.rt_runtime_us");
            if let Some(content) = read(&root.join(&rt)).filter(|content| content == "0") {
                found.push(quota(&rt, content, "950000"));
            }
        }
    }
    (found, true)
}

fn quota(file: &Path, content: String, wanted: &'static str) -> Quota {
    Quota { file: format!("/{}", file.display()), content, wanted }
}
