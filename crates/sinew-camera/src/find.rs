//! Where in a picture the scale lies, which way it runs and how far apart its lines are.
//!
//! Spectra of short stretches of rows (and, with the picture turned, of columns) vote for a
//! frequency. The one with the most votes is the graduation, unless twice as high a frequency is
//! voted for as well: rows that hold only the longer lines vote for half the frequency, while the
//! lines themselves, being thin, never have more power in a harmonic than in their own frequency.
//! Neighbouring blocks whose phases follow each other at that frequency then make up the scale.

use super::picture::Picture;
use super::robust::{median, quantile};
use super::spectrum::{Spectrum, between_bins};
use super::strips::{Block, Blocks, Demodulator, Region, STRIP_ROWS, Strips};

/// Fewest pixels from line to line: with fewer the second harmonic, which tells thin lines from a
/// chance pattern, is gone.
pub const PITCH_LEAST_PX: f64 = 4.0;
/// Most pixels from line to line.
pub const PITCH_MOST_PX: f64 = 250.0;
/// Smallest contrast that counts as a line, share of the light: 1 grey level of 8 bits at medium
/// light.
const CONTRAST_LEAST: f64 = 0.008;
/// A spectral peak must exceed the median power by this. Of 250 bins of noise the highest is at
/// about ln 250 = 5.5 means or 8 medians.
const PEAK_OVER_MEDIAN: f64 = 20.0;
/// Longest stretch for one spectrum, px.
const STRETCH_PX: usize = 512;
/// Votes within this ratio of frequencies are for the same graduation: perspective changes the
/// pitch over the picture.
const SAME_PITCH: f64 = 1.08;
/// Share of the strongest votes that makes twice the frequency the graduation.
const DOUBLE_SHARE: f64 = 0.3;
/// Amplitude of a block that belongs to the scale, share of the strong ones'. Rows with only
/// every second line have half the amplitude.
pub(crate) const BLOCK_SHARE: f64 = 0.3;
/// Fewest blocks of a scale.
const BLOCKS_LEAST: usize = 6;
/// Largest tilt of the lines, degrees. Beyond it a strip's rows blur its lines.
pub const TILT_MOST_DEG: f64 = 12.0;

/// Where the scale is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// The scale runs from top to bottom: the picture was turned.
    pub(crate) upright: bool,
    /// Graduations per pixel along the row (of the turned picture where upright).
    pub(crate) frequency: f64,
    /// Box around the scale in the picture as measured.
    pub(crate) region: Region,
    /// Blocks of the whole picture.
    pub(crate) blocks: Blocks,
    /// Blocks that belong to it, and its coordinate there, graduations.
    pub(crate) scale: Vec<(usize, f64)>,
}

impl Found {
    /// Blocks that belong to the scale.
    pub(crate) fn members(&self) -> impl Iterator<Item = &Block> {
        self.scale.iter().map(|(at, _)| &self.blocks.all[*at])
    }
}

/// Finds the scale in a picture or the part of it that is named; the error is why there is none.
pub(crate) fn find(
    picture: &Picture,
    within: Option<Region>,
    upright: Option<bool>,
) -> Result<Found, String> {
    let looks = [false, true].into_iter();
    let looks = looks.filter(|turn| upright.is_none_or(|wanted| wanted == *turn));
    let (found, reasons): (Vec<_>, Vec<_>) = looks
        .map(|turn| {
            let view = picture.lying(turn);
            find_along(&view, Region::looked_at(within, turn, &view), turn)
        })
        .partition(Result::is_ok);
    let found = found.into_iter().flatten();
    let best = found.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, found)| found).ok_or_else(|| {
        reasons
            .into_iter()
            .find_map(Result::err)
            .unwrap_or_default()
    })
}

/// Finds a scale along the rows; also its summed amplitude, to choose between two directions.
fn find_along(picture: &Picture, part: Region, upright: bool) -> Result<(f64, Found), String> {
    if part.height < STRIP_ROWS || part.width < 32 {
        return Err(format!(
            "{} × {} px is too small for a scale",
            part.width, part.height
        ));
    }
    let strips = Strips::of(picture, part);
    let frequency = vote(&strips)?;
    let demodulator = Demodulator::new(frequency, part.width);
    let blocks = demodulator.blocks(&strips);
    let scale = grow(&blocks, frequency).ok_or_else(|| {
        format!(
            "a pattern every {:.1} px, but no connected region of lines",
            1.0 / frequency
        )
    })?;
    let mut found = Found {
        upright,
        frequency,
        region: part,
        blocks,
        scale,
    };
    found.region = around(&found, demodulator.length() as f64 / 2.0, picture);
    let weight = found.members().map(Block::contrast).sum();
    Ok((weight, found))
}

