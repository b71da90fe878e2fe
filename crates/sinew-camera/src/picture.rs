//! A frame as grey levels.

use std::borrow::Cow;

/// Widest and highest picture that is read, px. A 100-megapixel camera has 11,648 × 8,736.
pub const SIDE_LIMIT_PX: u32 = sinew_files::limits::PICTURE_SIDE.most as u32;

/// Grey levels, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    /// 0 black, 65535 white.
    levels: Vec<u16>,
}

/// A grey level of 16 bits over the same of 8.
pub(crate) const DEEPER: u16 = 257;

impl Picture {
    /// A picture of 8-bit grey levels.
    ///
    /// # Errors
    /// The numbers, when `levels` has not `width * height` values or a side is 0 or too long.
    pub fn from_luma8(width: usize, height: usize, levels: Vec<u8>) -> Result<Self, String> {
        let deeper = levels.into_iter().map(|level| DEEPER * u16::from(level));
        Self::from_luma16(width, height, deeper.collect())
    }

    /// A picture of 16-bit grey levels.
    ///
    /// # Errors
    /// As [`Picture::from_luma8`].
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

    /// Levels of a row, 0 black, 65535 white.
    pub(crate) fn row(&self, y: usize) -> &[u16] {
        &self.levels[y * self.width..][..self.width]
    }

    /// Grey level, 0 black to 1 white.
    pub fn level(&self, x: usize, y: usize) -> f64 {
        f64::from(self.row(y)[x]) / f64::from(u16::MAX)
    }

    /// The picture with its scale along the rows.
    pub(crate) fn lying(&self, upright: bool) -> Cow<'_, Self> {
        match upright {
            true => Cow::Owned(self.transposed()),
            false => Cow::Borrowed(self),
        }
    }

    /// Rows become columns: a scale that stands upright lies down. In tiles, so that both sides of
    /// the copy stay in the cache.
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

/// Refuses a side that is 0 or too long.
pub(crate) fn check_sides(width: usize, height: usize) -> Result<(), String> {
    let limit = SIDE_LIMIT_PX as usize;
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
    fn transposing_swaps_the_sides() {
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
    fn sizes_that_do_not_fit_are_refused() {
        let error = Picture::from_luma8(4, 3, vec![0; 11]).unwrap_err();
        assert!(error.contains("11 grey levels for 4 × 3"), "{error}");
        assert!(Picture::from_luma8(0, 3, vec![]).is_err());
    }
}
