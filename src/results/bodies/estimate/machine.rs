//! How much memory the machine has left, and how fast it is.

use std::sync::OnceLock;
use std::time::Instant;

use nalgebra::Vector3;
use railspring_calibrate::contact::{FreeDirection, HalfSpace, NearField, Problem, flat_grid, gaps, solve};
use railspring_calibrate::solid::Material;

/// Seconds that the contact of [`slowness`] takes on the machine on which the constants of times were measured.
const ITS_SECONDS: f64 = 0.0022;
/// How often it is solved: the fastest counts, as other programs slow the others down. The first makes its tables, and a processor at rest takes some
/// hundredths of a second to its full speed: of three the fastest may take twice as long.
const TRIES: usize = 20;

/// How many times as long as on the machine on which the constants of times were measured this one takes: by the contact of a ball of 0.3 m under 60 kN with
/// friction, 24 by 24 points.
pub(crate) fn slowness() -> f64 {
    static FOUND: OnceLock<f64> = OnceLock::new();
    *FOUND.get_or_init(|| (0..TRIES).map(|_| of_contact()).fold(f64::INFINITY, f64::min) / ITS_SECONDS)
}

/// Seconds of the contact.
fn of_contact() -> f64 {
    const POINTS: usize = 24;
    const SPACING: f64 = 0.5e-3;
    let begun = Instant::now();
    let points = flat_grid((POINTS, POINTS), SPACING, |s, x| 0.5 * (s * s + x * x) / 0.3);
    let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 3);
    let mut free = gaps(&points);
    free.resize(2 * points.len(), 20e-6);
    free.resize(3 * points.len(), 0.0);
    let hub = [FreeDirection { along: Vector3::z_axis(), force: -60e3 }];
    let problem = Problem { points: &points, compliance: &compliance, free: &free, friction: 0.3, hub: &hub };
    // whether it has a solution does not matter to the time
    let _ = solve(&problem, &vec![0.0; free.len()]);
    begun.elapsed().as_secs_f64()
}

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
    let membership = read("/proc/self/cgroup").unwrap_or_default();
    let groups = group_folders(&membership).into_iter().filter_map(|folder| {
        let second = ["memory.max", "memory.current", "inactive_file"];
        let first = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"];
        group(&folder, second).into_iter().chain(group(&folder, first)).reduce(f64::min)
    });
    let own = read("/proc/self/limits").zip(read("/proc/self/status"));
    let own = own.and_then(|(limits, status)| within_limits(&limits, &status));
    groups.chain(machine).chain(own).reduce(f64::min)
}

/// The folders of the control groups of this process, each with those around it, which limit it too.
fn group_folders(membership: &str) -> Vec<String> {
    let mut folders = Vec::new();
    for line in membership.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let root = match controllers {
            "" => "/sys/fs/cgroup",
            _ if controllers.split(',').any(|name| name == "memory") => "/sys/fs/cgroup/memory",
            _ => continue,
        };
        let mut path = path.trim_end_matches('/');
        loop {
            folders.push(format!("{root}{path}"));
            match path.rfind('/') {
                Some(end) => path = &path[..end],
                None => break,
            }
        }
    }
    // inside a container the path of the membership may be that outside
    for root in ["/sys/fs/cgroup", "/sys/fs/cgroup/memory"] {
        if !folders.iter().any(|folder| folder == root) {
            folders.push(root.into());
        }
    }
    folders
}

/// Bytes that the limits of a process leave it, as `ulimit -v` and `-d` set them, of its `limits` and its `status` in `/proc`; `None` without such a limit.
fn within_limits(limits: &str, status: &str) -> Option<f64> {
    /// Addresses that threads and their heaps set aside beside what they use, bytes.
    const SET_ASIDE: f64 = 192.0 * 1024.0 * 1024.0;
    let left = |limit: &str, used: &str| -> Option<f64> {
        let line = limits.lines().find_map(|line| line.strip_prefix(limit))?;
        // "unlimited" is no number
        let most: f64 = line.split_whitespace().next()?.parse().ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix(used))?;
        let taken: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
        Some((most - 1024.0 * taken - SET_ASIDE).max(0.0))
    };
    let found = [left("Max address space", "VmSize:"), left("Max data size", "VmData:")];
    found.into_iter().flatten().reduce(f64::min)
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

    /// Goal: the contact that the machine is timed by is solved, in some thousandths of a second at least, and the answer stays the same.
    #[test]
    fn the_machine_has_a_speed() {
        assert!(of_contact() > 1e-3);
        assert!(slowness() > 0.0 && slowness() == slowness());
    }

    #[test]
    fn the_texts_of_the_system_are_read() {
        assert_eq!(meminfo("MemTotal: 9 kB\nMemAvailable:   2048 kB\n"), Some(2_097_152.0));
        assert_eq!(meminfo("MemTotal: 9 kB\n"), None);
        let limits = "Limit   Soft Limit   Hard Limit   Units\nMax data size   unlimited   unlimited   bytes\n\
                      Max address space   1073741824   unlimited   bytes\n";
        let status = "VmSize:\t  102400 kB\nVmData:\t 2048 kB\n";
        // 1024 - 100 - 192 MiB
        assert_eq!(within_limits(limits, status), Some(732.0 * 1024.0 * 1024.0));
        assert_eq!(within_limits(&limits.replace("1073741824", "unlimited"), status), None);
        assert_eq!(within_limits(&limits.replace("1073741824", "1024"), status), Some(0.0));
        let folders = group_folders("0::/user.slice/job\n5:cpu:/x\n3:cpuacct,memory:/y\n");
        let expected = ["/user.slice/job", "/user.slice", "", "/memory/y", "/memory"];
        assert_eq!(folders, expected.map(|folder| format!("/sys/fs/cgroup{folder}")));
        assert_eq!(group_folders("0::/\n"), ["/sys/fs/cgroup", "/sys/fs/cgroup/memory"]);
        let lines = "file 12\ninactive_file_x 9\ninactive_file 4096\n";
        assert_eq!((statistic(lines, "inactive_file"), statistic(lines, "active")), (Some(4096.0), None));
    }
}
