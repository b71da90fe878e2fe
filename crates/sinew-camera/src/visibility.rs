//! What of the scale a frame shows: which rows, how strong, what is occluded.

use super::marks::{self, BEYOND};
use super::phase::Shift;
use super::phase_map::PhaseMap;
use super::robust::quantile;
use super::strips::{Blocks, Region, STRIP_ROWS};

/// What a frame's measurement saw, for drawing.
#[derive(Debug, Clone)]
pub(crate) struct View {
    pub(crate) upright: bool,
    pub(crate) blocks: Blocks,
    pub(crate) lined: Vec<bool>,
    pub(crate) shift: Shift,
    pub(crate) map: PhaseMap,
    pub(crate) window: Region,
    pub(crate) window_px: usize,
}

/// The scale with room to wander across, all along.
pub(super) fn search_window(region: Region, whole: Region) -> Region {
    let margin = ((region.height as f64 * BEYOND) as usize).max(3 * STRIP_ROWS);
    let y = region.y.saturating_sub(margin).max(whole.y);
    Region {
        x: whole.x,
        y,
        width: whole.width,
        height: (region.y + region.height + margin).min(whole.y + whole.height) - y,
    }
}

/// Rows of the lines with a little room to wander across.
pub(super) fn line_rows(region: Region) -> (f64, f64) {
    let margin = (region.height as f64 / 8.0).max(STRIP_ROWS as f64);
    let top = region.y as f64;
    (top - margin, top + region.height as f64 + margin)
}

/// Contrast of the reference frame's strong blocks: those within the scale's box.
pub(super) fn scale_contrast(blocks: &Blocks, region: Region) -> f64 {
    let inside = |x: f64, y: f64| {
        x >= region.x as f64
            && x <= (region.x + region.width) as f64
            && y >= region.y as f64
            && y <= (region.y + region.height) as f64
    };
    let contrasts: Vec<f64> = blocks
        .all
        .iter()
        .filter(|b| inside(b.x, b.y))
        .map(|b| b.contrast())
        .collect();
    quantile(contrasts, 0.8).unwrap_or(0.0)
}

/// Contrast that a fifth of as many blocks as the scale has exceed.
pub(super) fn line_contrast(blocks: &Blocks, members: usize, rows: (f64, f64)) -> f64 {
    let contrasts: Vec<f64> = blocks
        .all
        .iter()
        .filter(|b| b.y >= rows.0 && b.y <= rows.1)
        .map(|b| b.contrast())
        .collect();
    let share = 0.2 * members as f64 / contrasts.len().max(1) as f64;
    quantile(contrasts, 1.0 - share).unwrap_or(0.0)
}

/// Whether the scale is occluded at a column: in a window that reaches there fewer than two thirds
/// of the usual number of strips agree.
pub(super) fn occlusion(
    blocks: &Blocks,
    agree: &[bool],
    window_px: usize,
) -> impl Fn(f64) -> bool + use<> {
    let count: Vec<usize> = (0..blocks.windows)
        .map(|w| {
            (0..blocks.strips)
                .filter(|s| agree[s * blocks.windows + w])
                .count()
        })
        .collect();
    let mut sorted: Vec<usize> = count.iter().copied().filter(|c| *c > 0).collect();
    sorted.sort_unstable();
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(usize::MAX);
    let reach = window_px as f64 / 2.0;
    let middle: Vec<f64> = (0..blocks.windows).map(|w| blocks.all[w].x).collect();
    let ends = (
        middle.first().copied().unwrap_or(0.0),
        middle.last().copied().unwrap_or(0.0),
    );
    move |x| {
        // Beyond the last window's middle there is only that one.
        let x = x.clamp(ends.0, ends.1);
        middle
            .iter()
            .zip(&count)
            .filter(|(m, _)| (*m - x).abs() < 1.25 * reach)
            .any(|(_, count)| 3 * count < 2 * usual)
    }
}

/// Lines between the outermost blocks that agree.
pub(super) fn visible_lines(map: &PhaseMap, shift: &Shift, blocks: &Blocks) -> usize {
    let (mut left, mut right) = (f64::MAX, f64::MIN);
    for block in blocks.members(&shift.agree) {
        left = left.min(block.x);
        right = right.max(block.x);
    }
    if left > right {
        return 0;
    }
    marks::places(map, shift, left, right).len()
}
