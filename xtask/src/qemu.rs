//! QEMU in software emulation with Debian's real-time kernel.
//!
//! Works wherever QEMU does, with two processors and system calls below a microsecond, but
//! floating point is four to ten times slower than native. `/dev/kvm` is never used: inside a
//! virtual machine it can accept a guest and then hang at its boot.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::debian::{self, Sources};
use crate::machine::{CAN_MODULES, Machine};
use crate::modules;
use crate::stream::quiet;

/// To mount this machine's file system inside.
const SHARE_MODULES: [&str; 3] = ["virtio-pci", "9pnet-virtio", "9p"];

/// Fetches kernel (about 70 MB) and emulator unless they are there, and packs a first file system.
///
/// # Errors
///
/// One line: it could not be fetched, or the emulator could not be installed.
pub(crate) fn prepare(folder: &Path, script: &Path, busybox: &Path) -> Result<Machine, String> {
    if std::env::consts::ARCH != "x86_64" {
        return Err("Debian's real-time kernel is fetched for x86-64 alone".into());
    }
    let qemu = debian::ensure("qemu-system-x86_64", &["qemu-system-x86"])?;
    debian::ensure("cpio", &["cpio"])?;
    let kernel = folder.join("kernel");
    let complete = folder.join("complete");
    if !complete.is_file() {
        let _ = fs::remove_dir_all(&kernel);
        debian::unpack(&Sources::default(), &[&newest_kernel()?], &kernel)?;
        fs::write(&complete, "").map_err(|error| error.to_string())?;
    }
    let initrd = folder.join("initrd");
    pack(&kernel, &initrd, script, busybox)?;
    let mut start = Command::new(qemu);
    start
        .args(["-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m", "2048"])
        .args(["-nodefaults", "-display", "none", "-serial", "stdio", "-no-reboot"])
        .args(["-virtfs", "local,path=/,mount_tag=host,security_model=none,multidevs=remap"])
        .args(["-append", "console=ttyS0 quiet loglevel=3 panic=-1", "-kernel"])
        .arg(image(&kernel)?)
        .arg("-initrd")
        .arg(&initrd)
        .stdin(Stdio::piped());
    Ok(Machine {
        name: "QEMU",
        start,
        modules: Vec::new(),
        slow_down: 20,
        limit: Duration::from_secs(1500),
    })
}

/// The package that Debian's newest real-time kernel is in.
fn newest_kernel() -> Result<String, String> {
    let depends = quiet(Command::new("apt-cache").args(["depends", "linux-image-rt-amd64"]))?;
    let named = |line: &str| line.trim().strip_prefix("Depends: ").map(str::to_owned);
    let mut names = depends.lines().filter_map(named);
    names
        .find(|name| name.starts_with("linux-image-"))
        .ok_or_else(|| "no package linux-image-rt-amd64".into())
}

fn image(kernel: &Path) -> Result<PathBuf, String> {
    let boot = fs::read_dir(kernel.join("boot")).map_err(|error| error.to_string())?;
    let mut files = boot.flatten().map(|entry| entry.path());
    let is_image = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("vmlinuz"))
    };
    files.find(is_image).ok_or_else(|| format!("no vmlinuz in {}", kernel.display()))
}

/// A first file system of one program and some modules, whose only work is to change to this
/// machine's file system and go on there with the script.
fn pack(kernel: &Path, initrd: &Path, script: &Path, busybox: &Path) -> Result<(), String> {
    let wanted: Vec<&str> = SHARE_MODULES.into_iter().chain(CAN_MODULES).collect();
    let order = modules::insertion_order(&kernel.join("lib/modules"), &wanted)?;
    let content = initrd.with_extension("content");
    let mut init = vec!["#!/busybox sh".to_owned()];
    let packed = (|| {
        let _ = fs::remove_dir_all(&content);
        fs::create_dir_all(content.join("host"))?;
        fs::copy(busybox, content.join("busybox"))?;
        for module in &order {
            let name = module.file_name().unwrap_or_default().to_string_lossy();
            fs::copy(module, content.join(&*name))?;
            init.push(format!("/busybox insmod /{name}"));
        }
        let share = "trans=virtio,version=9p2000.L,msize=524288";
        init.push(format!("/busybox mount -t 9p -o {share} host /host"));
        init.push(format!("exec /busybox chroot /host {}\n", script.display()));
        fs::write(content.join("init"), init.join("\n"))
    })();
    packed.map_err(|error: std::io::Error| format!("{}: {error}", content.display()))?;
    let archive = "cd \"$1\" && chmod 755 init && find . | cpio --quiet -o -H newc >\"$2\"";
    quiet(Command::new("sh").args(["-c", archive, "sh"]).arg(&content).arg(initrd)).map(drop)
}
