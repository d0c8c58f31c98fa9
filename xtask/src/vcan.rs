//! The tests over SocketCAN, test programs named `vcan*`: natively where this kernel has CAN, else
//! in a throw-away machine, else skipped.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::debian::{self, Sources};
use crate::machine::{self, Job, Verdict};
use crate::run::{Outcome, Run};
use crate::stream::quiet;
use crate::{qemu, uml};

/// Where the tests may run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// The first that works.
    Any,
    /// User Mode Linux and nothing else.
    Uml,
    /// QEMU and nothing else.
    Qemu,
}

const TESTS: [&str; 4] = ["test", "--workspace", "--test", "vcan*"];

/// True where the tests can run without a machine of their own.
///
/// In a container `modprobe` may be missing while the module is there, so an interface is tried
/// first.
pub(crate) fn native() -> bool {
    if std::env::var_os("VCAN_IFACE").is_some() {
        return true;
    }
    let name = format!("vcan{}", std::process::id());
    let add = || quiet(Command::new("ip").args(["link", "add", "dev", &name, "type", "vcan"]));
    let made = add().or_else(|_| {
        quiet(Command::new("modprobe").arg("vcan"))?;
        add()
    });
    made.is_ok() && quiet(Command::new("ip").args(["link", "del", "dev", &name])).is_ok()
}

/// `candump` and `cansend`: this machine's, or unpacked below the target folder.
///
/// # Errors
///
/// One line: they could not be fetched.
pub(crate) fn can_utils(run: &Run) -> Result<PathBuf, String> {
    if let Some(candump) = debian::program("candump") {
        return Ok(candump.parent().map(PathBuf::from).unwrap_or_default());
    }
    let folder = run.target.join("vcan/can-utils");
    let programs = folder.join("usr/bin");
    if !programs.join("candump").is_file() {
        debian::unpack(&Sources::default(), &["can-utils"], &folder)?;
    }
    Ok(programs)
}

/// Runs them, with the arguments handed to the test programs.
pub(crate) fn test(run: &mut Run, place: Place, arguments: &[&str]) -> Outcome {
    if place == Place::Any && native() {
        return test_natively(run, arguments);
    }
    let built = match build(run) {
        Ok(built) => built,
        Err(outcome) => return outcome,
    };
    let reason = match job(run, built, arguments) {
        Ok(job) => match in_a_machine(run, place, &job) {
            Ok(outcome) => return outcome,
            Err(reason) => reason,
        },
        Err(reason) => reason,
    };
    let reason = format!("this kernel has no CAN; {reason}");
    Outcome::skipped_unless_required("REQUIRE_VCAN", reason)
}

fn test_natively(run: &mut Run, arguments: &[&str]) -> Outcome {
    let programs = match can_utils(run) {
        Ok(programs) => programs,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_VCAN", reason),
    };
    run.search_first(programs);
    let mut cargo = run.cargo();
    cargo.args(TESTS).arg("--").args(arguments);
    run.checked(cargo.envs(run.equipment.clone()).env("REQUIRE_VCAN", "1"))
}

/// The outcome in the first machine that comes up; the error says why none did.
fn in_a_machine(run: &mut Run, place: Place, job: &Job) -> Result<Outcome, String> {
    let folder = run.target.join("vcan");
    let script = folder.join("first-process.sh");
    let mut reasons = Vec::new();
    for each in [Place::Uml, Place::Qemu] {
        if place != Place::Any && place != each {
            continue;
        }
        let prepared = match each {
            Place::Qemu => qemu::prepare(&folder.join("qemu"), &script, &job.busybox),
            Place::Any | Place::Uml => uml::prepare(&folder.join("uml"), &script),
        };
        let machine = match prepared {
            Ok(machine) => machine,
            Err(reason) => {
                println!("{reason}");
                reasons.push(reason);
                continue;
            }
        };
        let name = machine.name;
        println!("starting {name}");
        match machine::run(run, machine, job, &script) {
            Verdict::Tests(0) => {
                run.note(format!("vcan: this kernel has no CAN, so they ran in {name}"));
                return Ok(Outcome::Passed);
            }
            Verdict::Tests(status) => {
                return Ok(Outcome::Failed(format!("exit status {status} in {name}")));
            }
            Verdict::TimedOut(limit) => {
                return Ok(Outcome::Failed(format!(
                    "{name}: not done after {} s",
                    limit.as_secs()
                )));
            }
            Verdict::MachineFailed(reason) => {
                run.note(format!("vcan: {name} {reason}"));
                reasons.push(format!("{name} {reason}"));
            }
        }
    }
    Err(reasons.join("; "))
}

