//! How fast a film goes: which frames it shows and how many a second, and how exactly it tells their times.

/// Most frames a second of a film.
const MAX_FPS: f64 = 30.0;
/// Where most intervals differ by more than this factor, as in phases of other steps, a film in real time would leave out
/// most of what is fast: it shows one frame after the other.
const EVEN: f64 = 1.5;
/// What is over in less than this [s] is shown slowly, without leaving out frames.
const SHORT: f64 = 2.0;
/// Decimals of the times of frames.
const DECIMALS: std::ops::RangeInclusive<usize> = 2..=6;

/// Every how many frames one is shown, and how many a second: real time with at most so many frames where the times of
/// frames [s] are even and the film is not short, else all frames, as far as they are not more.
pub(super) fn pace(times: &[f64], max_frames: usize) -> (usize, f64) {
    let count = times.len();
    if count < 2 {
        return (1, 1.0);
    }
    let for_count = count.div_ceil(max_frames);
    let mean = (times[count - 1] - times[0]) / (count - 1) as f64;
    if !(mean.is_finite() && mean > 0.0) {
        return (1, MAX_FPS);
    }
    let intervals = sorted_intervals(times);
    let tenth = intervals.len() / 10;
    if intervals[intervals.len() - 1 - tenth] > EVEN * intervals[tenth] {
        return (for_count, MAX_FPS);
    }
    let for_pace = match times[count - 1] - times[0] < SHORT {
        true => 1,
        false => (1.0 / (mean * MAX_FPS) - 1e-9).ceil() as usize,
    };
    let stride = for_pace.max(for_count).clamp(1, count);
    (stride, (1.0 / (mean * stride as f64)).clamp(1.0, MAX_FPS))
}

/// As many decimals as tell most frames apart.
pub(super) fn decimals(times: &[f64]) -> usize {
    let intervals = sorted_intervals(times);
    let Some(short) = intervals.get(intervals.len() / 10) else {
        return *DECIMALS.start();
    };
    // A millionth of a digit more, so that 0.001 needs three decimals whatever its rounding.
    let wanted = (-short.log10() - 1e-6).ceil();
    (wanted.max(0.0) as usize).clamp(*DECIMALS.start(), *DECIMALS.end())
}

fn sorted_intervals(times: &[f64]) -> Vec<f64> {
    let mut intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals.sort_by(f64::total_cmp);
    intervals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(count: usize, interval: f64) -> Vec<f64> {
        (0..count).map(|k| k as f64 * interval).collect()
    }

    #[test]
    fn even_frames_are_shown_in_real_time() {
        assert_eq!(pace(&even(51, 0.04), usize::MAX), (1, 25.0));
        assert_eq!(pace(&even(401, 0.01), usize::MAX), (4, 25.0));
        assert_eq!(pace(&even(301, 0.04), 150).0, 3);
        // The last frame may come early.
        let mut times = even(51, 0.04);
        times.push(2.01);
        let (stride, fps) = pace(&times, usize::MAX);
        assert!(stride == 1 && (fps - 25.0).abs() < 0.5, "{fps}");
        assert_eq!(pace(&[0.0], 10), (1, 1.0));
        assert_eq!(pace(&[1.0, 1.0], 10), (1, MAX_FPS));
    }

    #[test]
    fn frames_of_fast_phases_are_shown_one_by_one() {
        let mut times = even(37, 0.04);
        times.extend((1..=58).map(|k| 1.44 + 8e-4 * f64::from(k)));
        assert_eq!(pace(&times, usize::MAX), (1, MAX_FPS));
        assert_eq!(pace(&times, 50), (2, MAX_FPS));
    }

    #[test]
    fn what_is_over_soon_is_shown_slowly_and_never_faster_than_it_is() {
        assert_eq!(pace(&even(101, 5e-3), usize::MAX), (1, MAX_FPS));
        assert_eq!(pace(&even(11, 0.1), usize::MAX).0, 1);
        assert!((pace(&even(11, 0.1), usize::MAX).1 - 10.0).abs() < 1e-9);
    }

    #[test]
    fn times_are_told_as_exactly_as_they_differ() {
        assert_eq!(decimals(&even(9, 0.04)), 2);
        assert_eq!(decimals(&even(9, 1e-3)), 3);
        assert_eq!(decimals(&even(9, 8e-4)), 4);
        assert_eq!(decimals(&even(9, 1e-9)), 6);
        assert_eq!(decimals(&even(9, 20.0)), 2);
        assert_eq!(decimals(&[0.0]), 2);
    }
}
