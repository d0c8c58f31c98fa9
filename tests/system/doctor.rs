//! `yawbench doctor` as a person uses it, on whatever machine this is.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;

fn doctor(args: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().arg("doctor").args(args).current_dir(repository()));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

#[test]
fn the_answer_fits_its_schema_and_its_exit_code() {
    let (code, printed, complained) = doctor(&["--bus", "socketcan:no-such-can", "--json"]);
    assert_eq!((code, complained.as_str()), (Some(1), ""), "{printed}");
    let answer: Value = serde_json::from_str(&printed).unwrap();
    let schema = read(&repository().join("docs/schema/doctor.schema.json"));
    let found = misfits(&serde_json::from_str(&schema).unwrap(), &answer);
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(answer["change"], true);
    assert_eq!(answer["bus"]["checks"][0]["found"], "no no-such-can");
    assert_eq!(answer["machine"].as_array().map(Vec::len), Some(12));
}

#[test]
fn the_text_names_a_change_for_each_row_that_asks_for_one() {
    let (code, printed, _) = doctor(&[]);
    let asks = printed.contains("There is something to change.");
    assert_eq!(code, Some(i32::from(asks)), "{printed}");
    assert_eq!(printed.contains("Ready."), !asks, "{printed}");
    assert!(printed.contains("real-time throttling"), "{printed}");
    let expected = "Messages of the protocol with 1 rig(s) at 1000 kbit/s, load";
    assert!(printed.contains(expected), "{printed}");
}

#[test]
fn the_messages_of_a_dbc_are_judged_at_its_bit_rate() {
    let place = folder("doctor");
    let file = place.join("bus.dbc");
    let text = "VERSION \"\"\nBU_: A B\n\
        BO_ 256 FAST: 8 A\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" B\n\n\
        BO_ 512 SLOW: 8 B\n SG_ x : 0|8@1+ (1,0) [0|0] \"\" A\n\n\
        BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n\
        BA_ \"GenMsgCycleTime\" BO_ 256 2;\nBA_ \"GenMsgCycleTime\" BO_ 512 3;\n";
    std::fs::write(&file, text).unwrap();
    let path = file.to_str().unwrap();
    let of = |bitrate| {
        let (_, printed, _) = doctor(&["--dbc", path, "--bitrate", bitrate, "--json"]);
        let answer: Value = serde_json::from_str(&printed).unwrap();
        answer["response_times"]["messages"].clone()
    };
    // 135 bits each: 0.27 ms at 500 kbit/s, 1.08 ms at 125 kbit/s.
    let quick = of("500k");
    assert_eq!((&quick[0]["name"], &quick[0]["response_us"]), (&"FAST".into(), &540.0.into()));
    assert_eq!((&quick[1]["name"], &quick[1]["verdict"]), (&"SLOW".into(), &"good".into()));
    let slow = of("125k");
    assert_eq!((&slow[0]["response_us"], &slow[0]["verdict"]), (&2160.0.into(), &"change".into()));
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn what_cannot_be_looked_at_is_one_line() {
    for (args, expected) in [
        (&["--bus", "memory"][..], "--bus memory: expected socketcan:INTERFACE"),
        (&["--dbc", "no-such.dbc"][..], "no-such.dbc: cannot be read"),
        (&["--dbc", "README.md"][..], "README.md:1: found no DBC, expected "),
        (&["--dbc", "can-protocol/yawbench.dbc"][..], "no --data-bitrate: expected one"),
        (&["--rigs", "5"][..], "--rigs 5: expected a whole number from 1 to 4"),
        (&["--bitrate", "0"][..], "--bitrate 0: expected a bit rate"),
    ] {
        let (code, printed, complained) = doctor(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
}
