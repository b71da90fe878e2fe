//! Where in a picture the scale lies, which way it runs and how far apart its lines are.
//!
//! Spectra of short stretches of rows (and, with the picture turned, of columns) vote for a
//! frequency. The one with the most votes is the graduation, unless twice as high a frequency is
//! voted for as well: rows that hold only the longer lines vote for half the frequency, while the
//! lines themselves, being thin, never have more power in a harmonic than in their own frequency.
//! Neighbouring blocks whose phases follow each other at that frequency then make up the scale.

use super::picture::Picture;
use super::robust::median;
use super::spectrum::{Spectrum, between_bins};
use super::strips::{Blocks, Demodulator, Region, STRIP_ROWS, Strips};
use std::f64::consts::TAU;

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
/// Phases of neighbours that belong together differ from the common step by less, cycles. A window
/// moves on by four graduations: a quarter of a cycle is a pitch that differs by 6 %, which
/// perspective does; chance agrees in half of the cases, and not in six neighbours running.
const STEP_TOLERANCE: f64 = 0.25;
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
    /// Blocks that belong to it, in `Demodulator::blocks` order over the whole picture.
    pub(crate) blocks: Blocks,
    pub(crate) member: Vec<bool>,
}

/// Finds the scale in a picture or the part of it that is named; the error is why there is none.
pub(crate) fn find(
    picture: &Picture,
    within: Option<Region>,
    upright: Option<bool>,
) -> Result<Found, String> {
    let mut best: Option<(f64, Found)> = None;
    let mut reason = String::new();
    for turn in [false, true] {
        if upright.is_some_and(|wanted| wanted != turn) {
            continue;
        }
        let view = picture.lying(turn);
        let part = match within {
            Some(part) if turn => part.transposed(),
            Some(part) => part,
            None => Region::whole(&view),
        };
        match find_along(&view, part, turn) {
            Ok((weight, found)) if best.as_ref().is_none_or(|(w, _)| weight > *w) => {
                best = Some((weight, found));
            }
            Ok(_) => {}
            Err(why) if reason.is_empty() => reason = why,
            Err(_) => {}
        }
    }
    best.map(|(_, found)| found).ok_or(reason)
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
    let member = grow(&blocks).ok_or_else(|| {
        format!(
            "a pattern every {:.1} px, but no connected region of lines",
            1.0 / frequency
        )
    })?;
    let weight = blocks.members(&member).map(|b| b.contrast()).sum();
    let half = demodulator.length() as f64 / 2.0;
    let region = around(&blocks, &member, half, picture);
    Ok((
        weight,
        Found {
            upright,
            frequency,
            region,
            blocks,
            member,
        },
    ))
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
    let mut spectrum = Spectrum::new(length);
    // Six graduations in a stretch at least.
    let lowest = 6.max(length * shrink / PITCH_MOST_PX as usize);
    let highest = (length as f64 / 3.0).min((length * shrink) as f64 / PITCH_LEAST_PX) as usize;
    if highest <= lowest + 2 {
        return;
    }
    for i in 0..strips.count {
        let shrunk: Vec<f32>;
        let levels = if shrink == 1 {
            strips.strip(i)
        } else {
            shrunk = strips
                .strip(i)
                .chunks_exact(shrink)
                .map(|part| part.iter().sum::<f32>() / shrink as f32)
                .collect();
            &shrunk
        };
        let mut start = 0;
        while start + length <= levels.len() {
            let mean = spectrum.of(&levels[start..start + length]);
            start += length / 2;
            let power = &spectrum.power;
            let Some(peak) = (lowest..=highest).max_by(|a, b| power[*a].total_cmp(&power[*b]))
            else {
                continue;
            };
            let Some(median) = median(power[lowest..=highest].to_vec()) else {
                continue;
            };
            let contrast = power[peak].sqrt() / mean.max(0.5 / 255.0);
            let is_peak = power[peak] > power[peak - 1] && power[peak] > power[peak + 1];
            if !is_peak || contrast < CONTRAST_LEAST || power[peak] < PEAK_OVER_MEDIAN * median {
                continue;
            }
            let frequency = between_bins(power, peak) / (length * shrink) as f64;
            votes.push((frequency, contrast * shrink as f64));
        }
    }
    votes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
}

