//! Drawn pictures of a scale with known position: the truth of the camera tests.
//!
//! Every pixel is the mean of the print over its width, with perspective, rotation, blur along the scale, uneven light,
//! sensor noise, dirt on the scale and dust on the lens. The drawing shares no code with the reader.
#![allow(dead_code)]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_camera::Picture;

/// Conditions of the picture.
#[derive(Debug, Clone)]
pub(crate) struct Camera {
    pub width: usize,
    pub height: usize,
    /// Pitch in the middle of the picture, px.
    pub pitch_px: f64,
    /// Rotation of the scale, degrees.
    pub tilt_deg: f64,
    /// Whether the scale runs from top to bottom.
    pub upright: bool,
    /// Increase of magnification per picture width.
    pub perspective: f64,
    /// Standard deviation of the Gaussian blur, px.
    pub blur_px: f64,
    /// Displacement of the scale during the exposure, px.
    pub smear_px: f64,
    /// Ratio of the light at the darkest corner to that at the brightest.
    pub uneven: f64,
    /// Grey level of white paper in full light, 0 to 255.
    pub white: f64,
    /// Standard deviation of the sensor's noise, grey levels.
    pub noise: f64,
    /// Position of the zero line at displacement 0, px from the middle.
    pub zero_px: f64,
    /// Middle of the lines' lower end across the picture, px from the middle.
    pub across_px: f64,
    pub seed: u64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            width: 640,
            height: 200,
            pitch_px: 10.0,
            tilt_deg: 0.0,
            upright: false,
            perspective: 0.0,
            blur_px: 0.8,
            smear_px: 0.0,
            uneven: 1.0,
            white: 215.0,
            noise: 2.0,
            zero_px: -900.0,
            across_px: 30.0,
            seed: 1,
        }
    }
}

/// Print of the scale.
#[derive(Debug, Clone)]
pub(crate) struct Print {
    /// Width of the lines, graduations.
    pub line_width: f64,
    /// Distances and lengths of the longer lines: (every, length in graduations), longest first.
    pub lengths: Vec<(i64, f64)>,
    /// Distance of the numbers in lines; 0: none.
    pub numbers_every: i64,
    /// Darkness of the print, 0 to 1.
    pub ink: f64,
    /// Ends of the scale, graduations from zero.
    pub from: f64,
    pub to: f64,
    /// Dirt: specks that move with the scale.
    pub specks: usize,
    /// Dust: specks fixed in the picture.
    pub dust: usize,
}

impl Print {
    /// Half-millimetre scale: longer lines every 1, 5 and 10 mm, numbers every 10 mm.
    pub(crate) fn half_millimetre() -> Self {
        Self {
            line_width: 0.2,
            lengths: vec![(20, 9.0), (10, 7.5), (2, 6.0), (1, 4.5)],
            numbers_every: 20,
            ink: 0.8,
            from: -4000.0,
            to: 4000.0,
            specks: 0,
            dust: 0,
        }
    }

    /// Millimetre scale: longer lines every 5 and 10 mm.
    pub(crate) fn millimetre() -> Self {
        Self {
            lengths: vec![(10, 6.5), (5, 5.5), (1, 4.0)],
            numbers_every: 10,
            ..Self::half_millimetre()
        }
    }

    /// Lines of one length, no numbers.
    pub(crate) fn comb() -> Self {
        Self {
            lengths: vec![(1, 6.0)],
            numbers_every: 0,
            ..Self::half_millimetre()
        }
    }
}

/// Segments of digits: top, upper left, upper right, middle, lower left, lower right, bottom.
const DIGITS: [u8; 10] = [
    0b1110111, 0b0010010, 0b1011101, 0b1011011, 0b0111010, 0b1101011, 0b1101111, 0b1010010,
    0b1111111, 0b1111011,
];

fn digit(value: u8, u: f64, v: f64) -> bool {
    const THICK: f64 = 0.22;
    let has = |bit: u8| DIGITS[value as usize] >> (6 - bit) & 1 == 1;
    let (left, right) = (u < THICK, u > 1.0 - THICK);
    (0.0..=1.0).contains(&u)
        && (0.0..=2.0).contains(&v)
        && (has(0) && v < THICK
            || has(3) && (v - 1.0).abs() < THICK / 2.0
            || has(6) && v > 2.0 - THICK
            || has(1) && left && v <= 1.0
            || has(2) && right && v <= 1.0
            || has(4) && left && v >= 1.0
            || has(5) && right && v >= 1.0)
}

