//! Reads every frame of a recording and prints its health: `read_all FILE [REPEAT]`.

use std::time::Instant;

fn main() -> Result<(), sinew_log::LogError> {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else {
        eprintln!("usage: read_all FILE [REPEAT]");
        return Ok(());
    };
    let repeat: u32 = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(1);
    for _ in 0..repeat {
        let start = Instant::now();
        let options = sinew_log::OpenOptions::default();
        let mut recording = sinew_log::open(std::path::Path::new(&file), &options)?;
        while recording.next_frame()?.is_some() {}
        let seconds = start.elapsed().as_secs_f64();
        let health = recording.health();
        println!(
            "{} frames of {} joints, {:.0} MB/s, damaged: {}, implausible_signals: {:?}",
            health.frames,
            recording.joints().len(),
            recording.progress().bytes_total as f64 * 1e-6 / seconds,
            health.is_damaged(),
            health.implausible_signals
        );
    }
    Ok(())
}
