//! Overlay: a frame with the detected features, for visual inspection.
//!
//! Green: detected lines, every tenth longer; they must coincide with the print. Blue frame: region of the scale. Green
//! and red tint: consistent blocks, and inconsistent blocks with a pattern of the same pitch (numbers, a hand, a second
//! scale).

use super::marks::places;
use super::picture::Picture;
use super::reading::{Scale, ScaleMeasurement};
use super::rejection::millimetres;
use super::robust::quantile;
use super::strips::STRIP_ROWS;
use super::visibility::View;
use sinew_figure::plot::{escape_xml, pixels};
use std::fmt::Write as _;

/// Height of the caption under a picture 800 px wide, px.
const CAPTION_PX: f64 = 46.0;
/// Maximum side drawn at full resolution, px; larger pictures have a coarser overlay.
const MAX_FULL_SIZE_PX: f64 = 16_000.0;
// One channel of each colour is zero, so that the drawing on white shows its opacity.
const GREEN: &str = "#00aa3c";
const RED: &str = "#d72800";
const BLUE: &str = "#005adc";

/// Caption of the overlay.
pub(crate) struct Caption<'a> {
    pub(crate) frame: &'a str,
    pub(crate) scale: &'a Scale,
    pub(crate) reading: &'a ScaleMeasurement,
}

/// Renders the overlay as PNG.
pub(crate) fn draw(
    picture: &Picture,
    view: &View,
    caption: &Caption<'_>,
) -> Result<Vec<u8>, String> {
    let width = picture.width();
    let text = width as f64 / 800.0;
    let height = picture.height() + ((CAPTION_PX * text) as usize).max(8);
    let matrix = if view.upright { "0 1 1 0" } else { "1 0 0 1" };
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\
         <g transform=\"matrix({matrix} 0.5 0.5)\" fill=\"none\">{}</g>\
         <g transform=\"translate(0 {}) scale({text})\">{}</g></svg>",
        marked(view),
        picture.height(),
        words(caption),
    );
    let scale = (MAX_FULL_SIZE_PX / width.max(height) as f64).min(1.0);
    let drawn = pixels(&svg, scale).map_err(|e| e.to_string())?;
    let mut whole = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            let dark = match y < picture.height() {
                true => 1.0 - picture.level(x, y),
                false => 0.0,
            };
            let at = |v: usize, most: usize| ((v as f64 * scale) as usize).min(most - 1);
            let from = 4 * (at(y, drawn.height) * drawn.width + at(x, drawn.width));
            let over = &drawn.rgba[from..from + 3];
            let bare = f64::from(*over.iter().min().unwrap_or(&u8::MAX));
            whole.extend(
                over.iter()
                    .map(|v| (f64::from(*v) - bare * dark).round() as u8),
            );
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&whole))
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Draws blocks, lines and the frame of the scale, in measurement coordinates, in which upright scales are transposed.
fn marked(view: &View) -> String {
    let mut svg = String::new();
    let mut rect = |[left, right, top, bottom]: [f64; 4], style: &str| {
        let (width, height) = (right - left, bottom - top);
        let _ = write!(
            svg,
            "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" {style}/>"
        );
    };
    let half = (view.window_px / 4) as f64;
    let rows = STRIP_ROWS as f64 / 2.0;
    for (i, block) in view
        .blocks
        .all
        .iter()
        .enumerate()
        .filter(|(i, _)| view.lined[*i])
    {
        let colour = if view.shift.agree[i] { GREEN } else { RED };
        let around = [
            block.x - half,
            block.x + half,
            block.y - rows,
            block.y + rows,
        ];
        let style =
            format!("fill=\"{colour}\" fill-opacity=\"0.12\" shape-rendering=\"crispEdges\"");
        rect(around, &style);
    }
    let agreed = || view.blocks.members(&view.shift.agree);
    let left = agreed().map(|b| b.x).fold(f64::MAX, f64::min) - 2.0 * half;
    let right = agreed().map(|b| b.x).fold(f64::MIN, f64::max) + 2.0 * half;
    let top = agreed().map(|b| b.y).fold(f64::MAX, f64::min) - rows;
    let bottom = agreed().map(|b| b.y).fold(f64::MIN, f64::max) + rows;
    let left = left.max(view.window.x as f64);
    let right = right.min((view.window.x + view.window.width) as f64 - 1.0);
    let style = format!("stroke=\"{BLUE}\" stroke-width=\"2\"");
    rect([left, right, top, bottom], &style);
    let (sin, cos) = view.map.tilt_rad().sin_cos();
    let across: Vec<f64> = agreed().map(|b| view.map.across(b.x, b.y)).collect();
    let share = |p: f64| quantile(across.clone(), p).unwrap_or(0.0);
    let (low, high) = (share(0.1), share(0.9));
    for (number, x, y) in places(&view.map, &view.shift, left, right) {
        // Short dashes leave the adjacent print visible.
        let length = if number.rem_euclid(10) == 0 { 1.0 } else { 0.5 };
        let end = |at: f64| format!("{} {}", x - at * sin, y + at * cos);
        let (from, to) = (end(low), end(low + length * (high - low)));
        let _ = write!(svg, "<path d=\"M{from}L{to}\" stroke=\"{GREEN}\"/>");
    }
    svg
}

/// Returns two lines of text for a caption 800 px wide.
fn words(caption: &Caption<'_>) -> String {
    let (s, r) = (caption.scale, caption.reading);
    let lines = [
        format!(
            "{}: {:.4} mm ± {:.4} mm, quality {:.2}, {} lines in sight",
            caption.frame,
            1e3 * r.position_m,
            1e3 * r.position_std_m,
            r.quality,
            r.lines
        ),
        format!(
            "a line every {} mm = {:.3} px, {:.1} px/mm, tilt {:.2}°, pitch changes by {:.1} % along the scale; longer lines: {}",
            millimetres(s.pitch_m),
            s.pitch_px,
            1e-3 * s.pitch_px / s.pitch_m,
            s.tilt_rad.to_degrees(),
            // Avoids a minus sign before zero.
            100.0 * s.pitch_change_ratio.abs(),
            s.longer_every
                .map_or("none found".into(), |n| format!("every {n}")),
        ),
    ];
    let row = |(line, y): (&String, u32)| {
        let text = escape_xml(line);
        format!("<text x=\"8\" y=\"{y}\" font-size=\"13\" font-family=\"Roboto\">{text}</text>")
    };
    lines.iter().zip([18, 37]).map(row).collect()
}
