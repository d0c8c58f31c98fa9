//! User Mode Linux: a kernel that is a program.
//!
//! No processor is emulated, so floating point runs at full speed and start to power-off takes
//! two seconds; a system call, the reading of the clock among them, costs some 40 µs. It has one
//! processor. The package comes from Debian unstable: the older one in Debian 12 fails on
//! processors with AMX.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::debian::{self, Sources};
use crate::machine::{CAN_MODULES, Machine};
use crate::modules;

/// The kernel and the libraries of its own release: it loads the second to end its threads.
const PACKAGES: [&str; 3] = ["user-mode-linux", "libc6", "libgcc-s1"];

/// In its own mount and process namespaces: the kernel's C library from the unpacked folder, this
/// machine's whole file system below `host`, where the kernel mounts its root from.
const START: &str = r#"set -e
root=$1 init=$2
shift 2
mount -t proc proc "$root/proc"
mount -t tmpfs -o exec tmpfs "$root/dev/shm"
mount --rbind / "$root/host"
exec chroot "$root" /usr/bin/linux.uml mem=2048M root=/dev/root rootfstype=hostfs rootflags=/host \
  rw init="$init" con=null con0=fd:0,fd:1 seccomp=auto quiet loglevel=3 "$@""#;

/// Where the kernel finds this machine's file system, and the number of its first disk's device.
pub(crate) const HOST: &str = "/host";
pub(crate) const DISK_MAJOR: u32 = 98;

/// Fetches the kernel into `folder` unless it is there (about 50 MB). Further arguments of
/// [`Machine::start`] go to the kernel.
///
/// # Errors
///
/// One line: it could not be fetched, or this machine's programs do not allow it.
pub(crate) fn prepare(folder: &Path, script: &Path) -> Result<Machine, String> {
    if std::env::consts::ARCH != "x86_64" {
        return Err("User Mode Linux runs on x86-64 alone".into());
    }
    for name in ["unshare", "chroot", "mount"] {
        debian::program(name).ok_or_else(|| format!("no {name}"))?;
    }
    let (root, complete) = (folder.join("root"), folder.join("complete"));
    if !complete.is_file() {
        let _ = fs::remove_dir_all(&root);
        let sources = Sources::unstable(&folder.join("apt"))?;
        debian::unpack(&sources, &PACKAGES, &root)?;
        let made = furnish(&root).and_then(|()| fs::write(&complete, ""));
        made.map_err(|error| format!("{}: {error}", root.display()))?;
        let _ = fs::remove_dir_all(folder.join("apt"));
    }
    let modules = modules::insertion_order(&root.join("usr/lib/uml/modules"), &CAN_MODULES)?;
    let mut start = Command::new("unshare");
    start.args(["--mount", "--propagation", "private", "--pid", "--fork", "--kill-child"]);
    if !debian::is_root() {
        start.args(["--user", "--map-root-user"]);
    }
    start.args(["--", "sh", "-c", START, "sh"]).arg(&root).arg(script);
    // Its console reads from a pipe; a variable for temporary files would move its memory there.
    start.stdin(Stdio::piped()).env_clear().env("HOME", "/tmp");
    start.env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin");
    Ok(Machine {
        name: "User Mode Linux",
        start,
        modules,
        slow_down: 5,
        limit: Duration::from_secs(1500),
    })
}

/// What the package leaves to the system it is installed on.
fn furnish(root: &Path) -> std::io::Result<()> {
    for folder in ["proc", "dev/shm", "host", "tmp"] {
        fs::create_dir_all(root.join(folder))?;
    }
    for library in ["lib", "lib64"] {
        if !root.join(library).exists() {
            symlink(Path::new("usr").join(library), root.join(library))?;
        }
    }
    Ok(())
}
