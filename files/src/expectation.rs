//! What serde says is wrong, in the words of the file instead of those of the program.
//!
//! Serde names types of Rust, such as `struct DamperFile` or `u8`; a user writes tables and
//! numbers.

use crate::number::number;
use crate::similarity::closest;

/// A message of serde without names of Rust types, with a suggestion where a key or a name is
/// unknown. Other messages stay as they are.
///
/// ```
/// let plain = files::expectation::in_plain_words;
/// assert_eq!(plain("invalid type: integer `3`, expected struct DamperFile"),
///     "found the number `3`, expected a table");
/// assert_eq!(plain("unknown field `ke`, expected `ke_n` or `ce_n`"),
///     "unknown field `ke`, expected `ke_n` or `ce_n`; did you mean `ke_n`?");
/// ```
pub fn in_plain_words(said: &str) -> String {
    let (said, at) = split_json_place(said);
    let table = if at.is_empty() { "a table" } else { "an object" };
    if said.starts_with("data did not match any variant of untagged enum") {
        return format!("found a value of another form than expected{at}");
    }
    let Some((found, expected)) = said.rsplit_once(", expected ") else {
        return format!("{said}{at}");
    };
    let kinds = ["invalid type: ", "invalid value: "];
    if let Some(value) = kinds.iter().find_map(|kind| found.strip_prefix(kind)) {
        return format!(
            "found {}, expected {}{at}",
            value_in(value, table),
            type_in(expected, table)
        );
    }
    if let Some(length) = found.strip_prefix("invalid length ") {
        let entries = if length == "1" { "entry" } else { "entries" };
        return format!("found {length} {entries}, expected {}{at}", type_in(expected, table));
    }
    let unknown = ["unknown field `", "unknown variant `"];
    let word = unknown.iter().find_map(|kind| found.strip_prefix(kind)?.strip_suffix('`'));
    // Names stand between every second pair of back quotes.
    let known = expected.split('`').skip(1).step_by(2);
    let similar = word.and_then(|word| closest(word, known));
    let similar = similar.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    format!("{said}{at}{similar}")
}

/// A message without the place that `serde_json` puts behind it, and that place.
fn split_json_place(said: &str) -> (&str, &str) {
    let is_place = |at: &str| {
        let numbers = at.strip_prefix(" at line ").and_then(|at| at.split_once(" column "));
        let is_number = |text: &str| text.parse::<usize>().is_ok();
        numbers.is_some_and(|(line, column)| is_number(line) && is_number(column))
    };
    match said.rfind(" at line ").map(|at| said.split_at(at)) {
        Some((said, at)) if is_place(at) => (said, at),
        _ => (said, ""),
    }
}

/// What was found.
fn value_in(value: &str, table: &str) -> String {
    let quoted = |kind: &str| value.strip_prefix(kind)?.strip_suffix('`');
    if let Some(whole) = quoted("integer `") {
        return format!("the number `{whole}`");
    }
    if let Some(float) = quoted("floating point `") {
        let short = float.parse().map_or(float.to_owned(), |value| number(value).to_string());
        return format!("the number `{short}`");
    }
    if let Some(truth) = quoted("boolean `") {
        return format!("`{truth}`");
    }
    match value {
        "map" => table.to_owned(),
        "sequence" => "a list".to_owned(),
        "null" | "unit value" | "Option value" => "no value".to_owned(),
        value => value
            .strip_prefix("string ")
            .map_or(value.to_owned(), |text| format!("the text {text}")),
    }
}

/// What was expected.
fn type_in(expected: &str, table: &str) -> String {
    let whole = |bits: u32| {
        let most = u64::MAX >> (64 - bits);
        if bits < 64 {
            format!("a whole number from 0 to {most}")
        } else {
            "a whole number, 0 or more".to_owned()
        }
    };
    match expected {
        "u8" => whole(8),
        "u16" => whole(16),
        "u32" => whole(32),
        "u64" | "usize" => whole(64),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".to_owned(),
        "f32" | "f64" => "a number".to_owned(),
        "a boolean" | "bool" => "true or false".to_owned(),
        "a string" | "str" | "string" | "a borrowed string" => "a text".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => table.to_owned(),
        "variant identifier" | "field identifier" => "a name".to_owned(),
        other => {
            let nonzero = other.strip_prefix("a nonzero ").is_some();
            let list = ["a tuple of size ", "an array of length ", "tuple of "];
            let count = list.iter().find_map(|kind| other.strip_prefix(kind)?.split(' ').next());
            let tables = [
                "struct ",
                "tuple struct ",
                "newtype struct ",
                "struct variant ",
                "tuple variant ",
                "newtype variant ",
                "internally tagged enum ",
                "adjacently tagged enum ",
            ];
            if nonzero {
                "a whole number over 0".to_owned()
            } else if let Some(count) = count {
                format!("a list of {count}")
            } else if other.starts_with("enum ") {
                format!("a name or {table}")
            } else if tables.iter().any(|kind| other.starts_with(kind)) {
                table.to_owned()
            } else {
                other.to_owned()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::in_plain_words as plain;

    #[test]
    fn types_of_rust_are_named_as_what_a_file_holds() {
        for (said, expected) in [
            (
                "invalid value: integer `300`, expected u8",
                "found the number `300`, expected a whole number from 0 to 255",
            ),
            (
                "invalid value: integer `-1`, expected u64",
                "found the number `-1`, expected a whole number, 0 or more",
            ),
            ("invalid type: string \"a\", expected f64", "found the text \"a\", expected a number"),
            (
                "invalid type: map, expected struct variant IrregularityFile::Aar6",
                "found a table, expected a table",
            ),
            ("invalid type: boolean `true`, expected a sequence", "found `true`, expected a list"),
            (
                "invalid length 1, expected struct Manifest with 4 elements at line 1 column 3",
                "found 1 entry, expected an object at line 1 column 3",
            ),
            (
                "invalid length 3, expected an array of length 2",
                "found 3 entries, expected a list of 2",
            ),
            (
                "data did not match any variant of untagged enum Over",
                "found a value of another form than expected",
            ),
        ] {
            assert_eq!(plain(said), expected);
        }
        let long =
            format!("invalid type: floating point `1{}.0`, expected a string", "0".repeat(300));
        assert_eq!(plain(&long), "found the number `1e300`, expected a text");
    }

    #[test]
    fn other_messages_stay() {
        for said in [
            "missing field `a`",
            "unclosed table, expected `]`",
            "ends at line 3",
            "invalid string",
        ] {
            assert_eq!(plain(said), said);
        }
    }

    #[test]
    fn a_quoted_expectation_is_not_mistaken_for_the_real_one() {
        let said = "invalid type: string \"x, expected u8\", expected struct A";
        assert_eq!(plain(said), "found the text \"x, expected u8\", expected a table");
    }
}
