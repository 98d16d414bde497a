//! How much memory the process took.

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

/// `1.5 GB` and the like.
pub(crate) fn readable(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b if b >= 1e6 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.0} kB", b / 1e3),
    }
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
    fn sizes_are_readable() {
        assert_eq!(
            (readable(1_500_000_000), readable(20_400_000)),
            ("1.5 GB".into(), "20 MB".into())
        );
    }
}