/// Darkness of a pixel at a distance from a line: line width, pixel width, Gaussian blur and displacement during the
/// exposure, convolved once in steps of 0.01 graduations.
struct Profile {
    values: Vec<f64>,
    reach: f64,
}

impl Profile {
    const STEPS: f64 = 100.0;

    fn new(camera: &Camera, print: &Print) -> Self {
        let blur = camera.blur_px / camera.pitch_px;
        let smear = camera.smear_px / camera.pitch_px;
        let pixel = 1.0 / camera.pitch_px;
        let reach = print.line_width / 2.0 + pixel / 2.0 + smear / 2.0 + 4.0 * blur + 0.02;
        // Samples of the pixel, of the exposure and of the Gaussian between ±4 standard deviations.
        let points = |n: i32, width: f64| -> Vec<f64> {
            (0..n)
                .map(|i| width * ((f64::from(i) + 0.5) / f64::from(n) - 0.5))
                .collect()
        };
        let pixels = points(15, pixel);
        let ways = points(if smear > 0.0 { 25 } else { 1 }, smear);
        let gauss: Vec<(f64, f64)> = if blur > 0.0 {
            points(61, 8.0)
                .into_iter()
                .map(|z| (z * blur, (-z * z / 2.0).exp()))
                .collect()
        } else {
            vec![(0.0, 1.0)]
        };
        let total: f64 = gauss.iter().map(|g| g.1).sum();
        let values = (0..=(reach * Self::STEPS) as usize + 1)
            .map(|i| {
                let at = i as f64 / Self::STEPS;
                let mut sum = 0.0;
                for (shift, weight) in &gauss {
                    for p in &pixels {
                        for w in &ways {
                            if (at + shift + p + w).abs() < print.line_width / 2.0 {
                                sum += weight;
                            }
                        }
                    }
                }
                sum / (total * (pixels.len() * ways.len()) as f64)
            })
            .collect();
        Self { values, reach }
    }

    fn at(&self, apart: f64) -> f64 {
        let place = apart.abs() * Self::STEPS;
        let i = place as usize;
        match (self.values.get(i), self.values.get(i + 1)) {
            (Some(a), Some(b)) => a + (b - a) * (place - i as f64),
            _ => 0.0,
        }
    }

    /// Darkness from all lines near `s` that reach to the height `t` above the base.
    fn lines(&self, print: &Print, s: f64, t: f64) -> f64 {
        let mut sum = 0.0;
        for line in (s - self.reach).ceil() as i64..=(s + self.reach).floor() as i64 {
            let length = print
                .lengths
                .iter()
                .find(|(every, _)| line.rem_euclid(*every) == 0)
                .map_or(0.0, |l| l.1);
            if (0.0..=length).contains(&t) {
                sum += self.at(s - line as f64);
            }
        }
        sum.min(1.0)
    }
}

fn number(print: &Print, s: f64, t: f64) -> bool {
    if print.numbers_every == 0 {
        return false;
    }
    let (height, width, gap) = (3.0, 1.5, 0.7);
    let top = print.lengths[0].1 + 1.0 + height;
    if t > top || t < top - height {
        return false;
    }
    let line = (s / print.numbers_every as f64).round() as i64 * print.numbers_every;
    let value = (line / 2).unsigned_abs().to_string();
    let whole = value.len() as f64 * (width + gap) - gap;
    let at = s - line as f64 + whole / 2.0;
    let place = (at / (width + gap)).floor();
    if place < 0.0 || place as usize >= value.len() {
        return false;
    }
    let figure = value.as_bytes()[place as usize] - b'0';
    digit(
        figure,
        (at - place * (width + gap)) / width,
        (top - t) / height * 2.0,
    )
}

