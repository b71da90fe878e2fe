//! What of the scale a frame shows: which rows, how strong, what is occluded.

use super::marks::{self, BEYOND};
use super::phase::Shift;
use super::phase_map::PhaseMap;
use super::robust::{median, quantile};
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

impl View {
    /// Number of blocks that agree.
    pub(super) fn agreeing(&self) -> usize {
        self.shift.agree.iter().filter(|agrees| **agrees).count()
    }
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
    let agrees = |at: &usize| agree[*at];
    let column = |w: usize| (w..agree.len()).step_by(blocks.windows);
    let counts = (0..blocks.windows).map(|w| column(w).filter(agrees).count() as f64);
    let windows: Vec<(f64, f64)> = counts
        .enumerate()
        .map(|(w, n)| (blocks.all[w].x, n))
        .collect();
    let counts = windows.iter().map(|(_, count)| *count);
    let usual = median(counts.filter(|count| *count > 0.0).collect()).unwrap_or(f64::MAX);
    let end = |window: Option<&(f64, f64)>| window.map_or(0.0, |(middle, _)| *middle);
    let ends = (end(windows.first()), end(windows.last()));
    let reach = 1.25 * window_px as f64 / 2.0;
    move |x| {
        // Beyond the last window's middle there is only that one.
        let x = x.clamp(ends.0, ends.1);
        let mut near = windows
            .iter()
            .filter(|(middle, _)| (middle - x).abs() < reach);
        near.any(|(_, count)| 3.0 * count < 2.0 * usual)
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
