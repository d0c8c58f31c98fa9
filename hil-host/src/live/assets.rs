//! The page itself: a document, its style and its script, all of them in the program.

use std::fmt::Write as _;

/// What holds the token in the document.
const TOKEN: &str = "TOKEN-OF-THIS-RUN";

/// The parts of the page.
#[derive(Debug)]
pub(super) struct Assets {
    pub(super) page: String,
    pub(super) style: String,
    pub(super) script: &'static str,
}

impl Assets {
    /// The page of a run with this token.
    pub(super) fn new(token: &str) -> Self {
        let mut colours = String::new();
        for (slot, colour) in report::PALETTE.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = writeln!(colours, "  --slot-{slot}: {colour};");
        }
        Self {
            page: include_str!("../../assets/live/page.html").replace(TOKEN, token),
            style: format!(":root {{\n{colours}}}\n{}", include_str!("../../assets/live/page.css")),
            script: include_str!("../../assets/live/page.js"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_its_token_and_nothing_that_its_policy_forbids() {
        let assets = Assets::new("0123abcd");
        assert!(assets.page.contains("content=\"0123abcd\"") && !assets.page.contains(TOKEN));
        for forbidden in ["<style", "style=", "onclick", "javascript:", "http://", "https://"] {
            assert!(!assets.page.contains(forbidden), "{forbidden}");
        }
        let scripts: Vec<&str> = assets.page.split("<script").skip(1).collect();
        assert!(scripts.len() == 1 && scripts[0].starts_with(" src=\"page.js\""), "{scripts:?}");
        for forbidden in
            ["innerHTML", "insertAdjacent", "document.write", "eval(", "Function(", "://"]
        {
            assert!(!assets.script.contains(forbidden), "{forbidden}");
        }
        assert!(!assets.style.contains("url(") && !assets.style.contains("@import"));
        assert!(assets.style.contains("--slot-0: #0b4f8a;"));
    }

    #[test]
    fn the_button_is_never_called_an_emergency_stop() {
        let page = Assets::new("0").page;
        assert!(page.contains(">Ramp out</button>"));
        let text = page.to_lowercase();
        assert_eq!(
            text.matches("emergency").count(),
            text.matches("no emergency stop").count()
                + text.matches("the emergency stop is hardware").count()
        );
        assert!(text.contains("no emergency stop"));
    }
}
