//! Sinew on a Cortex-M: the paper's observer and blocks on the chip, blocks over a serial line to a host that estimates.
//!
//! `chip` is the part of a product, `board` the emulated hardware, `bench` a test bench in place of encoders. The script
//! `check` in the parent folder builds and runs the program.

#![no_std]
#![no_main]

extern crate alloc;

mod bench;
mod board;
mod chip;

use bench::{File, Mode, Samples, fail};
use board::{Heap, Timer, Uart};
use chip::Chip;

/// Image of the robot, written by the host.
static ROBOT: &[u8] = include_bytes!(env!("SINEW_ROBOT_IMAGE"));

/// Size of the heap, bytes; sufficient for nine joints.
const HEAP_BYTES: usize = 96 * 1024;

#[global_allocator]
static HEAP: Heap = Heap::empty();

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    fail()
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut MEMORY: [u64; HEAP_BYTES / 8] = [0; HEAP_BYTES / 8];
    // SAFETY: the memory is used only here.
    unsafe { HEAP.start(MEMORY.as_mut_ptr() as usize, HEAP_BYTES) };
    board::paint_stack();

    let Some(mut chip) = Chip::new(ROBOT) else {
        fail()
    };
    let [heap, heap_most, _] = HEAP.counts();
    let mut samples = Samples::open(b"samples.bin\0", chip.joints());
    let mut offsets = File::open(b"chip.offsets\0", Mode::Write);
    let mut line = Uart::start();
    let timer = Timer::start();
    let stack_start = board::stack_used();
    board::paint_stack();
    let [.., calls] = HEAP.counts();

    let (mut observe, mut collect) = (Ticks::default(), Ticks::default());
    let mut blocks = 0_u32;
    while let Some(reading) = samples.next() {
        let start = timer.ticks();
        let read = chip.observe(&reading);
        observe.add(start, timer.ticks());
        // Output for a controller on the chip. NaN marks a rejected sample.
        for i in 0..reading.q.len() {
            let offset = read.and_then(|x| x.get(i)).copied().unwrap_or(f64::NAN);
            offsets.write(&offset.to_le_bytes());
        }

        let start = timer.ticks();
        blocks += u32::from(chip.collect(&reading));
        collect.add(start, timer.ticks());

        // Sends as many bytes as the line accepts; under qemu all of them.
        while let [byte, ..] = *chip.sender.pending() {
            if !line.send(byte) {
                break;
            }
            chip.sender.sent(1);
        }
    }

    let [.., calls_end] = HEAP.counts();
    let start = timer.ticks();
    let empty = timer.ticks().wrapping_sub(start);
    let [flash, statics] = board::sizes();
    let figures = [
        chip.joints() as u32,
        flash as u32,
        ROBOT.len() as u32,
        (statics - HEAP_BYTES) as u32,
        heap as u32,
        heap_most as u32,
        (calls_end - calls) as u32,
        stack_start as u32,
        board::stack_used() as u32,
        empty,
        observe.mean(),
        observe.most,
        collect.mean(),
        collect.most,
        blocks,
        chip.sender.skipped(),
        chip.sender.frame_bytes_max() as u32,
    ];
    let mut file = File::open(b"chip.figures\0", Mode::Write);
    for figure in figures {
        file.write(&figure.to_le_bytes());
    }
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_SUCCESS);
    fail()
}

/// Sum, maximum and number of tick counts.
#[derive(Default)]
struct Ticks {
    sum: u64,
    most: u32,
    count: u32,
}

impl Ticks {
    fn add(&mut self, start: u32, end: u32) {
        let ticks = end.wrapping_sub(start);
        self.sum += u64::from(ticks);
        self.most = self.most.max(ticks);
        self.count += 1;
    }

    fn mean(&self) -> u32 {
        (self.sum / u64::from(self.count.max(1))) as u32
    }
}