/// The test programs, and the `yawbench` that belongs to them.
#[derive(Default)]
struct Built {
    tests: Vec<PathBuf>,
    yawbench: Option<PathBuf>,
}

impl Built {
    /// Reads one of cargo's messages; most name no program and change nothing.
    fn read(&mut self, message: &str) {
        let field = |key: &str| {
            let (_, rest) = message.split_once(&format!("\"{key}\":\""))?;
            rest.split_once('"').map(|(value, _)| value)
        };
        let (Some(program), Some(name)) = (field("executable"), field("name")) else { return };
        if message.contains("\"kind\":[\"test\"]") && name.starts_with("vcan") {
            self.tests.push(program.into());
        } else if message.contains("\"kind\":[\"bin\"]") && name == "yawbench" {
            self.yawbench = Some(program.into());
        }
    }
}

/// Builds them with the same choice of packages as the workspace's tests, so that cargo chooses
/// the same features and finds them built already.
fn build(run: &Run) -> Result<Built, Outcome> {
    let mut cargo = run.cargo();
    cargo.args(TESTS).args(["--no-run", "--message-format=json-render-diagnostics"]);
    let output = cargo.stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| Outcome::Failed(format!("cargo: {error}")))?;
    if !output.status.success() {
        return Err(Outcome::Failed("the tests do not build".into()));
    }
    let mut built = Built::default();
    String::from_utf8_lossy(&output.stdout).lines().for_each(|line| built.read(line));
    if built.tests.is_empty() {
        return Err(Outcome::Failed("no test program is named vcan*".into()));
    }
    Ok(built)
}

fn job(run: &Run, built: Built, arguments: &[&str]) -> Result<Job, String> {
    debian::ensure("ip", &["iproute2"])?;
    let mut environment: Vec<(String, OsString)> = vec![
        ("REQUIRE_VCAN".into(), "1".into()),
        ("RUST_BACKTRACE".into(), "1".into()),
        // One at a time: paced tests side by side would measure each other.
        ("RUST_TEST_THREADS".into(), "1".into()),
        ("CARGO_MANIFEST_DIR".into(), run.root.clone().into()),
    ];
    // Its console is a terminal, ours may be a file.
    let colour = [if run.colour { "--color=always" } else { "--color=never" }];
    // The search path is the machine's own; a Python with cantools is named by its file.
    environment.extend(run.equipment.iter().filter(|(name, _)| name != "PATH").cloned());
    environment.extend(built.yawbench.map(|path| ("YAWBENCH_BIN".into(), path.into())));
    Ok(Job {
        programs: built.tests,
        arguments: colour.iter().chain(arguments).map(ToString::to_string).collect(),
        environment,
        tools: vec![can_utils(run)?],
        busybox: busybox(run)?,
    })
}

/// A static busybox: the machines insert modules and power off with it, and QEMU starts with it.
pub(crate) fn busybox(run: &Run) -> Result<PathBuf, String> {
    let folder = run.target.join("vcan/busybox");
    let unpacked = || {
        let places = ["bin/busybox", "usr/bin/busybox"];
        places.into_iter().map(|place| folder.join(place)).find(|path| path.is_file())
    };
    if unpacked().is_none() {
        debian::unpack(&Sources::default(), &["busybox-static"], &folder)?;
    }
    unpacked().ok_or_else(|| "busybox-static has no busybox".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_read_from_cargos_messages() {
        let message = |kind: &str, name: &str, program: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","target":{{"kind":["{kind}"],"name":"{name}"}},"#
            ) + &format!(r#""profile":{{"test":true}},"executable":{program},"fresh":true}}"#)
        };
        let mut built = Built::default();
        built.read(&message("test", "vcan", r#""/t/vcan-1""#));
        built.read(&message("test", "system", r#""/t/system-1""#));
        built.read(&message("lib", "vcan", "null"));
        built.read(&message("bin", "yawbench", r#""/t/yawbench""#));
        assert_eq!(built.tests, [PathBuf::from("/t/vcan-1")]);
        assert_eq!(built.yawbench, Some(PathBuf::from("/t/yawbench")));
    }
}
