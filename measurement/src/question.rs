//! The layout of a file without a mapping, or what the file leaves open: one line with the keys of
//! a mapping that answer it.

use crate::header;
use crate::layout::{Layout, Separator};
use crate::lines;
use crate::recognition::{self, Recognised};
use crate::unit::Kind;
use files::quoted;

/// Names of candidates in a message.
const NAMED_MOST: usize = 4;
/// The way to a mapping.
const PROPOSAL: &str =
    "yawbench characterise --propose-mapping FILE writes a mapping to begin with";

/// The layout of a file without a mapping; without a force only where none is needed.
///
/// # Errors
/// What the file leaves open.
pub(crate) fn layout(text: &str, needs_force: bool) -> Result<Layout, OpenQuestions> {
    let own = Layout::own();
    let first = text.lines().find(|line| {
        !line.trim_start().starts_with(&own.comment) && !lines::is_blank(line, own.separator)
    });
    let names = first.map(|line| lines::cells(line, own.separator)).unwrap_or_default();
    let has = |name: &str| names.iter().any(|other| other == name);
    if has("time_s") && has("force_n") && (has("displacement_m") || has("velocity_m_per_s")) {
        return Ok(own);
    }
    // A motion without a force is a file of its own kind.
    if has("time_s") && has("displacement_m") && !names.iter().any(is_force) {
        return Ok(own);
    }
    let Some(found) = recognition::recognised(text) else { return Ok(own) };
    match OpenQuestions::of(&found, needs_force) {
        Some(questions) => Err(questions),
        None => Ok(found.layout().unwrap_or(own)),
    }
}

fn is_force(name: &str) -> bool {
    header::read(name, None).is_some_and(|header| header.kind == Kind::Force)
}

/// Why a file is not understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OpenQuestions {
    /// What was found.
    pub(crate) found: String,
    /// The keys of a mapping that decide.
    pub(crate) expected: String,
}

/// One question.
struct Question {
    /// What was found; `None` where no name means the kind.
    found: Option<String>,
    /// The key that decides.
    key: String,
}

impl OpenQuestions {
    /// The questions about a file, `None` where there is none.
    pub(crate) fn of(recognised: &Recognised, needs_force: bool) -> Option<Self> {
        let is_absent = |kind: Kind| recognised.column(kind) == Err(Vec::new());
        let has_velocity =
            recognised.column(Kind::Velocity).is_ok_and(|at| recognised.named(at).1.is_some());
        let is_needed = |kind: &Kind| match kind {
            Kind::Time => recognised.rate_hz.is_none(),
            Kind::Displacement => !has_velocity,
            _ => needs_force,
        };
        let kinds = [Kind::Time, Kind::Displacement, Kind::Force];
        let asked = kinds.into_iter().filter(|kind| is_needed(kind) || !is_absent(*kind));
        let mut questions: Vec<(Kind, Question)> =
            asked.filter_map(|kind| Some((kind, about(recognised, kind)?))).collect();
        if !recognised.decimal_is_certain {
            let question = Question {
                found: Some("commas that are decimal marks or group thousands".to_owned()),
                key: "decimal = \"comma\" or \"point\"".to_owned(),
            };
            questions.push((Kind::Force, question));
        }
        if questions.is_empty() {
            return None;
        }
        if recognised.names.is_empty() {
            return Some(Self {
                found: format!("{}, and no row of names", shape(recognised)),
                expected: format!(
                    "a mapping with header = false, in which the columns are called \"1\", \"2\", \
                     ...; {PROPOSAL}"
                ),
            });
        }
        let is_unnamed = |(_, question): &&(Kind, Question)| question.found.is_none();
        let unnamed = || questions.iter().filter(is_unnamed).map(|(kind, _)| *kind);
        let names: Vec<&str> = unnamed().map(Kind::name).collect();
        let own: Vec<&str> = unnamed().map(own_name).collect();
        let unnamed = (!names.is_empty()).then(|| {
            let (names, own) = (names.join(" or "), own.join(", "));
            format!("no column name that means {names} (such as {own})")
        });
        let found: Vec<String> = unnamed
            .into_iter()
            .chain(questions.iter().filter_map(|(_, question)| question.found.clone()))
            .collect();
        let keys: Vec<&str> = questions.iter().map(|(_, question)| question.key.as_str()).collect();
        Some(Self {
            found: format!(
                "{}; the columns {} ({})",
                found.join("; "),
                quoted(&recognised.names.join(", ")),
                shape(recognised)
            ),
            expected: format!("a mapping with {}; {PROPOSAL}", keys.join(", ")),
        })
    }
}

/// The name of this project's column.
const fn own_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Time => "time_s",
        Kind::Displacement => "displacement_m",
        _ => "force_n",
    }
}

/// How the rows are written.
fn shape(recognised: &Recognised) -> String {
    let separator = match recognised.separator {
        Separator::Comma => "commas",
        Separator::Semicolon => "semicolons",
        Separator::Tab => "tabs",
        Separator::Whitespace => "blanks",
    };
    let decimal = if recognised.has_decimal_commas() { ", decimal commas" } else { "" };
    format!(
        "rows of {} cells from line {} on, separated by {separator}{decimal}",
        recognised.first.len(),
        recognised.first_line
    )
}

/// What is open about a kind of column.
fn about(recognised: &Recognised, kind: Kind) -> Option<Question> {
    let name = kind.name();
    let key = |at: usize| format!("\"{}\"", quoted(&recognised.key(at)));
    let (found, key) = match recognised.column(kind) {
        Ok(at) => match (recognised.named(at), recognised.raw(at)) {
            ((_, Some(_)), _) => return None,
            (_, Some(raw)) => (
                Some(format!(
                    "the {name} {} in {}, which is not a unit of {name}",
                    key(at),
                    quoted(raw)
                )),
                format!(
                    "{name} = {{ column = {}, unit = \"{si}\", scale = ({si} per {}) }}",
                    key(at),
                    quoted(raw),
                    si = kind.si_name()
                ),
            ),
            // Seconds are the rule.
            _ if kind == Kind::Time => return None,
            ((column, None), None) => (
                Some(format!("no unit of the {name} \"{}\"", quoted(column))),
                format!("{name} = {{ column = {}, unit = ... }}", key(at)),
            ),
        },
        Err(several) if several.is_empty() => {
            let rate = if kind == Kind::Time { "sample_rate_hz = ... or " } else { "" };
            (None, format!("{rate}{name} = {{ column = ... }}"))
        }
        Err(several) => {
            let names: Vec<String> = several.iter().take(NAMED_MOST).map(|at| key(*at)).collect();
            let list = if kind == Kind::Force {
                " (force_column = [...] makes a test of each)"
            } else {
                ""
            };
            (
                Some(format!(
                    "{} columns that could be the {name}, {}",
                    several.len(),
                    names.join(" and ")
                )),
                format!("{name} = {{ column = {} }}{list}", names.join(" or ")),
            )
        }
    };
    Some(Question { found, key })
}
