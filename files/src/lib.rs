//! Files in and files out, alike for every command.
//!
//! What comes in: [`input`] opens regular files only, up to a limit, and names a file of another
//! kind by its first bytes; [`quote`] shows what stands in a file without letting it act on the
//! terminal. What goes out: [`ResultFolder`] never overwrites or deletes anything that the program
//! did not write; [`Identity`] says which question a result answers, from contents and never from
//! paths.
//!
//! Read [`input`] first, then [`folder`], then [`identity`].

mod error;
pub mod folder;
pub mod identity;
pub mod input;
mod kind;
mod manifest;
pub mod quote;

pub use error::FolderError;
pub use folder::ResultFolder;
pub use identity::Identity;
pub use input::{InputError, Limit};
pub use quote::quoted;
