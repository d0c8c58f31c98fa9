//! A command line that clap refuses, in one line: the option, what was found, what was expected.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error as _;
use std::num::{IntErrorKind, ParseFloatError, ParseIntError};

/// The error in one line; `command` is the first word of the command line.
pub(crate) fn one_line(error: &clap::Error, command: Option<&str>) -> String {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        Some(ContextValue::Strings(texts)) if !texts.is_empty() => Some(texts.join(", ")),
        Some(ContextValue::Number(number)) => Some(number.to_string()),
        _ => None,
    };
    let argument = text(ContextKind::InvalidArg);
    let line = match error.kind() {
        ErrorKind::UnknownArgument => argument.map(|argument| {
            moved(command, &argument).unwrap_or_else(|| {
                let found = if argument.starts_with('-') {
                    "unknown option"
                } else {
                    "unexpected argument"
                };
                let similar = text(ContextKind::SuggestedArg);
                format!("{}: {found}{}", quoted(&argument), did_you_mean(similar))
            })
        }),
        ErrorKind::InvalidSubcommand => text(ContextKind::InvalidSubcommand).map(|given| {
            let similar = text(ContextKind::SuggestedSubcommand);
            let help =
                if similar.is_none() { "; `yawbench --help` lists the commands" } else { "" };
            format!("{}: unknown command{}{help}", quoted(&given), did_you_mean(similar))
        }),
        ErrorKind::InvalidValue => argument.map(|argument| {
            let option = option(&argument);
            let value = text(ContextKind::InvalidValue).unwrap_or_default();
            let values = text(ContextKind::ValidValue);
            let expected =
                values.map_or_else(|| "a value".to_owned(), |all| format!("one of {all}"));
            if value.is_empty() {
                return format!("{option}: found no value, expected {expected}");
            }
            let similar = did_you_mean(text(ContextKind::SuggestedValue));
            format!("{option} {}: expected {expected}{similar}", quoted(&value))
        }),
        ErrorKind::ValueValidation => argument.map(|argument| {
            let value = text(ContextKind::InvalidValue).unwrap_or_default();
            let (option, reason) = (option(&argument), reason(error, &value));
            if value.is_empty() {
                return format!("{option}: found an empty value, {reason}");
            }
            format!("{option} {}: {reason}", quoted(&value))
        }),
        ErrorKind::TooManyValues => argument.map(|argument| {
            let value = text(ContextKind::InvalidValue).unwrap_or_default();
            format!("{} {}: expected no value", option(&argument), quoted(&value))
        }),
        ErrorKind::MissingRequiredArgument => {
            argument.map(|lacking| format!("{lacking} is missing"))
        }
        ErrorKind::ArgumentConflict => argument.map(|argument| match text(ContextKind::PriorArg) {
            Some(other) if other != argument => {
                format!("{}: cannot be used with {}", option(&argument), option(&other))
            }
            _ => format!("{}: given twice, expected once", option(&argument)),
        }),
        _ => None,
    };
    line.unwrap_or_else(|| files::quote::message(&joined(&error.render().to_string())))
}

/// Why the value of an option is refused.
fn reason(error: &clap::Error, value: &str) -> String {
    let Some(source) = error.source() else { return "expected another value".to_owned() };
    if source.is::<ParseFloatError>() {
        return "expected a number".to_owned();
    }
    if let Some(why) = source.downcast_ref::<ParseIntError>() {
        let negative = value.strip_prefix('-').is_some_and(|rest| rest.parse::<u64>().is_ok());
        return match why.kind() {
            IntErrorKind::Zero => "expected a whole number over 0",
            IntErrorKind::PosOverflow => "expected a smaller whole number",
            _ if negative => "expected a whole number, 0 or more",
            _ => "expected a whole number",
        }
        .to_owned();
    }
    let mut said = source.to_string();
    // The value stands in the line already.
    if said.starts_with("found ")
        && let Some(at) = said.rfind(", expected ")
    {
        said = said.split_off(at + 2);
    }
    let range = said.split_once(" is not in ").and_then(|(_, range)| range.split_once("..="));
    range
        .map_or(said.clone(), |(low, high)| format!("expected a whole number from {low} to {high}"))
}

/// The answer to options that have become a command.
fn moved(command: Option<&str>, argument: &str) -> Option<String> {
    let of_campaign = ["--campaign", "--seed", "--shard", "--brief", "--merge"];
    let new = match argument {
        "--merge" => "yawbench campaign --merge JSONL...",
        _ => "yawbench campaign --cases N --seed S",
    };
    let moved = command == Some("identify") && of_campaign.contains(&argument);
    moved.then(|| format!("identify {argument}: the campaign is a command of its own: `{new}`"))
}

fn did_you_mean(similar: Option<String>) -> String {
    similar.map_or(String::new(), |similar| format!("; did you mean {similar}?"))
}

/// The option of `--option <VALUE>`.
fn option(argument: &str) -> &str {
    if argument.starts_with('-') {
        argument.split([' ', '=']).next().unwrap_or(argument)
    } else {
        argument
    }
}

/// A word of the command line as it may be shown.
fn quoted(word: &str) -> String {
    files::quoted(word).to_string()
}

/// What clap prints, in one line and without the usage behind it.
fn joined(printed: &str) -> String {
    let lines = printed.lines().map(str::trim).filter(|line| !line.is_empty());
    let kept =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let line = kept.collect::<Vec<_>>().join("; ").replace(":; ", ": ");
    line.strip_prefix("error: ").map(str::to_owned).unwrap_or(line)
}
