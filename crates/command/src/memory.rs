//! How much memory this process can still have: the one place that asks the machine.

use std::path::Path;

/// From here on a picture is large enough to say what it needs, bytes.
const LARGE: u64 = 1_000_000_000;

/// `needs 3.5 GB of memory`, where that is much.
pub(crate) fn worth_saying(bytes: u64) -> Option<String> {
    (bytes >= LARGE).then(|| format!("needs {} of memory", spectra_render::bytes(bytes)))
}

/// Bytes that can still be had: of the machine, of the control group that the process runs in, and of its own limit of
/// addresses, the least; `None` where none of them is known.
pub(crate) fn available() -> Option<u64> {
    [of_machine(), of_control_group(), of_addresses()].into_iter().flatten().min()
}

/// What Linux says is available without swapping (proc(5)).
fn of_machine() -> Option<u64> {
    kilobytes(Path::new("/proc/meminfo"), "MemAvailable:")
}

/// What the control groups leave, version 2: the group of the process and all above it (cgroups(7)).
fn of_control_group() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let root = Path::new("/sys/fs/cgroup");
    let number = |path: &Path| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let left = |group: &Path| {
        let most = number(&group.join("memory.max"))?;
        Some(most.saturating_sub(number(&group.join("memory.current"))?))
    };
    root.join(own).ancestors().take_while(|group| group.starts_with(root)).filter_map(left).min()
}

/// What `ulimit -v` leaves.
fn of_addresses() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(kilobytes(Path::new("/proc/self/status"), "VmSize:")?))
}

/// A number of kB behind a name, in bytes.
fn kilobytes(path: &Path, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}
