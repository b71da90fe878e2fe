//! Steps do not allocate: calls of the allocator are counted per thread.

use crate::support::{N, Opened, biorob_like, recorded, text};
use sinew_c::observer::{sinew_observer_free, sinew_observer_new, sinew_observer_step};
use sinew_c::offsets::{
    SinewOffset, SinewStepped, sinew_offsets_free, sinew_offsets_interrupt, sinew_offsets_new,
    sinew_offsets_read, sinew_offsets_step, sinew_offsets_work,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_one() {
    // A terminating thread has no counter; its count is not read.
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: guaranteed by the caller, forwarded.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
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

#[test]
fn steps_do_not_allocate() {
    let (frames, baseline) = recorded(&biorob_like());
    let baseline = text(&baseline.to_text());
    let robot = Opened::biorob_like();
    let (mut offsets, mut observer) = (null_mut(), null_mut());
    let before = COUNT.get();
    // SAFETY: valid handles, arrays of four numbers.
    unsafe {
        sinew_offsets_new(
            robot.0,
            baseline.as_ptr(),
            null(),
            &mut offsets,
            null_mut(),
            0,
        );
        sinew_observer_new(robot.0, 20.0, 40.0, &mut observer, null_mut(), 0);
        assert!(!offsets.is_null() && !observer.is_null());
        assert!(COUNT.get() > before, "the counter counts");
        let (mut answer, mut of_joints) = (
            MaybeUninit::uninit(),
            [MaybeUninit::<SinewOffset>::uninit(); N],
        );
        let (to, into) = (answer.as_mut_ptr(), of_joints.as_mut_ptr());
        let mut worked = 0;
        for (i, frame) in frames.iter().enumerate() {
            let (q, theta) = (frame.q.as_ptr(), frame.theta.as_ptr());
            // Some samples are rejected.
            let joints = if i % 999 == 7 { N - 1 } else { N };
            let nan = f64::NAN;
            let mut became = SinewStepped::Accepted;
            let before = COUNT.get();
            sinew_offsets_step(offsets, 0.004, q, theta, null(), nan, joints, &mut became);
            sinew_observer_step(observer, 0.004, q, theta, null(), joints);
            sinew_offsets_read(offsets, to, into.cast(), N);
            if i % 9000 == 8999 {
                sinew_offsets_interrupt(offsets);
            }
            assert_eq!(COUNT.get(), before, "sample {i}");
            // The worker keeps up during the first half; afterwards blocks are dropped.
            if became == SinewStepped::Block && i < frames.len() / 2 {
                sinew_offsets_work(offsets);
                worked += COUNT.get() - before;
            }
        }
        assert!(worked > 0, "the work was counted");
        let answer = answer.assume_init();
        assert!(
            answer.blocks > 100 && answer.blocks_dropped > 0,
            "{answer:?}"
        );
        assert!(of_joints[0].assume_init().offset_rad.is_finite());
        let made = COUNT.get();
        sinew_offsets_free(offsets);
        sinew_observer_free(observer);
        assert!(COUNT.get() > made);
    }
}