/// Weighted mean frequency and sum of the votes of the fullest bracket.
fn strongest(votes: &[(f64, f64)]) -> Option<(f64, f64)> {
    let (mut last, mut sum, mut best) = (0, 0.0, (0.0, 0));
    for (first, (low, _)) in votes.iter().enumerate() {
        while last < votes.len() && votes[last].0 <= low * SAME_PITCH {
            sum += votes[last].1;
            last += 1;
        }
        if sum > best.0 {
            best = (sum, first);
        }
        sum -= votes[first].1;
    }
    let low = votes.get(best.1)?.0;
    Some(within(votes, low * SAME_PITCH.sqrt()))
}

/// Weighted median frequency and sum of the votes around a frequency.
fn within(votes: &[(f64, f64)], around: f64) -> (f64, f64) {
    let (low, high) = (around / SAME_PITCH.sqrt(), around * SAME_PITCH.sqrt());
    let near = || votes.iter().filter(|(f, _)| *f >= low && *f <= high);
    let sum: f64 = near().map(|(_, w)| w).sum();
    let mut passed = 0.0;
    for (frequency, weight) in near() {
        passed += weight;
        if passed >= 0.5 * sum {
            return (*frequency, sum);
        }
    }
    (around, 0.0)
}

/// Largest connected set of blocks with lines whose phases follow each other.
fn grow(blocks: &Blocks) -> Option<Vec<bool>> {
    let mut contrasts: Vec<f64> = blocks.all.iter().map(|b| b.contrast()).collect();
    contrasts.sort_unstable_by(f64::total_cmp);
    // The scale may cover little of the picture: strong means the strongest fiftieth.
    let strong = *contrasts.get(contrasts.len() - 1 - contrasts.len() / 50)?;
    let least = (BLOCK_SHARE * strong).max(CONTRAST_LEAST);
    let bright: Vec<bool> = blocks.all.iter().map(|b| b.contrast() >= least).collect();
    let across = common_step(blocks, &bright, (0, 1));
    let down = common_step(blocks, &bright, (1, 0));
    let mut label = vec![usize::MAX; blocks.all.len()];
    let mut best: (f64, usize, usize) = (0.0, 0, 0);
    let mut queue = Vec::new();
    for seed in 0..blocks.all.len() {
        if !bright[seed] || label[seed] != usize::MAX {
            continue;
        }
        label[seed] = seed;
        queue.push(seed);
        let (mut weight, mut count) = (0.0, 0);
        while let Some(at) = queue.pop() {
            weight += blocks.all[at].contrast();
            count += 1;
            let (s, w) = (at / blocks.windows, at % blocks.windows);
            let mut visit = |to: usize, from: usize, step: f64| {
                if bright[to] && label[to] == usize::MAX {
                    let off = cycles(blocks.all[from].turn_to(&blocks.all[to])) - step;
                    if (off - off.round()).abs() < STEP_TOLERANCE {
                        label[to] = seed;
                        queue.push(to);
                    }
                }
            };
            if w + 1 < blocks.windows {
                visit(at + 1, at, across);
            }
            if w > 0 {
                visit(at - 1, at, -across);
            }
            if s + 1 < blocks.strips {
                visit(at + blocks.windows, at, down);
            }
            if s > 0 {
                visit(at - blocks.windows, at, -down);
            }
        }
        if weight > best.0 {
            best = (weight, seed, count);
        }
    }
    (best.2 >= BLOCKS_LEAST).then(|| label.iter().map(|l| *l == best.1).collect())
}

/// Angle of a phasor, cycles.
fn cycles((re, im): (f64, f64)) -> f64 {
    im.atan2(re) / TAU
}

/// Mean phase step between neighbours `(strips, windows)` apart, cycles.
fn common_step(blocks: &Blocks, used: &[bool], apart: (usize, usize)) -> f64 {
    let turns = blocks.pairs(used, apart).map(|(a, b)| a.turn_to(b));
    cycles(turns.fold((0.0, 0.0), |sum, turn| (sum.0 + turn.0, sum.1 + turn.1)))
}

fn around(blocks: &Blocks, member: &[bool], half: f64, picture: &Picture) -> Region {
    let (mut left, mut right) = (f64::MAX, f64::MIN);
    let (mut top, mut bottom) = (f64::MAX, f64::MIN);
    for block in blocks.members(member) {
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
