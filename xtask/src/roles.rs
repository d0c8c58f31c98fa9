//! The two roles on emulated boards: in one program through a loopback, and on two boards and this
//! machine, whose `yawbench track-server` has the track, with a bus between them.
//!
//! The loopback runs in the emulator's own time, so that a step that comes late is one. Two
//! emulators run in real time, each on its own; in lock-step that does not change a bit.

use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::board::{Board, Length, RAM_MAX, memory};
use crate::debian;
use crate::hub::Hub;
use crate::run::{Outcome, Run};
use crate::stream::{Ended, lines};

/// Cycles of RUN, as the build script has run them on the host.
const SHORT: &str = "1000";
const FULL: &str = "100000";

/// Longest run of a pair of boards: their timers tick in real time, 1,000 times a second.
const LIMIT: Duration = Duration::from_secs(900);

/// Time in which an instruction takes 1 ns and a wait takes none.
const OWN_TIME: [&str; 2] = ["-icount", "shift=0,sleep=off"];

/// Runs both.
pub(crate) fn test(run: &mut Run, target: &str, length: Length) -> Outcome {
    let qemu = match debian::ensure("qemu-system-arm", &["qemu-system-arm"]) {
        Ok(qemu) => qemu,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_QEMU_ARM", reason),
    };
    let images = run.target.join("firmware").join(target).join("release");
    let cycles = if length == Length::Full { FULL } else { SHORT };
    let board = |image: &str| Board { qemu: qemu.clone(), image: images.join(image) };
    let (locomotive, rig) = (board("locomotive"), board("rig"));
    let mut all = Outcome::Passed;
    // Of the rig behind a servo controller a short run is enough.
    for (rig, cycles) in [("loopback", cycles), ("servo", SHORT)] {
        let mut alone = locomotive.command(&[rig, cycles]);
        alone.args(OWN_TIME).args(["-serial", "none"]);
        all = all.and(match said(&mut alone) {
            Ok(lines) => on_time(run, &lines),
            Err(reason) => Outcome::Failed(format!("both roles on one board, {rig}: {reason}")),
        });
    }
    if let worse @ (Outcome::Failed(_) | Outcome::Skipped(_)) = build_host(run) {
        return all.and(worse);
    }
    let track = run.target.join("debug/yawbench");
    all.and(match on_two_boards(run, [&locomotive, &rig], &track, cycles) {
        Ok((of_locomotive, of_rig)) => fits(run, &locomotive.image, &of_locomotive, &of_rig),
        Err(reason) => Outcome::Failed(format!("two boards and a track server: {reason}")),
    })
}

/// The command that has the track. With the whole workspace, so that it is the one that the tests
/// build too.
fn build_host(run: &mut Run) -> Outcome {
    let mut cargo = run.cargo();
    run.checked(cargo.args(["build", "--workspace", "--bin", "yawbench"]))
}

/// What the track server takes: the scenario of the images, and as much of it as they have.
const TRACK: [&str; 5] =
    ["track-server", "scenarios/ss9-160kmh.toml", "--duration", "10.5", "--there-and-back"];

/// What both boards say, with the track server of this machine on their bus.
fn on_two_boards(
    run: &Run,
    [locomotive, rig]: [&Board; 2],
    track: &Path,
    cycles: &str,
) -> Result<(Vec<String>, Vec<String>), String> {
    let socket = std::env::temp_dir().join(format!("yawbench-{}.sock", std::process::id()));
    let hub = Hub::listen(&socket).map_err(|why| format!("{}: {why}", socket.display()))?;
    let at = format!("unix:{}", socket.display());
    let mut first = locomotive.command(&["uart", cycles]);
    first.args(["-serial", &at]);
    let mut second = rig.command(&[]);
    second.args(["-serial", &at]);
    let mut server = Command::new(track);
    server.args(TRACK).arg("--line").arg(&socket).current_dir(&run.root);
    let (first, second, server) = std::thread::scope(|scope| {
        scope.spawn(|| hub.run(3));
        // One that could not start leaves its place on the bus to nobody.
        let on_bus = |command: &mut Command| {
            let lines = said(command);
            let _gone = UnixStream::connect(&socket);
            lines
        };
        let of_server = scope.spawn(move || on_bus(&mut server));
        let of_rig = scope.spawn(move || on_bus(&mut second));
        let of_locomotive = on_bus(&mut first);
        (of_locomotive, of_rig.join(), of_server.join())
    });
    let panicked = |_| "a thread has panicked".to_owned();
    let server = server.map_err(panicked)?.map_err(|reason| format!("track server: {reason}"));
    // Why the locomotive has ended comes first: a rig that it leaves waits for another one.
    let first = first.map_err(|reason| format!("locomotive: {reason}"))?;
    let second = second.map_err(panicked)?.map_err(|reason| format!("rig: {reason}"))?;
    println!("{}", last(&server?));
    Ok((first, second))
}

/// What a board says until it ends well.
fn said(qemu: &mut Command) -> Result<Vec<String>, String> {
    let mut said = Vec::new();
    let ended = lines(qemu, Some(LIMIT), |line, is_stderr| {
        // The emulator tells on the other stream that it waits for its peer.
        if !is_stderr {
            said.push(line.to_owned());
        }
    });
    match ended {
        Ok(Ended::Status(0)) => Ok(said),
        Ok(ended) => Err(format!("{ended}: {}", said.join("; "))),
        Err(error) => Err(error.to_string()),
    }
}

/// Whether no step of both roles came late.
fn on_time(run: &mut Run, lines: &[String]) -> Outcome {
    let Some(late) = number(lines, "late ") else {
        return Outcome::Failed(format!("the locomotive said {lines:?}"));
    };
    run.note(format!("{}; {late} late steps", last(lines)));
    if late > 0 {
        return Outcome::Failed(format!("{late} steps came late, expected none"));
    }
    Outcome::Passed
}

/// Whether the board of the locomotive has room for it.
fn fits(run: &mut Run, image: &Path, of_locomotive: &[String], of_rig: &[String]) -> Outcome {
    let (Some(setup), Some(stack)) =
        (number(of_locomotive, "stack setup "), number(of_locomotive, "stack steps "))
    else {
        return Outcome::Failed(format!("the locomotive said {of_locomotive:?}"));
    };
    let Some((flash, statics)) = memory(image) else {
        return Outcome::Failed(format!("{}: no 32-bit ELF file", image.display()));
    };
    run.note(format!(
        "{}; {}; stack {stack} B (set-up {setup} B), flash {flash} B, \
         statics {statics} B",
        last(of_locomotive),
        last(of_rig)
    ));
    let ram = statics + stack.max(setup);
    if ram > RAM_MAX {
        return Outcome::Failed(format!("{ram} B of RAM, expected at most {RAM_MAX}"));
    }
    Outcome::Passed
}

/// The number in the first line that starts so.
fn number(lines: &[String], start: &str) -> Option<u32> {
    lines.iter().find_map(|line| line.strip_prefix(start)?.trim().parse().ok())
}

fn last(lines: &[String]) -> &str {
    lines.last().map_or("", String::as_str)
}
