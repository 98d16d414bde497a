//! An allocator that counts, so that an input that takes too much memory is told from one that does not.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// The system's allocator with a count of what is held.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
static EXCEEDED: AtomicBool = AtomicBool::new(false);

/// Bytes held now.
pub(crate) fn held() -> usize {
    HELD.load(Relaxed)
}

/// Starts to look for a new peak; from now on no more than `limit` bytes are given out.
pub(crate) fn watch(limit: usize) {
    PEAK.store(held(), Relaxed);
    LIMIT.store(limit, Relaxed);
}

/// Lifts the limit; the most bytes held since [`watch`].
pub(crate) fn peak() -> usize {
    LIMIT.store(usize::MAX, Relaxed);
    PEAK.load(Relaxed)
}

/// Whether an allocation beyond the limit waits in vain.
pub(crate) fn is_exceeded() -> bool {
    EXCEEDED.load(Relaxed)
}

fn take(size: usize) {
    let held = HELD.fetch_add(size, Relaxed).saturating_add(size);
    if held > LIMIT.load(Relaxed) {
        // The watchdog ends the process and names the input; nothing after this point would be worth doing.
        EXCEEDED.store(true, Relaxed);
        loop {
            thread::sleep(Duration::from_secs(1));
        }
    }
    PEAK.fetch_max(held, Relaxed);
}

// SAFETY: every call goes to the system's allocator unchanged; the counters beside it are atomic and allocate nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        take(new_size);
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}
