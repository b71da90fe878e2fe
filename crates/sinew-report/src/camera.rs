//! A series of camera readings as text.

use crate::text::{Told, paragraph, plain};
use sinew_camera::{Outcome, Summary};
use sinew_figure::Columns;
use sinew_model::Z95;

/// Rows of the table: a handful of readings shows the course.
const ROWS: usize = 12;

/// What became of the frames, the scale, and the course in a dozen rows.
pub fn render(outcome: &Outcome, s: &Summary) -> String {
    let mut out = Told::default();
    let (used, all, zero) = (s.frames_used, s.frames, &s.reference_frame);
    let (from, to) = (s.time_from_s, s.time_to_s);
    out.flat(format!(
        "{used} of {all} frames used, {from} to {to} s; zero is {zero}"
    ));
    let lies = if s.scale.upright { "upright" } else { "lying" };
    // Without the last digits that a factor of 1000 leaves.
    let pitch_mm = (1e12 * s.scale.pitch_m).round() / 1e9;
    let (pitch_px, tilt, lines) = (
        s.scale.pitch_px,
        s.scale.tilt_rad.to_degrees(),
        s.scale.lines,
    );
    let longer = (s.scale.longer_every).map_or("all alike".into(), |n| format!("every {n} longer"));
    let scale = format!(
        "scale: {lies}, a line every {pitch_mm} mm = {pitch_px:.3} px, tilt {tilt:.2}°, {lines} lines, {longer}"
    );
    out.add(paragraph(&scale, 7));
    let used: Vec<_> = outcome.used().collect();
    let every = used.len().div_ceil(ROWS).max(1);
    let rows = used.iter().enumerate();
    let rows = rows.filter(|(i, _)| i % every == 0 || i + 1 == used.len());
    let rows = rows.map(|(_, (_, frame, reading))| (frame, reading, outcome.elongation_m(reading)));
    out.table(
        Columns::of(rows)
            .words("frame", |(frame, ..)| &frame.name)
            .column("time, s", |(frame, ..)| (frame.time_s * 1e3).round() / 1e3)
            .column("elongation, mm", |(.., (m, _))| format!("{:.4}", 1e3 * m))
            .column("± 95 %, mm", |(.., (_, deviation_m))| {
                format!("{:.4}", 1e3 * Z95 * deviation_m)
            })
            .column("quality", |(_, reading, _)| {
                format!("{:.2}", reading.quality)
            })
            .table(),
    );
    for r in &s.rejected {
        let (frames, reason, first) = (r.frames, &r.reason, plain(&r.first));
        let text = format!("not used: {frames} {reason}, first {first}");
        out.add(paragraph(&text, 4));
    }
    out.0
}
