//! How much memory is still available to this process. No other module asks the machine for it.

use std::path::Path;

/// Memory from which a picture's need is worth a message, bytes.
const LARGE: u64 = 1_000_000_000;

/// Returns a message such as `needs 3.5 GB of memory`, or `None` below 1 GB.
pub(crate) fn worth_saying(bytes: u64) -> Option<String> {
    (bytes >= LARGE).then(|| format!("needs {} of memory", spectra_render::bytes(bytes)))
}

/// Returns the available memory in bytes: the smallest of what the machine, the control group of the process and its address
/// space limit leave. `None` if none of them is known.
pub(crate) fn available() -> Option<u64> {
    [of_machine(), of_control_group(), of_addresses()].into_iter().flatten().min()
}

/// Returns the memory that Linux reports as available without swapping (proc(5)), bytes.
fn of_machine() -> Option<u64> {
    kilobytes(Path::new("/proc/meminfo"), "MemAvailable:")
}

/// Returns the memory that control groups (version 2) leave: the smallest of the process's group and all above it, bytes
/// (cgroups(7)).
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

/// Returns the address space that `ulimit -v` leaves, bytes.
fn of_addresses() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(kilobytes(Path::new("/proc/self/status"), "VmSize:")?))
}

/// Reads the number of kB after a name in a file of `/proc`; returns bytes.
fn kilobytes(path: &Path, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}
