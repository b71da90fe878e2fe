//! Frames allocate nothing after construction: counted over three sessions' worth of stretches, ends and successors.
//!
//! A binary of its own: the counting allocator counts by thread, and nothing else may run in this one.

// A global allocator is an unsafe trait; this one only counts and hands on to the system's.
#![allow(unsafe_code)]

mod support;

use sinew_watch_core::Times;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use support::{Watched, seconds, tensioned};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_one() {
    // Threads that are going away have no counter any more; nobody asks for theirs.
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the caller's promise, handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // Freeing takes the same lock as allocating: not in a frame either.
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

/// Allocator calls made by `f`.
fn allocations(f: impl FnOnce()) -> u64 {
    let before = COUNT.get();
    f();
    COUNT.get() - before
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1.0; 100]))) >= 2);
}

#[test]
fn frames_allocate_nothing() {
    let mut config = tensioned();
    // Stretches of 20 s, sessions of 45 s of motion: every end is among the frames that are counted.
    config.times = Times {
        stretch_s: 20.0,
        session_motion_s: 45.0,
        ..config.times
    };
    let mut watched = Watched::new(config);
    let (mut count, mut frames) = (0, 0);
    for tenth in seconds(60, 240).chunks(25) {
        let before = watched.now;
        count += allocations(|| {
            for (k, frame) in tenth.iter().enumerate() {
                let now = before.after_s(0.004 * k as f64);
                watched.monitor.frame(frame, now);
            }
        });
        frames += tenth.len();
        watched.now = before.after_s(0.1);
        // Off the path of frames: room, jobs, transactions.
        watched.tick();
    }
    let sessions = watched.store.records.len() / 4;
    assert!(sessions >= 2, "{sessions} sessions ended among them");
    assert_eq!(count, 0, "{frames} frames made {count} allocator calls");
}
