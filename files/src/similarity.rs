//! Which of some names is close to a wrong one.

/// Similarity (Jaro) from which a name is worth suggesting.
pub(crate) const SIMILAR: f64 = 0.75;

/// The name among the known ones that `word` was probably meant to be.
///
/// ```
/// assert_eq!(files::suggestion::closest("shrt", ["full", "short"]), Some("short"));
/// assert_eq!(files::suggestion::closest("xyz", ["full", "short"]), None);
/// ```
pub fn closest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let scored = known.into_iter().map(|name| (strsim::jaro(word, name), name));
    let near = scored.filter(|(score, name)| *score >= SIMILAR && *name != word);
    // The first one of equals.
    near.reduce(|best, next| if next.0 > best.0 { next } else { best }).map(|(_, name)| name)
}