/// The frequency that most stretches have their peak at.
fn vote(strips: &Strips) -> Result<f64, String> {
    let width = strips.region.width;
    let length = STRETCH_PX.min(1 << width.ilog2());
    // Large pitches need long stretches: averaging neighbouring pixels makes the stretch longer.
    let mut votes: Vec<(f64, f64)> = Vec::new();
    let mut shrink = 1;
    while length * shrink <= width.max(length) && shrink <= 8 {
        collect(strips, length, shrink, &mut votes);
        shrink *= 4;
    }
    let top = strongest(&votes).ok_or_else(|| {
        format!(
            "no evenly spaced lines {PITCH_LEAST_PX} to {PITCH_MOST_PX} px apart stand out of the picture"
        )
    })?;
    let double = within(&votes, 2.0 * top.0);
    let chosen = if double.1 >= DOUBLE_SHARE * top.1 {
        double.0
    } else {
        top.0
    };
    Ok(chosen)
}

fn collect(strips: &Strips, length: usize, shrink: usize, votes: &mut Vec<(f64, f64)>) {
    let spectrum = Spectrum::new(length);
    // Six graduations in a stretch at least.
    let lowest = 6.max(length * shrink / PITCH_MOST_PX as usize);
    let highest = (length as f64 / 3.0).min((length * shrink) as f64 / PITCH_LEAST_PX) as usize;
    if highest <= lowest + 2 {
        return;
    }
    for i in 0..strips.count {
        let mean = |part: &[f32]| part.iter().sum::<f32>() / shrink as f32;
        let levels: Vec<f32> = strips.strip(i).chunks_exact(shrink).map(mean).collect();
        for stretch in levels.windows(length).step_by(length / 2) {
            let (mean, power) = spectrum.of(stretch);
            let peak = (lowest..=highest).max_by(|a, b| power[*a].total_cmp(&power[*b]));
            let (Some(peak), Some(median)) = (peak, median(power[lowest..=highest].to_vec()))
            else {
                continue;
            };
            let contrast = power[peak].sqrt() / mean.max(0.5 / 255.0);
            let is_peak = power[peak] > power[peak - 1] && power[peak] > power[peak + 1];
            if is_peak && contrast >= CONTRAST_LEAST && power[peak] >= PEAK_OVER_MEDIAN * median {
                let frequency = between_bins(&power, peak) / (length * shrink) as f64;
                votes.push((frequency, contrast * shrink as f64));
            }
        }
    }
    votes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
}

/// Weighted median frequency and sum of the votes of the fullest bracket, looked for around so many of them.
fn strongest(votes: &[(f64, f64)]) -> Option<(f64, f64)> {
    const LOOKS: usize = 1000;
    let every = votes.len().div_ceil(LOOKS).max(1);
    let brackets = votes
        .iter()
        .step_by(every)
        .map(|vote| within(votes, vote.0));
    brackets.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Weighted median frequency and sum of the votes around a frequency.
fn within(votes: &[(f64, f64)], around: f64) -> (f64, f64) {
    let (low, high) = (around / SAME_PITCH.sqrt(), around * SAME_PITCH.sqrt());
    let first = votes.partition_point(|(frequency, _)| *frequency < low);
    let last = votes.partition_point(|(frequency, _)| *frequency <= high);
    let near = &votes[first..last];
    let sum: f64 = near.iter().map(|(_, w)| w).sum();
    let mut passed = 0.0;
    for (frequency, weight) in near {
        passed += weight;
        if passed >= 0.5 * sum {
            return (*frequency, sum);
        }
    }
    (around, 0.0)
}

/// Largest connected set of blocks with lines whose phases follow each other.
fn grow(blocks: &Blocks, frequency: f64) -> Option<Vec<(usize, f64)>> {
    // The scale may cover little of the picture: strong means the strongest fiftieth.
    let contrasts = blocks.all.iter().map(Block::contrast).collect();
    let strong = quantile(contrasts, 0.98)?;
    let least = (BLOCK_SHARE * strong).max(CONTRAST_LEAST);
    let bright: Vec<bool> = blocks.all.iter().map(|b| b.contrast() >= least).collect();
    let (across, down) = blocks.common_steps(&bright);
    // A step across passes whole graduations.
    let hop = blocks.hop;
    let whole = (frequency * hop - across).round();
    let slopes = ((whole + across) / hop, down / STRIP_ROWS as f64);
    let step = |a: &Block, b: &Block| slopes.0 * (b.x - a.x) + slopes.1 * (b.y - a.y);
    let scale = blocks.unwrapped(&bright, step);
    (scale.len() >= BLOCKS_LEAST).then_some(scale)
}

fn around(found: &Found, half: f64, picture: &Picture) -> Region {
    let (mut left, mut right) = (f64::MAX, f64::MIN);
    let (mut top, mut bottom) = (f64::MAX, f64::MIN);
    for block in found.members() {
        left = left.min(block.x - half);
        right = right.max(block.x + half);
        top = top.min(block.y - STRIP_ROWS as f64 / 2.0);
        bottom = bottom.max(block.y + STRIP_ROWS as f64 / 2.0);
    }
    let low = |v: f64| v.round().max(0.0) as usize;
    let (x, y) = (low(left), low(top));
    Region {
        x,
        y,
        width: (low(right) + 1).min(picture.width()) - x,
        height: (low(bottom) + 1).min(picture.height()) - y,
    }
}
