//! Allocation test: frames do not allocate after construction, over three sessions with segments, ends and successors.
//!
//! Separate binary: the allocator counts per thread, and nothing else may run in this one.

// A global allocator is an unsafe trait; this one only counts and forwards to the system allocator.
#![allow(unsafe_code)]

mod support;

use sinew_watch_core::Times;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use support::{Harness, seconds, tensioned};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_one() {
    // Terminating threads have no counter; it is not needed.
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the contract of the caller applies unchanged.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // Freeing takes the same lock as allocating, so a frame must not free either.
        count_one();
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_one();
        // SAFETY: as above.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocator calls made by `f`.
fn allocations(f: impl FnOnce()) -> u64 {
    let before = COUNT.get();
    f();
    COUNT.get() - before
}

#[test]
fn allocation_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1.0; 100]))) >= 2);
}

#[test]
fn frame_steady_motion_does_not_allocate() {
    let mut config = tensioned();
    // Segments of 20 s, sessions of 45 s of motion: all ends fall within the counted frames.
    config.times = Times {
        stretch_s: 20.0,
        session_motion_s: 45.0,
        ..config.times
    };
    let mut harness = Harness::new(config);
    let (mut count, mut frames) = (0, 0);
    for tenth in seconds(60, 240).chunks(25) {
        let before = harness.now;
        count += allocations(|| {
            for (k, frame) in tenth.iter().enumerate() {
                let now = before.after_s(0.004 * k as f64);
                harness.monitor.frame(frame, now);
            }
        });
        frames += tenth.len();
        harness.now = before.after_s(0.1);
        // Outside the frame path: memory reservation, jobs, transactions.
        harness.tick();
    }
    let sessions = harness.store.records.len() / 4;
    assert!(sessions >= 2, "{sessions} sessions ended among them");
    assert_eq!(count, 0, "{frames} frames made {count} allocator calls");
}
