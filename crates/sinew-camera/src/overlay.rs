//! A frame with what was found in it drawn on top, to be checked by eye.
//!
//! Green: a line where the scale has one, longer every tenth; its colour must lie on the print.
//! Blue frame: where the scale was found. Green and red tint: blocks that agree, and blocks with a
//! pattern of the right distance that contradict (numbers, a hand, a second scale).

use super::marks::places;
use super::picture::Picture;
use super::reading::{Reading, Scale};
use super::rejection::millimetres;
use super::strips::STRIP_ROWS;
use super::visibility::View;
use sinew_figure::plot::{escape_xml, pixels};

/// Height of the caption under the picture, px, at least.
const CAPTION_PX: usize = 46;
const GREEN: [u8; 3] = [0, 170, 60];
const RED: [u8; 3] = [215, 40, 30];
const BLUE: [u8; 3] = [20, 90, 220];

/// What stands under the picture.
pub(crate) struct Caption<'a> {
    pub(crate) frame: &'a str,
    pub(crate) scale: &'a Scale,
    pub(crate) reading: &'a Reading,
}

/// The PNG's bytes.
pub(crate) fn draw(
    picture: &Picture,
    view: &View,
    caption: &Caption<'_>,
) -> Result<Vec<u8>, String> {
    let (width, height) = (picture.width(), picture.height());
    let at = |i: usize| picture.level(i % width, i / width);
    let grey = (0..width * height).map(|i| [(255.0 * at(i)).round() as u8; 3]);
    let mut canvas = Canvas {
        pixels: grey.collect(),
        width,
        height,
        upright: view.upright,
    };
    let half = (view.window_px / 4) as f64;
    let rows = STRIP_ROWS as f64 / 2.0;
    for (i, block) in view.blocks.all.iter().enumerate() {
        if view.lined[i] {
            let colour = if view.shift.agree[i] { GREEN } else { RED };
            canvas.tint(
                block.x - half,
                block.x + half,
                block.y - rows,
                block.y + rows,
                colour,
            );
        }
    }
    let agreed = || view.blocks.members(&view.shift.agree);
    let left = agreed().map(|b| b.x).fold(f64::MAX, f64::min) - 2.0 * half;
    let right = agreed().map(|b| b.x).fold(f64::MIN, f64::max) + 2.0 * half;
    let top = agreed().map(|b| b.y).fold(f64::MAX, f64::min) - rows;
    let bottom = agreed().map(|b| b.y).fold(f64::MIN, f64::max) + rows;
    let (sin, cos) = view.map.tilt_rad().sin_cos();
    let (left, right) = (
        left.max(view.window.x as f64),
        right.min((view.window.x + view.window.width) as f64 - 1.0),
    );
    let across = |x: f64, y: f64| (y - view.map.y0) * cos - (x - view.map.x0) * sin;
    let mut range: Vec<f64> = agreed().map(|b| across(b.x, b.y)).collect();
    range.sort_unstable_by(f64::total_cmp);
    let share = |p: f64| {
        range
            .get(((range.len().max(1) - 1) as f64 * p) as usize)
            .copied()
    };
    let (low, high) = (share(0.1).unwrap_or(0.0), share(0.9).unwrap_or(0.0));
    for (number, x, y) in places(&view.map, &view.shift, left, right) {
        // Short dashes leave the print beside them in view.
        let length = if number.rem_euclid(10) == 0 { 1.0 } else { 0.5 };
        let (from, to) = (low, low + length * (high - low));
        canvas.line(
            (x - from * sin, y + from * cos),
            (x - to * sin, y + to * cos),
            GREEN,
        );
    }
    canvas.frame(left, right, top, bottom, BLUE);
    with_caption(canvas, caption)
}

/// Draws in the coordinates of the measurement, which has upright scales lying.
struct Canvas {
    /// Red, green and blue, row by row from the top left.
    pixels: Vec<[u8; 3]>,
    width: usize,
    height: usize,
    upright: bool,
}

