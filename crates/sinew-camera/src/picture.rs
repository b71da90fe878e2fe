//! Frame as an array of grey levels.

use sinew_files::Budget;
use std::borrow::Cow;

/// Grey levels, row-major from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Grey levels from 0 (black) to 65535 (white).
    levels: Vec<u16>,
}

/// Ratio of a 16-bit grey level to the equivalent 8-bit level.
pub(crate) const LEVEL_RATIO_16_TO_8: u16 = 257;

impl Picture {
    /// Creates a picture from 8-bit grey levels.
    ///
    /// # Errors
    /// Returns a message with the sizes if `levels` does not have `width * height` values, or if a side is 0 or too
    /// long.
    pub fn from_luma8(width: usize, height: usize, levels: Vec<u8>) -> Result<Self, String> {
        let deeper = levels
            .into_iter()
            .map(|level| LEVEL_RATIO_16_TO_8 * u16::from(level));
        Self::from_luma16(width, height, deeper.collect())
    }

    /// Creates a picture from 16-bit grey levels.
    ///
    /// # Errors
    /// Returns a message like [`Picture::from_luma8`].
    pub fn from_luma16(width: usize, height: usize, levels: Vec<u16>) -> Result<Self, String> {
        check_sides(width, height)?;
        if levels.len() != width * height {
            return Err(format!(
                "{} grey levels for {width} × {height} = {} px",
                levels.len(),
                width * height
            ));
        }
        Ok(Self {
            width,
            height,
            levels,
        })
    }

    /// Returns the number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the levels of a row, 0 (black) to 65535 (white).
    pub(crate) fn row(&self, y: usize) -> &[u16] {
        &self.levels[y * self.width..][..self.width]
    }

    /// Returns a grey level, 0 (black) to 1 (white).
    pub fn level(&self, x: usize, y: usize) -> f64 {
        f64::from(self.row(y)[x]) / f64::from(u16::MAX)
    }

    /// Returns the picture with its scale along the rows.
    pub(crate) fn lying(&self, upright: bool) -> Cow<'_, Self> {
        match upright {
            true => Cow::Owned(self.transposed()),
            false => Cow::Borrowed(self),
        }
    }

    /// Transposes the picture, so that an upright scale lies along the rows. Works in tiles, so that both sides of the
    /// copy stay in the cache.
    fn transposed(&self) -> Self {
        const TILE: usize = 32;
        let (width, height) = (self.width, self.height);
        let mut levels = vec![0; self.levels.len()];
        for top in (0..height).step_by(TILE) {
            for left in (0..width).step_by(TILE) {
                for y in top..(top + TILE).min(height) {
                    for x in left..(left + TILE).min(width) {
                        levels[x * height + y] = self.levels[y * width + x];
                    }
                }
            }
        }
        Self {
            width: height,
            height: width,
            levels,
        }
    }
}

/// Rejects a side that is 0 or too long.
pub(crate) fn check_sides(width: usize, height: usize) -> Result<(), String> {
    let limit = Budget::PICTURE.columns.length();
    if width == 0 || height == 0 || width > limit || height > limit {
        return Err(format!(
            "{width} × {height} px; each side must be 1 to {limit} px"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transpose_swaps_width_and_height() {
        let levels: Vec<u16> = (0..70 * 41).collect();
        let picture = Picture::from_luma16(70, 41, levels).unwrap();
        let turned = picture.transposed();
        assert_eq!((turned.width(), turned.height()), (41, 70));
        for (x, y) in [(0, 0), (69, 40), (3, 38), (64, 33)] {
            assert_eq!(turned.level(y, x), picture.level(x, y));
        }
        assert_eq!(turned.transposed(), picture);
    }

    #[test]
    fn picture_size_mismatch_returns_error() {
        let error = Picture::from_luma8(4, 3, vec![0; 11]).unwrap_err();
        assert!(error.contains("11 grey levels for 4 × 3"), "{error}");
        assert!(Picture::from_luma8(0, 3, vec![]).is_err());
    }
}
