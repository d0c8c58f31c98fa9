//! A run over SocketCAN is replayed from its files, and its log by canplayer to an emulated rig.

use crate::interface::Candump;
use crate::rig::{
    COMMAND, LOCK_STEP_RIG, MEASUREMENT, Rig, alone, assert_replays, hear, hex, host, listener,
    out, parts, summary,
};
use can_protocol::MessageId;
use std::path::Path;
use std::process::Command;

#[test]
fn a_run_in_lock_step_is_replayed_bit_for_bit() {
    let Some((vcan, _turn)) = alone() else { return };
    let (bus, folder) = (format!("socketcan:{vcan}"), out(&vcan, "replayed"));
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let options = ["--pace", "lockstep", "--overwrite"];
    let run = host(&bus, "3", &folder, &options).output().expect("the host");
    let end = summary(&run);
    rig.end();
    assert!(end["cycles"].as_u64() > Some(3000), "{end}");
    assert_replays(&folder);
    let _ = std::fs::remove_dir_all(folder);
}

/// Frames that canplayer sends in one go. It keeps to the times of the log, and after the machine
/// stood still it sends all that are due at once: more than a receive buffer holds are lost.
const PIECE: usize = 100;

#[test]
fn canplayer_moves_a_rig_that_accepts_the_log_and_no_other() {
    let Some((vcan, _turn)) = alone() else { return };
    let folder = out(&vcan, "played");
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let bus = format!("socketcan:{vcan}");
    let run = host(&bus, "2", &folder, &["--pace", "lockstep", "--overwrite"]).output();
    assert_eq!(summary(&run.expect("the host"))["state"], "completed");
    rig.end();
    let log = std::fs::read_to_string(folder.join("bus.log")).expect("bus.log");
    let of_host: Vec<&str> = log.lines().filter(|line| line.ends_with(" T")).collect();

    let whole = folder.join("bus.log").display().to_string();
    let accepting = [LOCK_STEP_RIG, &["--accept-replay", &whole]].concat();
    let mut rig = Rig::start(&vcan, &accepting);
    let candump = Candump::start(&vcan);
    let socket = listener(&vcan);
    rig.wait_until_it_listens();
    for piece in of_host.chunks(PIECE) {
        play(piece, &folder);
        let commands = piece.iter().filter(|line| line.contains(&of(COMMAND))).count();
        assert_eq!(hear(&socket, MEASUREMENT, commands).len(), commands, "{}", piece[0]);
    }
    let (_, end) = rig.end();
    let measured = |id: u16, data: &[u8]| (id == MEASUREMENT.raw()).then(|| data.to_vec());
    let again: Vec<Vec<u8>> = candump
        .stop()
        .iter()
        .filter_map(parts)
        .filter_map(|(id, data)| measured(id, &data))
        .collect();
    assert_eq!(end["runs"], 1, "{end}");
    // The ram moves as it did, so the same plant measures the same, sealed by the same session.
    let before: Vec<_> = log.lines().filter(|line| line.contains(&of(MEASUREMENT))).collect();
    assert!(again.len() >= before.len(), "{} of {}", again.len(), before.len());
    for (line, data) in before.iter().zip(&again) {
        let played = format!("{}{} ", of(MEASUREMENT), hex(data));
        assert!(line.contains(&played), "{line}: {played}");
    }

    let mut other = Rig::start(&vcan, LOCK_STEP_RIG);
    other.wait_until_it_listens();
    play(&of_host, &folder);
    let end = other.interrupt();
    assert_eq!((&end["runs"], &end["frames"]["received"]), (&0.into(), &0.into()), "{end}");
    let _ = std::fs::remove_dir_all(folder);
}

/// Lets canplayer send lines of a log, with the gaps between them.
fn play(lines: &[&str], folder: &Path) {
    let log = folder.join("host.log");
    std::fs::write(&log, lines.join("\n") + "\n").expect("a log");
    let player = Command::new("canplayer").arg("-I").arg(&log).output();
    let player = player.expect("canplayer, from the package can-utils");
    assert!(player.status.success(), "{}", String::from_utf8_lossy(&player.stderr));
}

/// How a log writes the identifier of a message, in front of its data.
fn of(id: MessageId) -> String {
    format!(" {:03X}#", id.raw())
}
