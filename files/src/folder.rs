//! Where the files of a result go.
//!
//! Nothing of the user's is overwritten or deleted: a file is made only where none is, and replaced
//! or removed only where the folder's manifest lists it as the program's own. The folder itself may
//! be named by a symbolic link; links among its entries are not followed.

use crate::error::FolderError;
use crate::identity::Identity;
use crate::manifest::{self, Manifest};
use rustix::fs::Access;
use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// The folder of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultFolder {
    path: PathBuf,
    command: &'static str,
    identity: Option<Identity>,
    /// An earlier result in it may be replaced.
    overwrite: bool,
    /// The path was not given: another may be taken.
    by_default: bool,
}

impl ResultFolder {
    /// A folder for a result of its own: `given`, or the next free `runs/<name>-<n>`. Nothing is
    /// made.
    ///
    /// # Errors
    /// [`FolderError::Holds`] where `given` holds a result and `overwrite` is false;
    /// [`FolderError::OtherCommand`] where it holds that of another command.
    pub fn fresh(
        given: Option<&Path>,
        name: &str,
        command: &'static str,
        overwrite: bool,
    ) -> Result<Self, FolderError> {
        let by_default = given.is_none();
        let path = given.map_or_else(|| free(name, 1), Path::to_owned);
        if let Some(held) = Manifest::of(&path)? {
            if held.command != command {
                return Err(FolderError::OtherCommand(path, held.command, command));
            }
            if !overwrite {
                return Err(FolderError::Holds(path, held.command));
            }
        }
        Ok(Self { path, command, identity: None, overwrite, by_default })
    }

