//! A million steps through the C interface. RealtimeSanitizer terminates the program at the first allocation or lock.
//! Usage: `sinew-c-sanitize ROBOT_DIR BASELINE [--allocate]`; with `--allocate` one step allocates, to test the sanitizer.

#![feature(sanitize)]

use sinew_c::observer::{SinewObserver, sinew_observer_new, sinew_observer_step};
use sinew_c::offsets::{
    SinewAnswer, SinewOffset, SinewOffsets, sinew_offsets_free, sinew_offsets_new, sinew_offsets_read,
    sinew_offsets_start_worker, sinew_offsets_step,
};
use sinew_c::robot::{sinew_robot_joints, sinew_robot_open};
use sinew_c::status::Status;
use std::ffi::CString;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

const STEPS: u32 = 1_000_000;
const DT_S: f64 = 1e-3;
/// Number of initial steps in which the loop waits for the worker between cycles; later blocks are dropped.
const WAITS: u32 = 60_000;

struct Loop {
    offsets: *mut SinewOffsets,
    observer: *mut SinewObserver,
    q: Vec<f64>,
    theta: Vec<f64>,
    answer: MaybeUninit<SinewAnswer>,
    of_joints: Vec<MaybeUninit<SinewOffset>>,
}

/// Executes one cycle of a control loop at time `t`, s.
#[sanitize(realtime = "nonblocking")]
fn cycle(state: &mut Loop, t: f64, allocate: bool) -> f64 {
    for (i, (q, theta)) in state.q.iter_mut().zip(&mut state.theta).enumerate() {
        *q = 0.5 * (0.7 * t + i as f64).sin();
        *theta = *q + 0.01 * (0.3 * t).sin();
    }
    let (q, theta, n) = (state.q.as_ptr(), state.theta.as_ptr(), state.q.len());
    // SAFETY: valid handles, arrays of `n` numbers; values are written before they are read.
    let mut mean = unsafe {
        sinew_offsets_step(state.offsets, DT_S, q, theta, null(), f64::NAN, n, null_mut());
        sinew_observer_step(state.observer, DT_S, q, theta, null(), n);
        let of_joints = state.of_joints.as_mut_ptr().cast();
        sinew_offsets_read(state.offsets, state.answer.as_mut_ptr(), of_joints, n);
        state.of_joints[0].assume_init().offset_rad
    };
    if allocate {
        mean += std::hint::black_box(vec![t; 100])[3];
    }
    mean
}

fn behind(state: &mut Loop) -> u64 {
    let n = state.q.len();
    // SAFETY: a handle and a place, which is written.
    unsafe {
        sinew_offsets_read(state.offsets, state.answer.as_mut_ptr(), null_mut(), n);
        state.answer.assume_init().blocks_behind
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, folder, baseline, rest @ ..] = arguments.as_slice() else {
        panic!("usage: sinew-c-sanitize ROBOT_DIR BASELINE [--allocate]");
    };
    let folder = CString::new(folder.as_str()).unwrap();
    let baseline = CString::new(std::fs::read(baseline).unwrap()).unwrap();
    let mut state = Loop {
        offsets: null_mut(),
        observer: null_mut(),
        q: Vec::new(),
        theta: Vec::new(),
        answer: MaybeUninit::uninit(),
        of_joints: Vec::new(),
    };
    let mut robot = null_mut();
    // SAFETY: texts and places.
    unsafe {
        let no = (null_mut(), 0);
        assert_eq!(sinew_robot_open(folder.as_ptr(), &mut robot, no.0, no.1), Status::Ok);
        let made = sinew_offsets_new(robot, baseline.as_ptr(), null(), &mut state.offsets, no.0, no.1);
        assert_eq!(made, Status::Ok);
        let made = sinew_observer_new(robot, 20.0, 40.0, &mut state.observer, no.0, no.1);
        assert_eq!(made, Status::Ok);
        state.q = vec![0.0; sinew_robot_joints(robot)];
        state.theta = state.q.clone();
        state.of_joints = vec![MaybeUninit::uninit(); state.q.len()];
        // The worker solves concurrently and falls behind: blocks are dropped.
        assert_eq!(sinew_offsets_start_worker(state.offsets), Status::Ok);
    }
    let (mut last_rad, mut longest) = (f64::NAN, Duration::ZERO);
    for step in 0..STEPS {
        let start = Instant::now();
        last_rad = cycle(&mut state, DT_S * f64::from(step), rest.len() == 1 && step == 999);
        longest = longest.max(start.elapsed());
        while step < WAITS && behind(&mut state) > 5 {
            std::thread::yield_now();
        }
    }
    // SAFETY: read in the last cycle; freed once.
    let answer = unsafe {
        sinew_offsets_free(state.offsets);
        state.answer.assume_init()
    };
    let (taken, dropped) = (answer.blocks, answer.blocks_dropped);
    println!("{taken} blocks taken, {dropped} dropped");
    println!("{STEPS} cycles, none allocated or locked; the longest took {longest:?}; offset {last_rad:.3} rad");
}
