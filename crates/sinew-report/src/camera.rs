//! A series of camera readings as text.

use crate::text::{paragraph, plain, table};
use sinew_camera::{Outcome, Summary};
use sinew_model::Z95;

/// Rows of the table: a handful of readings shows the course.
const ROWS: usize = 12;

/// What became of the frames, the scale, and the course in a dozen rows.
pub fn render(outcome: &Outcome, s: &Summary) -> String {
    let mut out = paragraph(
        &format!(
            "{} of {} frames used, {} to {} s; zero is {}",
            s.frames_used,
            s.frames,
            s.time_from_s,
            s.time_to_s,
            plain(&s.reference_frame)
        ),
        0,
    );
    out += &paragraph(
        &format!(
            "scale: {}, a line every {} mm = {:.3} px, tilt {:.2}°, {} lines, {}",
            if s.scale.upright { "upright" } else { "lying" },
            // Without the last digits that a factor of 1000 leaves.
            (1e12 * s.scale.pitch_m).round() / 1e9,
            s.scale.pitch_px,
            s.scale.tilt_rad.to_degrees(),
            s.scale.lines,
            s.scale
                .longer_every
                .map_or("all alike".into(), |n| format!("every {n} longer")),
        ),
        7,
    );
    let used: Vec<_> = outcome.used().collect();
    let every = used.len().div_ceil(ROWS).max(1);
    let rows = used
        .iter()
        .enumerate()
        .filter(|(i, _)| i % every == 0 || i + 1 == used.len())
        .map(|(_, (_, frame, reading))| {
            let (elongation_m, deviation_m) = outcome.elongation_m(reading);
            vec![
                plain(&frame.name),
                format!("{}", (frame.time_s * 1e3).round() / 1e3),
                format!("{:.4}", 1e3 * elongation_m),
                format!("{:.4}", 1e3 * Z95 * deviation_m),
                format!("{:.2}", reading.quality),
            ]
        })
        .collect();
    out += &table(
        &[
            "frame",
            "time, s",
            "elongation, mm",
            "± 95 %, mm",
            "quality",
        ],
        rows,
        1,
    );
    for rejected in &s.rejected {
        out += &paragraph(
            &format!(
                "not used: {} {}, first {}",
                rejected.frames,
                rejected.reason,
                plain(&rejected.first)
            ),
            4,
        );
    }
    out
}