    /// The folder of a question: `given`, or `runs/<name>`, or the first `runs/<name>-<n>` that
    /// holds this question or nothing. Where another is taken than `runs/<name>`, the second value
    /// says what changed. Nothing is made.
    ///
    /// # Errors
    /// [`FolderError::Other`] where `given` holds the result of another question.
    pub fn for_identity(
        given: Option<&Path>,
        name: &str,
        command: &'static str,
        identity: &Identity,
    ) -> Result<(Self, Option<String>), FolderError> {
        let by_default = given.is_none();
        let folder = |path: PathBuf| Self {
            path,
            command,
            identity: Some(identity.clone()),
            overwrite: false,
            by_default,
        };
        let other = |path: &Path| -> Result<Option<Vec<String>>, FolderError> {
            let Some(held) = Manifest::of(path)? else {
                let foreign = by_default && holds_anything(path);
                return Ok(foreign.then(|| vec!["files without a manifest".to_owned()]));
            };
            Ok(match held.identity {
                Some(held) if held == *identity => None,
                Some(held) => Some(identity.changes(&held)),
                None => Some(vec!["the command".to_owned()]),
            })
        };
        if let Some(given) = given {
            let Some(changes) = other(given)? else { return Ok((folder(given.to_owned()), None)) };
            let held = Manifest::of(given)?.and_then(|held| held.identity);
            let held = held.map_or_else(|| "no study".to_owned(), |held| held.name());
            let (given, name) = (given.to_owned(), identity.name());
            return Err(FolderError::Other(given, held, name, changes));
        }
        let first = Path::new("runs").join(name);
        let Some(mut changes) = other(&first)? else { return Ok((folder(first), None)) };
        let (mut before, mut n) = (first, 2);
        loop {
            let path = free_name(name, n);
            let Some(later) = other(&path)? else {
                let (held, now, what) = (before.display(), path.display(), changes.join(", "));
                let said = format!("{held} holds another result ({what}): using {now}");
                return Ok((folder(path), Some(said)));
            };
            (before, changes, n) = (path, later, n + 1);
        }
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of a result of `command` that is there; its files may be replaced.
    ///
    /// # Errors
    /// [`FolderError::NoResult`] where it holds none of that command.
    pub fn existing(path: &Path, command: &'static str) -> Result<Self, FolderError> {
        let found = Manifest::of(path)?.map(|held| held.command);
        if found.as_deref() != Some(command) {
            return Err(FolderError::NoResult(path.to_owned(), found, command));
        }
        let path = path.to_owned();
        Ok(Self { path, command, identity: None, overwrite: true, by_default: false })
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        debug_assert!(manifest::is_inside(name), "{name} leads out of the folder");
        self.path.join(name)
    }

    /// Shows before long work that the folder can be made and that `names` are free in it; leaves
    /// nothing behind.
    ///
    /// # Errors
    /// [`FolderError::NoPlace`], [`FolderError::Occupied`].
    pub fn check(&self, names: &[&str]) -> Result<(), FolderError> {
        let ours = Manifest::of(&self.path)?;
        if let Some(held) = ours.as_ref().filter(|_| self.overwrite) {
            self.check_removable(held)?;
        }
        for name in std::iter::once(&manifest::NAME).chain(names) {
            let known = |held: Option<&Manifest>| {
                held.is_some_and(|held| *name == manifest::NAME || held.files.contains(*name))
            };
            // Another shard of this study may have made the folder since the manifest was read.
            let taken = !known(ours.as_ref())
                && self.file(name).symlink_metadata().is_ok()
                && !known(Manifest::of(&self.path)?.as_ref());
            if taken {
                return Err(FolderError::Occupied(self.file(name)));
            }
        }
        self.check_place()
    }

    /// Whether the folder can be made. Nothing is tried: a shard that begins at the same time may
    /// be making it.
    fn check_place(&self) -> Result<(), FolderError> {
        let no_place = |why| Err(FolderError::NoPlace(self.path.clone(), why));
        for path in self.path.ancestors() {
            let path = if path == Path::new("") { Path::new(".") } else { path };
            match path.metadata() {
                Ok(about) if about.is_dir() => {
                    let allowed = rustix::fs::access(path, Access::WRITE_OK | Access::EXEC_OK);
                    return allowed.or_else(|why| no_place(why.into()));
                }
                Ok(_) => return no_place(io::ErrorKind::NotADirectory.into()),
                Err(why) if why.kind() == io::ErrorKind::NotFound => {}
                Err(why) => return no_place(why),
            }
        }
        Ok(())
    }

    /// Bytes that are free on the disk of the folder, or where it will be made; none where the
    /// system does not say.
    pub fn free_bytes(&self) -> Option<u64> {
        let mut places = self.path.ancestors();
        places.find_map(|path| {
            let path = if path == Path::new("") { Path::new(".") } else { path };
            let about = rustix::fs::statvfs(path).ok()?;
            Some(about.f_bavail.saturating_mul(about.f_frsize))
        })
    }

    /// Refuses to replace a result that the command itself reads, under whatever name.
    ///
    /// # Errors
    /// [`FolderError::IsInput`].
    pub fn refuse_inputs<'a>(
        &self,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<(), FolderError> {
        let Some(held) = Manifest::of(&self.path)? else { return Ok(()) };
        let node = |path: &Path| path.metadata().ok().map(|about| (about.dev(), about.ino()));
        let listed: Vec<_> = held.files.iter().filter_map(|name| node(&self.file(name))).collect();
        for input in inputs {
            if node(input).is_some_and(|node| listed.contains(&node)) {
                return Err(FolderError::IsInput(input.to_owned()));
            }
        }
        Ok(())
    }

    /// Makes the folder and its manifest. An earlier result goes where it may be overwritten: every
    /// file that its manifest lists, and no other.
    ///
    /// # Errors
    /// [`FolderError::NoPlace`]; what another process has put there since [`check`](Self::check).
    pub fn create(&mut self) -> Result<(), FolderError> {
        let no_place = |path: &Path, why| FolderError::NoPlace(path.to_owned(), why);
        if self.by_default && self.identity.is_none() {
            let parent = self.path.parent().unwrap_or(Path::new("")).to_owned();
            std::fs::create_dir_all(&parent).map_err(|why| no_place(&parent, why))?;
            // Two runs that begin together must not share a folder.
            while let Err(why) = std::fs::create_dir(&self.path) {
                if why.kind() != io::ErrorKind::AlreadyExists {
                    return Err(no_place(&self.path, why));
                }
                self.path = next(&self.path);
            }
        } else {
            std::fs::create_dir_all(&self.path).map_err(|why| no_place(&self.path, why))?;
        }
        let _turn = self.turn()?;
        match Manifest::of(&self.path)? {
            Some(held) if self.identity.is_some() && held.identity == self.identity => {
                return Ok(());
            }
            Some(held) if self.overwrite && held.command == self.command => self.remove(&held)?,
            Some(held) => return Err(FolderError::Holds(self.path.clone(), held.command)),
            None if self.file(manifest::NAME).symlink_metadata().is_ok() => {
                return Err(FolderError::Occupied(self.file(manifest::NAME)));
            }
            None => {}
        }
        self.keep(&Manifest::new(self.command, self.identity.as_ref()))
    }

    /// Writes a whole file in the folder, at once: a reader sees the old one or the new one.
    ///
    /// # Errors
    /// [`FolderError::Occupied`], [`FolderError::Disk`].
    pub fn write(&self, name: &str, content: &str) -> Result<(), FolderError> {
        self.list(name)?;
        self.replace(name, content.as_bytes())
    }

    /// Opens a new file in the folder, to be written bit by bit.
    ///
    /// # Errors
    /// [`FolderError::Occupied`], [`FolderError::Disk`].
    pub fn create_file(&self, name: &str) -> Result<File, FolderError> {
        self.list(name)?;
        let path = self.file(name);
        // One of an earlier result under the same identity, a link included: the link goes, not its
        // end.
        match std::fs::remove_file(&path) {
            Err(why) if why.kind() != io::ErrorKind::NotFound => {
                return Err(FolderError::Disk(path, why));
            }
            _ => {}
        }
        OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)
            .map_err(|why| FolderError::Disk(path.clone(), why))
    }

