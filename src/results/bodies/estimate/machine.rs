//! How much memory the machine has left, and how fast it is.

use std::sync::OnceLock;
use std::time::Instant;

use nalgebra::Vector3;
use railspring_calibrate::contact::{FreeDirection, HalfSpace, NearField, Problem, flat_grid, gaps, solve};
use railspring_calibrate::solid::Material;

/// Seconds that the contact of [`slowness`] takes on the machine on which the constants of times were measured.
const ITS_SECONDS: f64 = 0.05;
/// How often it is solved: the fastest counts, as other programs slow the others down.
const TRIES: usize = 3;

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
        let lines = "file 12\ninactive_file_x 9\ninactive_file 4096\n";
        assert_eq!((statistic(lines, "inactive_file"), statistic(lines, "active")), (Some(4096.0), None));
    }
}