impl Canvas {
    fn blend(&mut self, x: i64, y: i64, colour: [u8; 3], share: f64) {
        let (x, y) = if self.upright { (y, x) } else { (x, y) };
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
            return;
        };
        if x < self.width && y < self.height {
            for (held, new) in self.pixels[y * self.width + x].iter_mut().zip(colour) {
                *held = (f64::from(*held) * (1.0 - share) + f64::from(new) * share) as u8;
            }
        }
    }

    fn tint(&mut self, left: f64, right: f64, top: f64, bottom: f64, colour: [u8; 3]) {
        for y in (top + 0.5).ceil() as i64..=(bottom - 0.5).floor() as i64 {
            for x in left.ceil() as i64..right.ceil() as i64 {
                self.blend(x, y, colour, 0.12);
            }
        }
    }

    fn line(&mut self, from: (f64, f64), to: (f64, f64), colour: [u8; 3]) {
        let steps = (to.0 - from.0)
            .abs()
            .max((to.1 - from.1).abs())
            .ceil()
            .max(1.0);
        for i in 0..=steps as i64 {
            let t = i as f64 / steps;
            let (x, y) = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
            // Between two pixels, each has its share.
            let left = x.floor();
            self.blend(left as i64, y.round() as i64, colour, 1.0 - (x - left));
            self.blend(left as i64 + 1, y.round() as i64, colour, x - left);
        }
    }

    fn frame(&mut self, left: f64, right: f64, top: f64, bottom: f64, colour: [u8; 3]) {
        for offset in [0.0, 1.0] {
            let (l, r) = (left + offset, right - offset);
            let (t, b) = (top + offset, bottom - offset);
            for x in l.round() as i64..=r.round() as i64 {
                self.blend(x, t.round() as i64, colour, 1.0);
                self.blend(x, b.round() as i64, colour, 1.0);
            }
            for y in t.round() as i64..=b.round() as i64 {
                self.blend(l.round() as i64, y, colour, 1.0);
                self.blend(r.round() as i64, y, colour, 1.0);
            }
        }
    }
}

/// The picture with a strip of text below, as wide as the picture, as PNG.
fn with_caption(drawn: Canvas, caption: &Caption<'_>) -> Result<Vec<u8>, String> {
    let width = drawn.width;
    let scale = width as f64 / 800.0;
    let height = ((CAPTION_PX as f64 * scale) as usize).max(8);
    let (s, r) = (caption.scale, caption.reading);
    let lines = [
        format!(
            "{}: {:.4} mm ± {:.4} mm, quality {:.2}, {} lines in sight",
            caption.frame,
            1e3 * r.position_m,
            1e3 * r.position_deviation_m,
            r.quality,
            r.lines
        ),
        format!(
            "a line every {} mm = {:.3} px, {:.1} px/mm, tilt {:.2}°, pitch changes by {:.1} % along the scale; longer lines: {}",
            millimetres(s.pitch_m),
            s.pitch_px,
            1e-3 * s.pitch_px / s.pitch_m,
            s.tilt_rad.to_degrees(),
            // No minus before a zero.
            100.0 * s.pitch_change_ratio.abs(),
            s.longer_every
                .map_or("none found".into(), |n| format!("every {n}")),
        ),
    ];
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"{h}\" viewBox=\"0 0 800 {h}\">\
         <text x=\"8\" y=\"18\" font-size=\"13\" font-family=\"Roboto\">{}</text>\
         <text x=\"8\" y=\"37\" font-size=\"13\" font-family=\"Roboto\">{}</text></svg>",
        escape_xml(&lines[0]),
        escape_xml(&lines[1]),
        h = CAPTION_PX
    );
    let strip = pixels(&svg, scale).map_err(|e| e.to_string())?;
    let mut whole = drawn.pixels;
    whole.resize(width * (drawn.height + height), [255; 3]);
    for y in 0..height.min(strip.height) {
        for x in 0..width.min(strip.width) {
            let from = 4 * (y * strip.width + x);
            whole[(drawn.height + y) * width + x].copy_from_slice(&strip.rgba[from..from + 3]);
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, (drawn.height + height) as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(whole.as_flattened()))
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}
