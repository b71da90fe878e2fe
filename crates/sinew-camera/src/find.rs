//! Detection of the scale in a picture: region, direction and pitch.
//!
//! Spectra of short sections of rows (and of columns, with the picture transposed) vote for a frequency. The frequency
//! with the most votes is the graduation, unless twice that frequency also has votes: rows that contain only the longer
//! lines vote for half the frequency, whereas thin lines never have more power in a harmonic than in their fundamental
//! frequency. Connected blocks with consistent phases at that frequency form the scale.

use super::picture::Picture;
use super::robust::{median, quantile};
use super::spectrum::{Spectrum, between_bins};
use super::strips::{Block, Blocks, Demodulator, Region, STRIP_ROWS, Strips};

/// Minimum pitch, px per graduation; below it the second harmonic, which distinguishes thin lines from a random
/// pattern, is lost.
pub const MIN_PITCH_PX: f64 = 4.0;
/// Maximum pitch, px per graduation.
pub const MAX_PITCH_PX: f64 = 250.0;
/// Minimum contrast of a line relative to the illumination: 1 of 256 grey levels at medium light.
const MIN_CONTRAST: f64 = 0.008;
/// Minimum ratio of a spectral peak to the median power. The highest of 250 noise bins is at about ln 250 = 5.5 means
/// or 8 medians.
const MIN_PEAK_TO_MEDIAN: f64 = 20.0;
/// Maximum length of a section for one spectrum, px.
const MAX_SECTION_PX: usize = 512;
/// Maximum ratio of frequencies that count as one graduation: perspective changes the pitch over the picture.
const MAX_PITCH_RATIO: f64 = 1.08;
/// Minimum share of the strongest votes at which twice the frequency is the graduation.
const MIN_DOUBLE_FREQUENCY_SHARE: f64 = 0.3;
/// Minimum amplitude of a block of the scale, as a share of the strong blocks. Rows with only every second line have
/// half the amplitude.
pub(crate) const MIN_BLOCK_AMPLITUDE_SHARE: f64 = 0.3;
/// Minimum number of blocks of a scale.
const MIN_BLOCKS: usize = 6;
/// Maximum tilt of the lines, degrees; beyond it the rows of a strip blur its lines.
pub const MAX_TILT_DEG: f64 = 12.0;

/// Detected scale in a picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// Whether the scale runs from top to bottom, with the picture transposed.
    pub(crate) upright: bool,
    /// Graduations per pixel along the row (of the transposed picture if upright).
    pub(crate) frequency: f64,
    /// Bounding box of the scale in the measured picture.
    pub(crate) region: Region,
    /// Blocks of the whole picture.
    pub(crate) blocks: Blocks,
    /// Indices of the blocks of the scale, and the scale coordinate of each, graduations.
    pub(crate) scale: Vec<(usize, f64)>,
}

impl Found {
    /// Returns the blocks that belong to the scale.
    pub(crate) fn members(&self) -> impl Iterator<Item = &Block> {
        self.scale.iter().map(|(at, _)| &self.blocks.all[*at])
    }
}

/// Finds the scale in a picture or in a specified region; the error gives the reason if there is none.
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

/// Finds a scale along the rows; also returns its summed amplitude for the choice between two directions.
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

/// Returns the frequency at which most sections have their peak.
fn vote(strips: &Strips) -> Result<f64, String> {
    let width = strips.region.width;
    let length = MAX_SECTION_PX.min(1 << width.ilog2());
    // A large pitch needs long sections: averaging neighbouring pixels increases their length.
    let mut votes: Vec<(f64, f64)> = Vec::new();
    let mut shrink = 1;
    while length * shrink <= width.max(length) && shrink <= 8 {
        collect(strips, length, shrink, &mut votes);
        shrink *= 4;
    }
    let top = strongest(&votes).ok_or_else(|| {
        format!("no evenly spaced lines with a pitch of {MIN_PITCH_PX} to {MAX_PITCH_PX} px found")
    })?;
    let double = within(&votes, 2.0 * top.0);
    let chosen = if double.1 >= MIN_DOUBLE_FREQUENCY_SHARE * top.1 {
        double.0
    } else {
        top.0
    };
    Ok(chosen)
}

fn collect(strips: &Strips, length: usize, shrink: usize, votes: &mut Vec<(f64, f64)>) {
    let spectrum = Spectrum::new(length);
    // A section contains at least six graduations.
    let lowest = 6.max(length * shrink / MAX_PITCH_PX as usize);
    let highest = (length as f64 / 3.0).min((length * shrink) as f64 / MIN_PITCH_PX) as usize;
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
            if is_peak && contrast >= MIN_CONTRAST && power[peak] >= MIN_PEAK_TO_MEDIAN * median {
                let frequency = between_bins(&power, peak) / (length * shrink) as f64;
                votes.push((frequency, contrast * shrink as f64));
            }
        }
    }
    votes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
}

/// Returns the weighted median frequency and sum of the votes of the bracket with most votes; searches at most
/// `BRACKETS` positions.
fn strongest(votes: &[(f64, f64)]) -> Option<(f64, f64)> {
    const BRACKETS: usize = 1000;
    let every = votes.len().div_ceil(BRACKETS).max(1);
    let brackets = votes
        .iter()
        .step_by(every)
        .map(|vote| within(votes, vote.0));
    brackets.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the weighted median frequency and sum of the votes around a frequency.
fn within(votes: &[(f64, f64)], around: f64) -> (f64, f64) {
    let (low, high) = (
        around / MAX_PITCH_RATIO.sqrt(),
        around * MAX_PITCH_RATIO.sqrt(),
    );
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

/// Returns the largest connected set of blocks with consistent phases.
fn grow(blocks: &Blocks, frequency: f64) -> Option<Vec<(usize, f64)>> {
    // The scale may cover little of the picture: strong blocks are the strongest 2 %.
    let contrasts = blocks.all.iter().map(Block::contrast).collect();
    let strong = quantile(contrasts, 0.98)?;
    let least = (MIN_BLOCK_AMPLITUDE_SHARE * strong).max(MIN_CONTRAST);
    let bright: Vec<bool> = blocks.all.iter().map(|b| b.contrast() >= least).collect();
    let (across, down) = blocks.common_steps(&bright);
    // A step to the next window passes whole graduations.
    let hop = blocks.hop;
    let whole = (frequency * hop - across).round();
    let slopes = ((whole + across) / hop, down / STRIP_ROWS as f64);
    let step = |a: &Block, b: &Block| slopes.0 * (b.x - a.x) + slopes.1 * (b.y - a.y);
    let scale = blocks.unwrapped(&bright, step);
    (scale.len() >= MIN_BLOCKS).then_some(scale)
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
