//! Visible part of the scale in a frame: rows, contrast and occlusion.

use super::marks::{self, BAND_MARGIN_SHARE};
use super::phase::Shift;
use super::phase_map::PhaseMap;
use super::robust::{median, quantile};
use super::strips::{Blocks, Region, STRIP_ROWS};

/// Details of the measurement of a frame, for the overlay.
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
    /// Number of consistent blocks.
    pub(super) fn agreeing(&self) -> usize {
        self.shift.agree.iter().filter(|agrees| **agrees).count()
    }
}

/// Returns the region of the scale with a lateral margin, over the whole length.
pub(super) fn search_window(region: Region, whole: Region) -> Region {
    let margin = ((region.height as f64 * BAND_MARGIN_SHARE) as usize).max(3 * STRIP_ROWS);
    let y = region.y.saturating_sub(margin).max(whole.y);
    Region {
        x: whole.x,
        y,
        width: whole.width,
        height: (region.y + region.height + margin).min(whole.y + whole.height) - y,
    }
}

/// Returns the rows of the lines with a small lateral margin.
pub(super) fn line_rows(region: Region) -> (f64, f64) {
    let margin = (region.height as f64 / 8.0).max(STRIP_ROWS as f64);
    let top = region.y as f64;
    (top - margin, top + region.height as f64 + margin)
}

/// Returns the contrast exceeded by 20 % of the number of blocks of the scale.
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

/// Whether the scale is occluded at a column: in a window that contains it, fewer than two thirds of the usual number
/// of strips are consistent.
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
        // Beyond the middle of the last window there is only that one.
        let x = x.clamp(ends.0, ends.1);
        let mut near = windows
            .iter()
            .filter(|(middle, _)| (middle - x).abs() < reach);
        near.any(|(_, count)| 3.0 * count < 2.0 * usual)
    }
}

/// Returns the number of lines between the outermost consistent blocks.
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
