//! How much memory the process took, and how much it may take.

/// The most memory the process ever held [bytes], where the system tells it.
pub(crate) fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    parse_peak(&status)
}

fn parse_peak(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// The memory that can be had [bytes]: what the system calls available, or less if the process is confined to less;
/// `None` where the system does not say.
pub(crate) fn available_bytes() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| parse_available(&text));
    // Control groups, version 2 and 1; in a container the root of the tree is that of the container.
    let group = read("/proc/self/cgroup").unwrap_or_default();
    let confined = limit_files(&group)
        .into_iter()
        .filter_map(|path| read(&path)?.trim().parse().ok());
    machine.into_iter().chain(confined).min()
}

fn parse_available(meminfo: &str) -> Option<u64> {
    let line = meminfo
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// Where the limits of the process's own control group and of those around it may stand.
fn limit_files(group: &str) -> Vec<String> {
    let mut files = vec!["/sys/fs/cgroup/memory/memory.limit_in_bytes".to_owned()];
    let own = group.lines().find_map(|line| line.strip_prefix("0::"));
    let mut folder = own.unwrap_or("").trim_end_matches('/');
    loop {
        files.push(format!("/sys/fs/cgroup{folder}/memory.max"));
        match folder.rfind('/') {
            Some(end) => folder = &folder[..end],
            None => return files,
        }
    }
}

/// A number with a unit, such as `64GB`, `1.5 GiB` or `500MB`.
pub(crate) fn parse_size(text: &str) -> Result<u64, String> {
    let units = [
        ("GiB", 1u64 << 30),
        ("MiB", 1 << 20),
        ("GB", 1_000_000_000),
        ("MB", 1_000_000),
    ];
    let found = units
        .into_iter()
        .find_map(|(unit, bytes)| Some((text.trim().strip_suffix(unit)?.trim(), bytes)));
    let bytes = found.and_then(|(number, unit)| Some(number.parse::<f64>().ok()? * unit as f64));
    bytes
        .filter(|bytes| *bytes > 0.0)
        .map(|bytes| bytes as u64)
        .ok_or_else(|| "write it as 64GB or 500MB".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_from_the_status_file() {
        assert_eq!(
            parse_peak("Name:\tkoiter\nVmHWM:\t  123456 kB\nVmRSS: 1 kB\n"),
            Some(123_456 * 1024)
        );
        assert_eq!(parse_peak("Name:\tkoiter\n"), None);
    }

    #[test]
    fn what_is_available_is_read_from_the_system() {
        let text = "MemTotal: 9 kB\nMemAvailable:   2048 kB\n";
        assert_eq!(parse_available(text), Some(2 << 20));
        assert_eq!(
            limit_files("0::/user.slice/one.scope\n")[1..],
            [
                "/sys/fs/cgroup/user.slice/one.scope/memory.max",
                "/sys/fs/cgroup/user.slice/memory.max",
                "/sys/fs/cgroup/memory.max"
            ]
        );
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(parse_size("1.5 GiB"), Ok(3 << 29));
        assert_eq!(parse_size("500MB"), Ok(500_000_000));
        for text in ["", "64", "GB", "-1GB", "nanGB", "1TB"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }
}
