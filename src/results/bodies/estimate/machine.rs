//! How much memory the machine has left.

/// Bytes of a gibibyte.
pub const GIB: f64 = 1024.0 * 1024.0 * 1024.0;

/// Bytes that this process can still get; `None` where the system does not say.
pub(crate) fn available() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| meminfo(&text));
    // a container may have less than the machine; "max" is no number
    let group = |folder: &str, [limit, used, cached]: [&str; 3]| -> Option<f64> {
        let file = |name: &str| read(&format!("{folder}/{name}"));
        let number = |name: &str| file(name)?.trim().parse::<f64>().ok();
        // what is used has the files in it that were read and can go
        let cached = file("memory.stat").and_then(|text| statistic(&text, cached)).unwrap_or(0.0);
        Some((number(limit)? - number(used)? + cached).max(0.0))
    };
    let groups = [
        group("/sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file"]),
        group(
            "/sys/fs/cgroup/memory",
            ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"],
        ),
    ];
    groups.into_iter().flatten().chain(machine).reduce(f64::min)
}

/// The value of a line of `memory.stat`.
fn statistic(text: &str, name: &str) -> Option<f64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
    value.trim().parse().ok()
}

/// Bytes on the line `MemAvailable` of `/proc/meminfo`.
fn meminfo(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? * 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_of_the_system_are_read() {
        assert_eq!(meminfo("MemTotal: 9 kB\nMemAvailable:   2048 kB\n"), Some(2_097_152.0));
        assert_eq!(meminfo("MemTotal: 9 kB\n"), None);
        let lines = "file 12\ninactive_file_x 9\ninactive_file 4096\n";
        assert_eq!((statistic(lines, "inactive_file"), statistic(lines, "active")), (Some(4096.0), None));
    }
}