    /// Waits until the disk holds the files that the manifest lists, as they are now, and their
    /// names.
    ///
    /// # Errors
    /// [`FolderError::Disk`].
    pub fn settle(&self) -> Result<(), FolderError> {
        let held = Manifest::of(&self.path)?;
        let names = held.iter().flat_map(|held| &held.files).map(String::as_str);
        for name in names.chain([manifest::NAME]) {
            let path = self.file(name);
            match File::open(&path).and_then(|file| file.sync_all()) {
                // Listed before it is made.
                Err(why) if why.kind() == io::ErrorKind::NotFound => {}
                settled => settled.map_err(|why| FolderError::Disk(path, why))?,
            }
        }
        self.settle_names().map_err(|why| FolderError::Disk(self.path.clone(), why))
    }

    /// Waits until the disk holds the names in the folder, and the folder's own where it can.
    ///
    /// # Errors
    /// What the disk says.
    pub fn settle_names(&self) -> io::Result<()> {
        let parent = self.path.parent().filter(|parent| *parent != Path::new(""));
        let _ = File::open(parent.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
        match File::open(&self.path)?.sync_all() {
            // A file system that has no such request for folders.
            Err(why) if why.kind() == io::ErrorKind::InvalidInput => Ok(()),
            settled => settled,
        }
    }

    /// Makes room for a file that is appended to, such as the lines of a shard: it is listed as the
    /// program's own, and is there or can be made.
    ///
    /// # Errors
    /// [`FolderError::Occupied`] where one is there that the manifest does not list, or a link is.
    pub fn listed(&self, name: &str) -> Result<PathBuf, FolderError> {
        self.list(name)?;
        let path = self.file(name);
        match path.symlink_metadata() {
            Ok(about) if !about.is_file() => Err(FolderError::Occupied(path)),
            _ => Ok(path),
        }
    }

    /// Puts a name into the manifest before the file is there, so that no file is without an owner.
    fn list(&self, name: &str) -> Result<(), FolderError> {
        let path = self.file(name);
        if let Some(folder) = Path::new(name).parent().filter(|folder| *folder != Path::new("")) {
            let folder = self.path.join(folder);
            match folder.symlink_metadata() {
                Ok(about) if about.is_dir() => {}
                Ok(_) => return Err(FolderError::Occupied(folder)),
                Err(_) => std::fs::create_dir(&folder)
                    .map_err(|why| FolderError::Disk(folder.clone(), why))?,
            }
        }
        let _turn = self.turn()?;
        let Some(mut held) = Manifest::of(&self.path)? else {
            return Err(FolderError::Disk(path, io::Error::other("the folder's manifest is gone")));
        };
        if held.files.contains(name) {
            return Ok(());
        }
        if path.symlink_metadata().is_ok() {
            return Err(FolderError::Occupied(path));
        }
        held.files.insert(name.to_owned());
        self.keep(&held)
    }

    /// Removes what a manifest lists; a folder in it goes when it is empty.
    fn remove(&self, held: &Manifest) -> Result<(), FolderError> {
        self.check_removable(held)?;
        for name in &held.files {
            let path = self.file(name);
            let folder = path.parent().unwrap_or(&self.path);
            match std::fs::remove_file(&path) {
                Err(why) if why.kind() != io::ErrorKind::NotFound => {
                    return Err(FolderError::Disk(path, why));
                }
                _ => {}
            }
            if folder != self.path {
                // Not empty where the user has put something there too.
                let _ = std::fs::remove_dir(folder);
            }
        }
        Ok(())
    }

    /// Checks every listed file before the first one goes: a refusal leaves the result whole.
    fn check_removable(&self, held: &Manifest) -> Result<(), FolderError> {
        for name in &held.files {
            let path = self.file(name);
            if path.symlink_metadata().is_ok_and(|about| about.is_dir()) {
                return Err(FolderError::Occupied(path));
            }
            let folder = path.parent().unwrap_or(&self.path);
            let through_a_link =
                folder != self.path && folder.symlink_metadata().is_ok_and(|about| !about.is_dir());
            if through_a_link {
                return Err(FolderError::Occupied(folder.to_owned()));
            }
        }
        Ok(())
    }

    fn keep(&self, manifest: &Manifest) -> Result<(), FolderError> {
        let text = serde_json::to_string_pretty(manifest)
            .map_err(|why| FolderError::Disk(self.file(manifest::NAME), why.into()))?;
        self.replace(manifest::NAME, format!("{text}\n").as_bytes())
    }

    /// Writes a new file and renames it: what a link points to is never written.
    fn replace(&self, name: &str, content: &[u8]) -> Result<(), FolderError> {
        let path = self.file(name);
        let new = self.path.join(format!("{name}.{}.new", std::process::id()));
        let write = || -> io::Result<()> {
            let mut file = OpenOptions::new().write(true).create_new(true).open(&new)?;
            file.write_all(content)?;
            std::fs::rename(&new, &path)
        };
        write().map_err(|why| {
            let _ = std::fs::remove_file(&new);
            FolderError::Disk(path.clone(), why)
        })
    }

    /// Waits until no other process changes the manifest; lasts as long as the value.
    fn turn(&self) -> Result<File, FolderError> {
        let disk = |why| FolderError::Disk(self.path.clone(), why);
        let folder = File::open(&self.path).map_err(disk)?;
        folder.lock().map_err(disk)?;
        Ok(folder)
    }
}

/// True for anything but an empty folder or nothing at all.
fn holds_anything(path: &Path) -> bool {
    match std::fs::read_dir(path) {
        // A file that another shard is about to rename has this ending.
        Ok(entries) => {
            let names = entries.flatten().map(|entry| entry.file_name());
            names.into_iter().any(|name| !name.to_string_lossy().ends_with(".new"))
        }
        Err(_) => path.symlink_metadata().is_ok(),
    }
}

fn free_name(name: &str, n: u32) -> PathBuf {
    Path::new("runs").join(format!("{name}-{n}"))
}

fn free(name: &str, from: u32) -> PathBuf {
    let free = (from..).map(|n| free_name(name, n));
    free.into_iter().find(|path| path.symlink_metadata().is_err()).unwrap_or_default()
}

/// The folder after `<name>-<n>`.
fn next(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match name.rsplit_once('-').and_then(|(name, n)| Some((name, n.parse::<u32>().ok()?))) {
        Some((name, n)) => free(name, n + 1),
        None => free(&name, 2),
    }
}

#[cfg(test)]
mod tests;
