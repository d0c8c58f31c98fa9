//! Comments wrap at 100 columns, as code does.

use crate::support::command::repository;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Longest line of a comment, characters.
const WIDTH: usize = 100;
/// Folders that are made, not kept.
const MADE: [&str; 3] = ["target", "runs", ".git"];

/// The files below a folder whose comments are checked.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let kept = path.extension().is_some_and(|ending| ending == "rs" || ending == "toml");
        if path.is_dir() && !path.is_symlink() && !MADE.contains(&&*name) {
            found.extend(sources(&path));
        } else if path.is_file() && kept {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The comment of a line: what follows `//` or `#` outside of strings.
fn comment<'a>(line: &'a str, mark: &str) -> Option<&'a str> {
    let (mut quoted, mut escaped) = (None, false);
    for (at, c) in line.char_indices() {
        match quoted {
            Some(_) if escaped => escaped = false,
            Some('"') if c == '\\' => escaped = true,
            Some(quote) if c == quote => quoted = None,
            // In Rust a single quote begins a lifetime or a character.
            None if c == '"' || (c == '\'' && mark == "#") => quoted = Some(c),
            None if line[at..].starts_with(mark) => {
                return Some(line[at..].trim_start_matches(['/', '!', '#']).trim());
            }
            Some(_) | None => {}
        }
    }
    None
}

/// True for a line that is too long and could be shorter.
fn is_too_long(line: &str, mark: &str) -> bool {
    line.chars().count() > WIDTH
        && comment(line, mark).is_some_and(|text| {
            !text.starts_with('|') && !text.contains("://") && text.contains(' ')
        })
}

#[test]
fn comments_wrap_at_100_columns() {
    let mut long = Vec::new();
    for path in sources(repository()) {
        let text = std::fs::read_to_string(&path).unwrap();
        let mark = if path.extension().is_some_and(|ending| ending == "rs") { "//" } else { "#" };
        let shown = path.strip_prefix(repository()).unwrap().display();
        for (index, line) in text.lines().enumerate().filter(|(_, line)| is_too_long(line, mark)) {
            long.push(format!("{shown}:{}: {} columns", index + 1, line.chars().count()));
        }
    }
    assert!(long.is_empty(), "{} comment lines are too long:\n{}", long.len(), long.join("\n"));
}

/// A merge that was left half done stood in a page for a day.
#[test]
fn no_file_holds_the_marks_of_a_merge() {
    let files = Command::new("git").arg("ls-files").current_dir(repository()).output();
    // A copy without its history has been looked at where it has one.
    let Ok(files) = files.map(|found| String::from_utf8_lossy(&found.stdout).into_owned()) else {
        return;
    };
    let marks = ["<<<<<<< ", ">>>>>>> ", "||||||| "];
    for file in files.lines() {
        // Neither a removed file nor one of bytes has lines.
        let Ok(text) = std::fs::read_to_string(repository().join(file)) else { continue };
        let marked = text.lines().position(|line| marks.iter().any(|mark| line.starts_with(mark)));
        assert_eq!(marked.map(|line| line + 1), None, "{file}: a merge is not finished");
    }
}

#[test]
fn tables_addresses_and_strings_may_be_longer() {
    let long = "long ".repeat(30);
    for (line, mark, expected) in [
        (format!("//! {long}"), "//", true),
        (format!("let x = 1; // {long}"), "//", true),
        (format!("x = 1 # {long}"), "#", true),
        (format!("x = \"a\\\"#\" # {long}"), "#", true),
        (format!("/// | {long} | b |"), "//", false),
        (format!("// see https://example.org/ {long}"), "//", false),
        (format!("let x = \"// {long}\";"), "//", false),
        (format!("x = '# {long}'"), "#", false),
        (format!("// {}", "x".repeat(150)), "//", false),
        ("// short".to_owned(), "//", false),
    ] {
        assert_eq!(is_too_long(&line, mark), expected, "{line}");
    }
}
