//! The codec against another one: `vectors.json` holds frames and values by Python's cantools, of a
//! database that has every kind of signal (`foreign.dbc`). `vectors.py` writes it.
#![allow(clippy::unwrap_used, reason = "a test stops where it fails")]

use dbc::{Database, DbcError, Fit, Value};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Debug, Deserialize)]
struct Vector {
    message: String,
    id: u32,
    is_extended: bool,
    data: String,
    values: BTreeMap<String, f64>,
    absent: Vec<String>,
}

impl Vector {
    fn data(&self) -> Vec<u8> {
        let digits = self.data.as_bytes().chunks(2);
        digits.map(|two| u8::from_str_radix(str::from_utf8(two).unwrap(), 16).unwrap()).collect()
    }

    fn name(&self, signal: &str) -> String {
        format!("{}.{signal}", self.message)
    }
}

fn vectors() -> Vec<Vector> {
    serde_json::from_str(include_str!("vectors.json")).unwrap()
}

fn database() -> Database {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/codec/foreign.dbc");
    Database::read(&path).unwrap()
}

fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-12 * one.abs().max(other.abs())
}

#[test]
fn frames_of_cantools_read_as_it_reads_them() {
    let (database, vectors) = (database(), vectors());
    let mut read = 0;
    for vector in &vectors {
        let data = vector.data();
        for (signal, value) in &vector.values {
            let (message, named) = database.signal(&vector.name(signal)).unwrap();
            assert_eq!((message.id.raw(), message.len), (vector.id, data.len()));
            assert_eq!(message.id.is_extended(), vector.is_extended);
            match named.signal.read(&data) {
                Value::Valid(found) if is_near(found, *value) => read += 1,
                found => panic!("{}: {found:?}, by cantools {value}", named.name),
            }
        }
        for signal in &vector.absent {
            let (_, named) = database.signal(&vector.name(signal)).unwrap();
            assert_eq!(named.signal.read(&data), Value::Absent, "{}", named.name);
        }
    }
    assert!(read > 700, "{read} values");
}

#[test]
fn values_of_cantools_are_written_as_it_writes_them() {
    let database = database();
    for vector in vectors() {
        let mut data = vec![0; vector.data().len()];
        // Of a multiplexed message the selectors are written by their signals.
        for (signal, value) in vector.values.iter().rev() {
            let (_, named) = database.signal(&vector.name(signal)).unwrap();
            assert_eq!(named.signal.write(&mut data, *value), Fit::Fits, "{}", named.name);
        }
        assert_eq!(data, vector.data(), "{vector:?}");
    }
}

#[test]
fn a_multiplexed_signal_chooses_its_page() {
    let database = database();
    let (_, deep) = database.signal("Deep").unwrap();
    let mut data = [0; 8];
    deep.signal.write(&mut data, 1.0);
    assert_eq!(data, [3, 20, 10, 0, 0, 0, 0, 0]);
    // One of its own pages is left as it is.
    data[1] = 30;
    deep.signal.write(&mut data, 2.0);
    assert_eq!(data, [3, 30, 20, 0, 0, 0, 0, 0]);
}

#[test]
fn errors_name_the_file_the_line_and_the_signal() {
    let said = |name: &str| database().signal(name).unwrap_err().to_string();
    assert!(said("Position").contains("one of Floats.Position, Pages.Position"));
    assert!(said("Forse").ends_with("; did you mean Force?"), "{}", said("Forse"));
    assert!(said("Nested.Deap").ends_with("; did you mean Nested.Deep?"));

    let bad = |signal: &str, more: &str| {
        let text = format!("BU_: X\n\nBO_ 5 M: 4 X\n{signal} \"\" X\n{more}\n");
        let database = Database::from_text(Path::new("rig.dbc"), &text)?;
        database.signal("S").map(|_| String::new())
    };
    let said = |signal: &str, more: &str| bad(signal, more).unwrap_err().to_string();
    for (signal, more, found) in [
        (" SG_ S : 24|9@1+ (1,0) [0|0]", "", "bits behind the 4 bytes of its message"),
        (" SG_ S : 0|16@1+ (0,0) [0|0]", "", "factor 0 and offset 0"),
        (" SG_ S : 0|16@1- (1,0) [0|0]", "SIG_VALTYPE_ 5 S : 1;", "16 bits"),
        (" SG_ S m1 : 0|16@1+ (1,0) [0|0]", "", "no selector of its page"),
        (
            " SG_ S m1 : 0|9@1+ (1,0) [0|0]",
            " SG_ P M : 8|2@1+ (1,0) [0|0] \"\" X",
            "bits of its own",
        ),
        (
            " SG_ S : 0|8@1+ (1,0) [0|0]",
            " SG_ S : 8|8@1+ (1,0) [0|0] \"\" X",
            "a second one of this name in its message, expected names of their own",
        ),
        (" SG_ S : 0|16@1+ (1,0) [5|-5]", "", "limits [5|-5], expected the lower one first"),
    ] {
        let said = said(signal, more);
        assert!(said.starts_with("rig.dbc:4: signal M.S: found "), "{said}");
        assert!(said.contains(found), "{said}");
    }
    let syntax = said(" SG_ S 0|16@1+ (1,0) [0|0]", "");
    assert!(syntax.starts_with("rig.dbc:4: ") && !syntax.contains('\n'), "{syntax}");
    let again = "\nBO_ 6 M: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X";
    let twice = said(" SG_ S : 0|8@1+ (1,0) [0|0]", again);
    assert!(twice.starts_with("rig.dbc:6: message M: found a second message"), "{twice}");
    let other = "\nBO_ 5 N: 8 X\n SG_ T : 0|8@1+ (1,0) [0|0] \"\" X";
    let same = said(" SG_ S : 0|8@1+ (1,0) [0|0]", other);
    assert!(same.starts_with("rig.dbc:3: message M: found the identifier of message N"), "{same}");
    let absent = Database::read(Path::new("none.dbc")).unwrap_err();
    assert!(matches!(absent, DbcError::Input(_)) && absent.is_bad_input());
}
