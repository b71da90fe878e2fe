//! Allocations of the online estimate in a control loop, measured with a counting allocator.

use sinew_estimate::online::{OnlineEstimator, StepOutcome};
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionOptions;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count() {
    // A thread that ends has no counter anymore.
    let _ended = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
}

// SAFETY: every call is forwarded unchanged to the system allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: guaranteed by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        count();
        // SAFETY: guaranteed by the caller.
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: guaranteed by the caller.
        unsafe { System.realloc(place, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// Samples of 1 min; the worker processes blocks in between, or is delayed until blocks are dropped.
#[test]
fn step_does_not_allocate_or_free() {
    const STEP_S: f64 = 2e-3;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like");
    let robot = robot_dir::load(&folder, None).unwrap().robot;
    for works in [true, false] {
        let options = SessionOptions::default();
        let mut online = OnlineEstimator::new(robot.clone(), None, &options, "run").unwrap();
        let (mut blocks, mut counted) = (0, 0);
        for k in 0..30_000 {
            let t = STEP_S * f64::from(k);
            let q: [f64; 4] = std::array::from_fn(|i| 0.4 * (0.7 * t + i as f64).sin());
            let theta = q.map(|q| q + 0.01);
            let before = ALLOCATIONS.get();
            // Occasionally a sample is missing.
            let missing = k % 5_000 == 4_999;
            let first = if missing { f64::NAN } else { q[0] };
            let q = [first, q[1], q[2], q[3]];
            let outcome = online.step(STEP_S, &q, &theta, &[], 21.0);
            let answer = online.answer();
            assert_eq!(answer.joints.len(), 4);
            counted += ALLOCATIONS.get() - before;
            if outcome.unwrap() == StepOutcome::Block {
                blocks += 1;
                if works {
                    online.work();
                }
            }
        }
        assert_eq!(counted, 0, "worker: {works}");
        assert!(blocks > 200, "{blocks}");
        assert_eq!(online.blocks_dropped() > 0, !works);
    }
}
