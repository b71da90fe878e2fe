//! Board emulated by qemu: serial line, timer, counted memory.

use core::alloc::{GlobalAlloc, Layout};
use core::sync::atomic::{AtomicUsize, Ordering};
use embedded_alloc::LlffHeap;

/// First UART of ARM's MPS2 boards (CMSDK APB UART).
pub struct Uart;

const UART: *mut u32 = 0x4000_4000 as *mut u32;
// Registers, in words.
const DATA: usize = 0;
const STATE: usize = 1;
const CONTROL: usize = 2;
/// Divider of the baud rate.
const DIVIDER: usize = 4;
const STATE_FULL: u32 = 1;
const CONTROL_SEND: u32 = 1;

impl Uart {
    /// Enables the UART. The baud rate has no effect under qemu.
    pub fn start() -> Self {
        // SAFETY: registers of this board, used only here.
        unsafe {
            UART.add(DIVIDER).write_volatile(16);
            UART.add(CONTROL).write_volatile(CONTROL_SEND);
        }
        Self
    }

    /// Sends a byte, if it can take one now. Never waits.
    pub fn send(&mut self, byte: u8) -> bool {
        // SAFETY: as above.
        unsafe {
            if UART.add(STATE).read_volatile() & STATE_FULL != 0 {
                return false;
            }
            UART.add(DATA).write_volatile(u32::from(byte));
        }
        true
    }
}

/// First CMSDK APB timer, which counts down at the board's 25 MHz.
pub struct Timer;

const TIMER: *mut u32 = 0x4000_0000 as *mut u32;
// Registers, in words.
const TIMER_CONTROL: usize = 0;
const VALUE: usize = 1;
const RELOAD: usize = 2;

impl Timer {
    /// Starts the timer with a range of 32 bits.
    pub fn start() -> Self {
        // SAFETY: registers of this board, used only here.
        unsafe {
            TIMER.add(RELOAD).write_volatile(u32::MAX);
            TIMER.add(VALUE).write_volatile(u32::MAX);
            TIMER.add(TIMER_CONTROL).write_volatile(1);
        }
        Self
    }

    /// Ticks since the start, modulo 2³².
    pub fn ticks(&self) -> u32 {
        // SAFETY: as above.
        !unsafe { TIMER.add(VALUE).read_volatile() }
    }
}

/// Heap that counts its calls and bytes.
pub struct Heap {
    inner: LlffHeap,
    used: AtomicUsize,
    most: AtomicUsize,
    calls: AtomicUsize,
}

impl Heap {
    pub const fn empty() -> Self {
        Self {
            inner: LlffHeap::empty(),
            used: AtomicUsize::new(0),
            most: AtomicUsize::new(0),
            calls: AtomicUsize::new(0),
        }
    }

    /// Sets the memory of the heap.
    ///
    /// # Safety
    /// Called once, with memory that is not used otherwise.
    pub unsafe fn start(&self, at: usize, bytes: usize) {
        // SAFETY: guaranteed by the caller.
        unsafe { self.inner.init(at, bytes) }
    }

    /// Returns the bytes in use, their maximum, and the number of calls.
    pub fn counts(&self) -> [usize; 3] {
        [&self.used, &self.most, &self.calls].map(|x| x.load(Ordering::Relaxed))
    }
}

// SAFETY: forwards to a valid allocator, and counts.
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // The heap allocates multiples of eight bytes.
        let size = layout.size().next_multiple_of(8);
        self.calls.fetch_add(1, Ordering::Relaxed);
        let used = self.used.fetch_add(size, Ordering::Relaxed) + size;
        self.most.fetch_max(used, Ordering::Relaxed);
        // SAFETY: guaranteed by the caller.
        unsafe { self.inner.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        self.calls.fetch_add(1, Ordering::Relaxed);
        let size = layout.size().next_multiple_of(8);
        self.used.fetch_sub(size, Ordering::Relaxed);
        // SAFETY: guaranteed by the caller.
        unsafe { self.inner.dealloc(at, layout) }
    }
}

unsafe extern "C" {
    static mut __sheap: u32;
    static mut _stack_start: u32;
    static __sidata: u32;
    static __sdata: u32;
    static __edata: u32;
    static __sbss: u32;
    static __ebss: u32;
}

/// Bytes of flash of the program, and of memory for its statics.
pub fn sizes() -> [usize; 2] {
    let at = |x: *const u32| x as usize;
    let data = at(&raw const __edata) - at(&raw const __sdata);
    let bss = at(&raw const __ebss) - at(&raw const __sbss);
    [at(&raw const __sidata) + data, data + bss]
}

const PAINT: u32 = 0xC0DE_57AC;

/// Fills the free stack with a pattern.
#[inline(never)]
pub fn paint_stack() {
    /// Bytes below the stack pointer that this function itself may use, excluded from the pattern.
    const FRAME_BYTES: usize = 128;
    let end = cortex_m::register::msp::read() as usize - FRAME_BYTES;
    let mut at = &raw mut __sheap;
    while (at as usize) < end {
        // SAFETY: the memory between the statics and the used stack is free, because the heap is a static.
        unsafe {
            at.write_volatile(PAINT);
            at = at.add(1);
        }
    }
}

/// Maximum bytes of stack in use since it was filled, counted from its start.
#[inline(never)]
pub fn stack_used() -> usize {
    let mut at = &raw const __sheap;
    let end = &raw const _stack_start;
    // SAFETY: reads memory of the board only.
    while at < end && unsafe { at.read_volatile() } == PAINT {
        at = unsafe { at.add(1) };
    }
    end as usize - at as usize
}
