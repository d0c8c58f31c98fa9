//! Debian's packages: installed where we are root, or only fetched and unpacked into a folder.

use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::stream::quiet;

/// True where this process may install packages and set up network interfaces.
pub(crate) fn is_root() -> bool {
    fs::metadata("/proc/self").is_ok_and(|process| process.uid() == 0)
}

/// The first place on the search path that has this program.
pub(crate) fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let sbin = ["/usr/sbin", "/sbin"].map(PathBuf::from);
    std::env::split_paths(&path).chain(sbin).map(|folder| folder.join(name)).find(|p| p.is_file())
}

/// Installs packages on this machine.
///
/// # Errors
///
/// One line: not root, no `apt-get`, or what it said last.
pub(crate) fn install(packages: &[&str]) -> Result<(), String> {
    let names = packages.join(", ");
    if program("apt-get").is_none() {
        return Err(format!("{names}: no apt-get to install with"));
    }
    if !is_root() {
        return Err(format!("{names}: not installed, and only root may (apt-get install {names})"));
    }
    refresh();
    println!("installing {names}");
    quiet(
        apt_get(&[])
            .env("DEBIAN_FRONTEND", "noninteractive")
            .args(["install", "--yes", "--no-install-recommends"])
            .args(packages),
    )
    .map(drop)
}

/// Installs the packages unless the program is there; gives its place.
///
/// # Errors
///
/// As [`install`], or that the packages did not bring the program.
pub(crate) fn ensure(name: &str, packages: &[&str]) -> Result<PathBuf, String> {
    if let Some(path) = program(name) {
        return Ok(path);
    }
    install(packages)?;
    program(name).ok_or_else(|| format!("{}: installed, but has no {name}", packages.join(", ")))
}

/// The newest packages that these sources know: fetched, unpacked into `folder`, not installed.
///
/// # Errors
///
/// One line: a tool is missing, or what `apt-get` or `dpkg` said last.
pub(crate) fn unpack(sources: &Sources, packages: &[&str], folder: &Path) -> Result<(), String> {
    fetch(folder, |archives| {
        quiet(apt_get(&sources.options).current_dir(archives).arg("download").args(packages))
    })
}

/// As [`unpack`] from this machine's own sources, with every dependency that it has not installed.
pub(crate) fn unpack_with_dependencies(packages: &[&str], folder: &Path) -> Result<(), String> {
    fetch(folder, |archives| {
        let mut place = OsString::from("Dir::Cache::archives=");
        place.push(archives);
        quiet(
            apt_get(&[])
                .args(["install", "--yes", "--no-install-recommends", "--reinstall"])
                .args(["--download-only", "-o", "Debug::NoLocking=1", "-o"])
                .arg(place)
                .args(packages),
        )
    })
}

fn fetch(
    folder: &Path,
    download: impl FnOnce(&Path) -> Result<String, String>,
) -> Result<(), String> {
    if program("apt-get").is_none() || program("dpkg").is_none() {
        return Err("no apt-get and dpkg to fetch packages with".into());
    }
    if is_root() {
        refresh();
    }
    let archives = folder.join("archives");
    fs::create_dir_all(archives.join("partial")).map_err(|error| error.to_string())?;
    download(&archives)?;
    let mut size = 0;
    for entry in fs::read_dir(&archives).map_err(|error| error.to_string())?.flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "deb") {
            size += entry.metadata().map_or(0, |file| file.len());
            quiet(Command::new("dpkg").arg("-x").arg(entry.path()).arg(folder))?;
        }
    }
    println!("fetched {:.1} MB into {}", size as f64 / 1e6, folder.display());
    fs::remove_dir_all(&archives).map_err(|error| error.to_string())
}

/// Where packages come from.
#[derive(Default)]
pub(crate) struct Sources {
    options: Vec<OsString>,
}

impl Sources {
    /// Debian's unstable suite from the mirror this machine uses, with lists and state of its own
    /// in `folder`: what the machine itself installs is not touched by it.
    ///
    /// # Errors
    ///
    /// One line: no Debian keyring, or what `apt-get update` said last.
    pub(crate) fn unstable(folder: &Path) -> Result<Self, String> {
        let keys = "/usr/share/keyrings/debian-archive-keyring.gpg";
        if !Path::new(keys).is_file() {
            return Err(format!("no {keys} to trust Debian's packages by"));
        }
        let list = folder.join("sources.list");
        let text = format!("deb [signed-by={keys}] {} unstable main\n", mirror());
        let made = ["state/lists/partial", "cache/archives/partial"]
            .iter()
            .try_for_each(|part| fs::create_dir_all(folder.join(part)))
            .and_then(|()| fs::write(&list, text));
        made.map_err(|error| error.to_string())?;
        let mut options = Vec::new();
        for (key, value) in [
            ("Dir::Etc::SourceList", list.as_path()),
            ("Dir::Etc::SourceParts", Path::new("/dev/null")),
            ("Dir::State", &folder.join("state")),
            ("Dir::State::status", Path::new("/dev/null")),
            ("Dir::Cache", &folder.join("cache")),
            ("Acquire::Languages", Path::new("none")),
            ("Acquire::IndexTargets::deb::DEP-11::DefaultEnabled", Path::new("false")),
        ] {
            let mut option = OsString::from(key);
            option.push("=");
            option.push(value);
            options.extend(["-o".into(), option]);
        }
        quiet(apt_get(&options).arg("update"))?;
        Ok(Self { options })
    }
}

/// The mirror of Debian's main archive that this machine is set up for, or the public one.
fn mirror() -> String {
    let format = ["indextargets", "--format", "$(REPO_URI)", "Identifier: Packages"];
    let targets = quiet(apt_get(&[]).args(format)).unwrap_or_default();
    let main = |line: &&str| line.trim_end_matches('/').ends_with("/debian");
    targets.lines().find(main).unwrap_or("http://deb.debian.org/debian").to_owned()
}

/// Reads the package lists once in a run; old ones may name files that are gone.
fn refresh() {
    static DONE: OnceLock<()> = OnceLock::new();
    DONE.get_or_init(|| {
        if let Err(error) = quiet(apt_get(&[]).arg("update")) {
            println!("{error}; going on with the lists that are there");
        }
    });
}

/// Unpacking under our own folder needs no other user for the download, and no warning about it.
fn apt_get(options: &[OsString]) -> Command {
    let mut command = Command::new("apt-get");
    command.args(["-q", "-o", "APT::Sandbox::User=root"]).args(options);
    command
}
