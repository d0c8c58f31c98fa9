//! The two roles on emulated boards: in one program through a loopback, and on two boards with a
//! line between them.
//!
//! The loopback runs in the emulator's own time, so that a step that comes late is one. Two
//! emulators run in real time, each on its own; in lock-step that does not change a bit.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::board::{Board, Length, RAM_MAX, memory};
use crate::debian;
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
    all.and(match on_two_boards(&locomotive, &rig, cycles) {
        Ok((of_locomotive, of_rig)) => fits(run, &locomotive.image, &of_locomotive, &of_rig),
        Err(reason) => Outcome::Failed(format!("two boards on a line: {reason}")),
    })
}

/// What both boards say.
fn on_two_boards(
    locomotive: &Board,
    rig: &Board,
    cycles: &str,
) -> Result<(Vec<String>, Vec<String>), String> {
    let socket = std::env::temp_dir().join(format!("yawbench-{}.sock", std::process::id()));
    let at = |options: &str| format!("unix:{}{options}", socket.display());
    let mut first = locomotive.command(&["uart", cycles]);
    first.args(["-serial", &at(",server=on,wait=on")]);
    let mut second = rig.command(&[]);
    second.args(["-serial", &at(",reconnect=1")]);
    let (first, second) = std::thread::scope(|scope| {
        let of_rig = scope.spawn(|| said(&mut second));
        let of_locomotive = said(&mut first);
        (of_locomotive, of_rig.join())
    });
    // The emulator that has made it may have removed it.
    let _gone = std::fs::remove_file(&socket);
    let second = second.map_err(|_| "a thread has panicked".to_owned())?;
    Ok((first?, second.map_err(|reason| format!("rig: {reason}"))?))
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
