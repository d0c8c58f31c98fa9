//! Where a message or a signal stands in the text of a DBC: the parser does not say.

/// The lines, from one, of messages of a name.
pub(crate) fn lines_of_message(text: &str, message: &str) -> impl Iterator<Item = usize> {
    let is_it = move |line: &str| {
        let mut words = line.split_whitespace();
        let name = words.next().filter(|word| *word == "BO_").and_then(|_| words.nth(1));
        name.is_some_and(|name| name.trim_end_matches(':') == message)
    };
    (1..).zip(text.lines()).filter_map(move |(number, line)| is_it(line).then_some(number))
}

/// The line, from one, of a signal of a message.
pub(crate) fn line_of(text: &str, message: &str, signal: &str) -> Option<usize> {
    let mut is_in_message = false;
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("BO_") => {
                let name = words.nth(1).map(|name| name.trim_end_matches(':'));
                is_in_message = name == Some(message);
            }
            Some("SG_") if is_in_message => {
                let name = words.next().map(|name| name.trim_end_matches(':'));
                if name == Some(signal) {
                    return Some(number);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_is_found_in_its_own_message() {
        let text =
            "BO_ 1 A: 8 X\n SG_ f : 0|8@1+\n SG_ g: 8|8@1+\n\nBO_ 2 B : 8 X\n SG_ f m0 : 0|8@1+";
        assert_eq!(line_of(text, "A", "f"), Some(2));
        assert_eq!(line_of(text, "A", "g"), Some(3));
        assert_eq!(line_of(text, "B", "f"), Some(6));
        assert_eq!(line_of(text, "B", "g"), None);
    }
}
