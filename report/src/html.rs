//! Text into HTML: the only door through which words reach the page.

/// Escapes text for element content and for double-quoted attributes alike.
///
/// Control characters that no HTML file may hold, and marks that turn the direction of writing,
/// become the replacement sign: a broken byte in a file name is visible and does not end the page.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if files::quote::acts(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A name with its unit, as on an axis: `force (kN)`; a pure number has an empty unit.
pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// Escapes JSON that stands inside a `<script>` element, where only `<` can do harm.
pub(crate) fn escape_json(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::{escape, escape_json};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn no_text_can_open_a_tag_or_leave_an_attribute(text in any::<String>()) {
            let escaped = escape(&text);
            prop_assert!(!escaped.contains(['<', '>', '"', '\'']));
            prop_assert!(!escaped.chars().any(|c| c.is_control() && c != '\n' && c != '\t'));
            for (at, _) in escaped.match_indices('&') {
                let entity = &escaped[at..];
                let known = ["&amp;", "&lt;", "&gt;", "&quot;", "&#39;"];
                prop_assert!(known.iter().any(|e| entity.starts_with(e)));
            }
        }

        #[test]
        fn escaped_json_is_the_same_value_and_holds_no_tag(text in any::<String>()) {
            let json = serde_json::Value::from(text).to_string();
            let escaped = escape_json(&json);
            prop_assert!(!escaped.contains('<'));
            let (a, b): (serde_json::Value, serde_json::Value) =
                (serde_json::from_str(&json).unwrap(), serde_json::from_str(&escaped).unwrap());
            prop_assert_eq!(a, b);
        }
    }
}
