//! What is no table of text gets one clear line, and no text of a file acts on the terminal.

use crate::support::{Folder, NAMES, record};
use measurement::read_tests;
use std::path::{Path, PathBuf};

/// The message about a file, without its path.
fn refused(path: &Path, mapping: Option<&Path>) -> String {
    let error = read_tests(&[path.to_owned()], mapping).unwrap_err();
    assert!(error.is_bad_input());
    let message = error.to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(!message.contains(char::is_control), "{message:?}");
    assert!(message.len() < 1000, "{} bytes", message.len());
    message
}

#[test]
fn a_file_that_is_no_text_table_is_named_and_not_read() {
    let folder = Folder::new("kinds");
    let pipe = folder.join("pipe.csv");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let large = folder.join("large.csv");
    std::fs::File::create(&large).unwrap().set_len(4_000_000_001).unwrap();
    let excel = folder.write("excel.csv", b"PK\x03\x04 [Content_Types].xml xl/workbook.xml");
    let cases: [(PathBuf, &str); 6] = [
        (pipe, "found a named pipe, expected a file"),
        ("/dev/zero".into(), "found a device, expected a file"),
        (folder.to_path_buf(), "found a folder, expected a file"),
        (excel, "found an Excel workbook, expected text: save the sheet as CSV"),
        (large, "found 4000000001 bytes, expected at most 4000 MB"),
        (folder.join("none.csv"), "cannot be read: No such file"),
    ];
    for (path, expected) in cases {
        let message = refused(&path, None);
        let expected = format!("{}: {expected}", path.display());
        assert!(message.starts_with(&expected), "{message} / {expected}");
    }
}

#[test]
fn a_terminal_sequence_in_a_cell_reached_the_terminal() {
    let folder = Folder::new("sequence");
    let good = record(NAMES);
    let cell = folder.write("cell.csv", good.replacen("20.0", "\u{1b}[31mred", 1));
    let message = refused(&cell, None);
    assert!(message.contains("found \"\\u{1b}[31mred\", expected a finite number"), "{message}");
    let name = folder.write("name.csv", good.replacen("force_n", "\u{1b}[31mforce", 1));
    let message = refused(&name, None);
    assert!(message.contains("displacement_m, \\u{1b}[31mforce"), "{message}");
    let direction = folder.write("side.csv", format!("# extension: \u{1b}[2J\n{good}"));
    assert!(refused(&direction, None).contains("found \"\\u{1b}[2J\""));
    let odd = folder.write("a\u{1b}[31m.csv", "time_s\n");
    assert!(refused(&odd, None).contains("a\\u{1b}[31m.csv: found no rows"));
}

#[test]
fn a_cell_of_a_megabyte_is_cut() {
    let folder = Folder::new("megabyte");
    let long = "x".repeat(1_000_000);
    let good = record(NAMES);
    let cell = folder.write("cell.csv", good.replacen("20.0", &long, 1));
    assert!(refused(&cell, None).contains("(1000000 characters)"));
    let name = folder.write("name.csv", good.replacen("force_n", &long, 1));
    refused(&name, None);
    let mapping = format!("extension = \"unknown\"\nwhere = {{ force_n = \"{long}\" }}\n");
    let mapping = folder.write("m.toml", mapping);
    let good = folder.write("good.csv", &good);
    assert!(refused(&good, Some(&mapping)).contains("no row that fits where.force_n"));
    let unit = folder.write("u.toml", format!("[force]\nunit = \"\\u001b{long}\"\n"));
    assert!(refused(&good, Some(&unit)).contains("u.toml:2: unit = \"\\u{1b}xxx"));
}

#[test]
fn names_and_repairs_from_a_file_are_safe_to_print() {
    let folder = Folder::new("names");
    let velocity = "velocity\u{1b}[31m";
    let text = record(&format!("time_s,displacement_m,force_n,{velocity}"));
    let path = folder.write("a\u{1b}b.csv", text.replace("20.0", "3.0"));
    let mapping = "displacement = { column = \"displacement_m\" }\nsplit_by = [\"%\"]\n\
        velocity = { column = \"%\" }\nextension = \"positive\"\n"
        .replace('%', "velocity\\u001b[31m");
    let mapping = folder.write("m.toml", mapping);
    let tests = read_tests(&[path], Some(&mapping)).unwrap();
    let printed = format!("{}{:?}", tests[0].name, tests[0].repairs);
    assert!(!printed.contains('\u{1b}'), "{printed:?}");
    assert_eq!(tests[0].name, "a_b-velocity__31m3.0");
}
