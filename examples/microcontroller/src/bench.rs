//! Test bench: reads samples from a file of the host and writes results to another, by semihosting. A product reads encoders.

use alloc::vec::Vec;
use cortex_m_semihosting::{debug, syscall};
use sinew_model::feeder::RobotSample;

/// File of the host, accessed by semihosting.
pub struct File(usize);

impl File {
    /// Opens `name`, which ends with a zero byte.
    pub fn open(name: &'static [u8], mode: Mode) -> Self {
        let length = name.len() - 1;
        // SAFETY: the arguments specified by ARM semihosting: name, mode, length.
        let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode as usize, length) };
        if handle == usize::MAX {
            fail();
        }
        Self(handle)
    }

    /// Fills `bytes`; `false` at the end of the file.
    pub fn read(&mut self, bytes: &mut [u8]) -> bool {
        // SAFETY: the arguments specified by ARM semihosting: handle, memory, length; it returns the number of missing bytes.
        unsafe { syscall!(READ, self.0, bytes.as_mut_ptr(), bytes.len()) == 0 }
    }

    /// Writes `bytes` to the file; a failure ends the program.
    pub fn write(&mut self, bytes: &[u8]) {
        // SAFETY: as above.
        if unsafe { syscall!(WRITE, self.0, bytes.as_ptr(), bytes.len()) } != 0 {
            fail();
        }
    }
}

/// Mode in which a file is opened.
#[derive(Clone, Copy)]
pub enum Mode {
    Read = 1,
    Write = 5,
}

/// Ends the program with the exit status of a failure.
pub fn fail() -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::bkpt();
    }
}

/// Samples of a recording, in sequence: time, segment, temperature, then `q`, `theta`, `tau_m`, little endian.
pub struct Samples {
    file: File,
    bytes: Vec<u8>,
    values: [Vec<f64>; 3],
}

const HEAD: usize = 8 + 4 + 8;

impl Samples {
    pub fn open(name: &'static [u8], joints: usize) -> Self {
        Self {
            file: File::open(name, Mode::Read),
            bytes: alloc::vec![0; HEAD + 3 * 8 * joints],
            values: core::array::from_fn(|_| alloc::vec![0.0; joints]),
        }
    }

    /// Reads the next sample; `None` at the end of the file.
    pub fn next(&mut self) -> Option<RobotSample<'_>> {
        if !self.file.read(&mut self.bytes) {
            return None;
        }
        let (time, rest) = self.bytes.split_first_chunk()?;
        let (segment, rest) = rest.split_first_chunk()?;
        let (temperature, rest) = rest.split_first_chunk()?;
        let values = self.values.iter_mut().flatten();
        for (value, bytes) in values.zip(rest.as_chunks().0) {
            *value = f64::from_le_bytes(*bytes);
        }
        let [q, theta, tau_m] = &self.values;
        Some(RobotSample {
            time_ns: i64::from_le_bytes(*time),
            segment: u32::from_le_bytes(*segment),
            q,
            theta,
            dq: &[],
            tau_el: &[],
            tau_m,
            tau_ext: &[],
            tension: &[],
            temperature_c: f64::from_le_bytes(*temperature),
        })
    }
}
