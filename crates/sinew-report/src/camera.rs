//! Camera measurements of a scale as text.

use crate::text::{TerminalText, paragraph, plain};
use sinew_camera::{Outcome, Summary};
use sinew_figure::Columns;
use sinew_model::Z95;

/// Approximate number of rows of the table.
const ROWS: usize = 12;

/// Renders the number of used frames, the scale, and about a dozen measurements.
pub fn render(outcome: &Outcome, s: &Summary) -> String {
    let mut out = TerminalText::default();
    let (used, all, zero) = (s.frames_used, s.frames, &s.reference_frame);
    let (from, to) = (s.time_from_s, s.time_to_s);
    out.flat(format!(
        "{used} of {all} frames used, {from} to {to} s; zero: {zero}"
    ));
    let orientation = match s.scale.upright {
        true => "vertical",
        false => "horizontal",
    };
    // Removes rounding errors of the unit conversion.
    let pitch_mm = (1e12 * s.scale.pitch_m).round() / 1e9;
    let (pitch_px, tilt, lines) = (
        s.scale.pitch_px,
        s.scale.tilt_rad.to_degrees(),
        s.scale.lines,
    );
    let longer = (s.scale.longer_every).map_or("all of equal length".into(), |n| {
        format!("every {n}th longer")
    });
    let scale = format!(
        "scale: {orientation}, pitch {pitch_mm} mm = {pitch_px:.3} px, tilt {tilt:.2}°, {lines} lines, {longer}"
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
            .column("time\n(s)", |(frame, ..)| {
                (frame.time_s * 1e3).round() / 1e3
            })
            .column("elongation\n(mm)", |(.., (m, _))| format!("{:.4}", 1e3 * m))
            .column("95 % CI\n(±)", |(.., (_, std_m))| {
                format!("{:.4}", 1e3 * Z95 * std_m)
            })
            .column("quality", |(_, reading, _)| {
                format!("{:.2}", reading.quality)
            })
            .table(),
    );
    for r in &s.rejected {
        let (frames, reason, first) = (r.frames, &r.reason, plain(&r.first));
        let text = format!("rejected: {frames} {reason}, first {first}");
        out.add(paragraph(&text, 4));
    }
    out.0
}