/// Draws the scale displaced by `displacement` graduations; grey levels 0 to 255, row-major.
pub(crate) fn draw(camera: &Camera, print: &Print, displacement: f64) -> Vec<f64> {
    let (w, h) = (camera.width as f64, camera.height as f64);
    let (sin, cos) = camera.tilt_deg.to_radians().sin_cos();
    let mut dirt = ChaCha8Rng::seed_from_u64(77);
    let specks: Vec<(f64, f64, f64)> = (0..print.specks)
        .map(|_| {
            (
                240.0 * dirt.random::<f64>(),
                10.0 * dirt.random::<f64>(),
                0.2 + 0.6 * dirt.random::<f64>(),
            )
        })
        .collect();
    let dust: Vec<(f64, f64, f64)> = (0..print.dust)
        .map(|_| {
            (
                w * dirt.random::<f64>(),
                h * dirt.random::<f64>(),
                2.0 + 6.0 * dirt.random::<f64>(),
            )
        })
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(camera.seed);
    let profile = Profile::new(camera, print);
    let mut out = vec![0.0; camera.width * camera.height];
    let length = if camera.upright { h } else { w };
    for row in 0..camera.height {
        for column in 0..camera.width {
            let (x, y) = (
                column as f64 - (w - 1.0) / 2.0,
                row as f64 - (h - 1.0) / 2.0,
            );
            let (x, y) = if camera.upright { (y, x) } else { (x, y) };
            let zoom = 1.0 + camera.perspective * x / length;
            let (across, down) = (x * cos + y * sin, -x * sin + y * cos);
            let s = (across / zoom - camera.zero_px) / camera.pitch_px - displacement;
            let t = (camera.across_px - down / zoom) / camera.pitch_px;
            let mut ink = 0.0;
            if s >= print.from && s <= print.to {
                ink = profile.lines(print, s, t);
                let speck = |&(a, c, r): &(f64, f64, f64)| {
                    let d = s.rem_euclid(240.0) - a;
                    d * d + (t - c) * (t - c) < r * r
                };
                if number(print, s, t) || specks.iter().any(speck) {
                    ink = 1.0;
                }
            }
            let corner = ((x / w + 0.5) + (y / h + 0.5)) / 2.0;
            let light = camera.white * (1.0 - (1.0 - camera.uneven) * corner);
            let mut level = light * (1.0 - print.ink * ink);
            for &(dx, dy, r) in &dust {
                let d2 = (column as f64 - dx).powi(2) + (row as f64 - dy).powi(2);
                level *= 1.0 - 0.5 * (-d2 / (r * r)).exp();
            }
            let noise: f64 = StandardNormal.sample(&mut rng);
            out[row * camera.width + column] = (level + camera.noise * noise).clamp(0.0, 255.0);
        }
    }
    out
}

/// Draws 8-bit grey levels.
pub(crate) fn draw8(camera: &Camera, print: &Print, displacement: f64) -> Vec<u8> {
    draw(camera, print, displacement)
        .into_iter()
        .map(|v| v.round() as u8)
        .collect()
}

/// Draws a [`Picture`] for the reader.
pub(crate) fn picture(camera: &Camera, print: &Print, displacement: f64) -> Picture {
    Picture::from_luma8(
        camera.width,
        camera.height,
        draw8(camera, print, displacement),
    )
    .unwrap()
}

/// Draws a PNG with 8-bit grey levels.
pub(crate) fn png(camera: &Camera, print: &Print, displacement: f64) -> Vec<u8> {
    encode_png(
        camera,
        &draw8(camera, print, displacement),
        png::ColorType::Grayscale,
        png::BitDepth::Eight,
    )
}

/// Encodes pixels as PNG; 16 bits are big-endian.
pub(crate) fn encode_png(
    camera: &Camera,
    bytes: &[u8],
    colour: png::ColorType,
    depth: png::BitDepth,
) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, camera.width as u32, camera.height as u32);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(bytes).unwrap();
    writer.finish().unwrap();
    out
}

/// Draws a JPEG.
pub(crate) fn jpeg(camera: &Camera, print: &Print, displacement: f64, quality: u8) -> Vec<u8> {
    let mut out = Vec::new();
    jpeg_encoder::Encoder::new(&mut out, quality)
        .encode(
            &draw8(camera, print, displacement),
            camera.width as u16,
            camera.height as u16,
            jpeg_encoder::ColorType::Luma,
        )
        .unwrap();
    out
}
