//! Where in a picture the scale lies, which way it runs and how far apart its lines are.
//!
//! Spectra of short stretches of rows (and, with the picture turned, of columns) vote for a
//! frequency. The one with the most votes is the graduation, unless twice as high a frequency is
//! voted for as well: rows that hold only the longer lines vote for half the frequency, while the
//! lines themselves, being thin, never have more power in a harmonic than in their own frequency.
//! Neighbouring blocks whose phases follow each other at that frequency then make up the scale.

use super::picture::Picture;
use super::spectrum::{Spectrum, between_bins};
use super::strips::{Blocks, Demodulator, Region, Strips};
use std::f64::consts::TAU;

/// Fewest pixels from line to line: with fewer the second harmonic, which tells thin lines from a
/// chance pattern, is gone.
pub const PITCH_LEAST_PX: f64 = 4.0;
/// Most pixels from line to line.
pub const PITCH_MOST_PX: f64 = 250.0;
/// Rows of a strip.
pub(crate) const STRIP_ROWS: usize = 8;
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

/// Why there is no scale; words for a message.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NotFound(pub(crate) String);

/// Finds the scale in a picture or the part of it that is named.
pub(crate) fn find(
    picture: &Picture,
    within: Option<Region>,
    upright: Option<bool>,
) -> Result<Found, NotFound> {
    let mut best: Option<(f64, Found)> = None;
    let mut reason = String::new();
    for turn in [false, true] {
        if upright.is_some_and(|wanted| wanted != turn) {
            continue;
        }
        let turned;
        let (view, part) = if turn {
            turned = picture.transposed();
            (&turned, within.map(Region::transposed))
        } else {
            (picture, within)
        };
        let part = part.unwrap_or_else(|| Region::whole(view));
        match find_along(view, part, turn) {
            Ok((weight, found)) if best.as_ref().is_none_or(|(w, _)| weight > *w) => {
                best = Some((weight, found));
            }
            Ok(_) => {}
            Err(why) if reason.is_empty() => reason = why,
            Err(_) => {}
        }
    }
    best.map(|(_, found)| found).ok_or(NotFound(reason))
}

/// Finds a scale along the rows; also its summed amplitude, to choose between two directions.
fn find_along(picture: &Picture, part: Region, upright: bool) -> Result<(f64, Found), String> {
    if part.height < STRIP_ROWS || part.width < 32 {
        return Err(format!(
            "{} × {} px is too small for a scale",
            part.width, part.height
        ));
    }
    let strips = Strips::of(picture, part, STRIP_ROWS);
    let frequency = vote(&strips)?;
    let blocks = Demodulator::new(frequency, part.width).blocks(&strips);
    let member = grow(&blocks).ok_or_else(|| {
        format!(
            "a pattern every {:.1} px, but no connected region of lines",
            1.0 / frequency
        )
    })?;
    let weight = blocks
        .all
        .iter()
        .zip(&member)
        .filter(|(_, member)| **member)
        .map(|(block, _)| block.contrast())
        .sum();
    let half = Demodulator::new(frequency, part.width).length() as f64 / 2.0;
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
    let length = if width >= STRETCH_PX {
        STRETCH_PX
    } else {
        1 << (usize::BITS - 1 - width.leading_zeros())
    };
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
            let mut sorted = power[lowest..=highest].to_vec();
            sorted.sort_unstable_by(f64::total_cmp);
            let median = sorted[sorted.len() / 2];
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
    let across = common_step(blocks, &bright, 0, 1);
    let down = common_step(blocks, &bright, 1, 0);
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
                    let off = turn(blocks, from, to) - step;
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

/// Phase from one block to another, cycles.
pub(crate) fn turn(blocks: &Blocks, from: usize, to: usize) -> f64 {
    let (a, b) = (&blocks.all[from], &blocks.all[to]);
    (b.im * a.re - b.re * a.im).atan2(b.re * a.re + b.im * a.im) / TAU
}

/// Mean phase step between neighbours `(strips, windows)` apart, cycles.
fn common_step(blocks: &Blocks, used: &[bool], strips: usize, windows: usize) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for s in 0..blocks.strips.saturating_sub(strips) {
        for w in 0..blocks.windows.saturating_sub(windows) {
            let from = s * blocks.windows + w;
            let to = (s + strips) * blocks.windows + w + windows;
            if used[from] && used[to] {
                let (a, b) = (&blocks.all[from], &blocks.all[to]);
                re += b.re * a.re + b.im * a.im;
                im += b.im * a.re - b.re * a.im;
            }
        }
    }
    im.atan2(re) / TAU
}

fn around(blocks: &Blocks, member: &[bool], half: f64, picture: &Picture) -> Region {
    let (mut left, mut right) = (f64::MAX, f64::MIN);
    let (mut top, mut bottom) = (f64::MAX, f64::MIN);
    for (block, _) in blocks.all.iter().zip(member).filter(|(_, m)| **m) {
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
