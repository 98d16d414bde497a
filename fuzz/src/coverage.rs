//! Which branches an input reached, where the program was built with counters for it (`fuzz/run` does).

use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering::Relaxed};

static START: AtomicUsize = AtomicUsize::new(0);
static LENGTH: AtomicUsize = AtomicUsize::new(0);

/// Called by the instrumented code before `main`, once a module, each time with the counters of all modules.
///
/// # Safety
/// `start..stop` must be the counters, which live as long as the program.
#[expect(unreachable_pub, reason = "the instrumented code calls it by name")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn __sanitizer_cov_8bit_counters_init(start: *mut u8, stop: *mut u8) {
    START.store(start as usize, Relaxed);
    LENGTH.store(stop as usize - start as usize, Relaxed);
}

/// The counters; none without instrumentation.
fn counters() -> &'static [AtomicU8] {
    let (start, length) = (START.load(Relaxed), LENGTH.load(Relaxed));
    if length == 0 {
        return &[];
    }
    // SAFETY: the range was given by the instrumentation and lives as long as the program; atomic bytes have the layout
    // of bytes, and the instrumented code's plain increments on the same thread are not concurrent with ours.
    unsafe { std::slice::from_raw_parts(start as *const AtomicU8, length) }
}

/// What was reached so far.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    /// Bits of the buckets of counts seen, a byte a branch.
    seen: Vec<u8>,
    num_reached: usize,
}

impl Coverage {
    /// Forgets what was counted, before an input is tried.
    pub(crate) fn reset() {
        for counter in counters() {
            counter.store(0, Relaxed);
        }
    }

    /// Adds what was counted; whether there was anything new.
    pub(crate) fn add(&mut self) -> bool {
        let counters = counters();
        self.seen.resize(counters.len(), 0);
        let mut is_new = false;
        for (seen, counter) in self.seen.iter_mut().zip(counters) {
            let count = counter.load(Relaxed);
            if count == 0 {
                continue;
            }
            // 1, 2, 3, 4–7, 8–15, 16–31, 32–127, more.
            let bucket = match count {
                1..=3 => count - 1,
                4..=7 => 3,
                8..=15 => 4,
                16..=31 => 5,
                32..=127 => 6,
                _ => 7,
            };
            if *seen & (1 << bucket) == 0 {
                self.num_reached += usize::from(*seen == 0);
                *seen |= 1 << bucket;
                is_new = true;
            }
        }
        is_new
    }

    /// Number of branches reached by any input.
    pub(crate) fn num_reached(&self) -> usize {
        self.num_reached
    }
}
