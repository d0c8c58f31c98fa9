//! Files in and files out, alike for every command.
//!
//! What comes in: [`input`] opens regular files only, up to a limit, and names a file of another
//! kind by its first bytes; [`quote`] shows what stands in a file without letting it act on the
//! terminal. What goes out: [`ResultFolder`] never overwrites or deletes anything that the program
//! did not write; [`Identity`] says which question a result answers, from contents and never from
//! paths.
//!
//! Messages share four functions: [`quoted`] text of a file, [`number`] in a few characters,
//! [`did_you_mean`] for names, and [`quote::message`] for what toml, csv and serde say
//! ([`expectation`] replaces names of Rust types).
//!
//! Read [`input`] first, then [`folder`], then [`identity`].
//!
//! There are two errors, one per direction. [`InputError`] is part of the error of every crate that
//! reads files; it is always the user's input and can be compared and copied. [`FolderError`] is
//! seen by commands only; it carries the system's error, since a disk that fails is no bad input.

mod error;
pub mod expectation;
pub mod folder;
pub mod identity;
pub mod input;
mod kind;
mod manifest;
mod number;
pub mod quote;
mod say;
mod similarity;
pub mod suggestion;

pub use error::FolderError;
pub use folder::ResultFolder;
pub use identity::Identity;
pub use input::{InputError, Limit};
pub use number::{Number, number};
pub use quote::quoted;
pub use suggestion::did_you_mean;
