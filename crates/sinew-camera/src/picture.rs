//! A frame as grey levels.

use std::borrow::Cow;

/// Widest and highest picture that is read, px. A 100-megapixel camera has 11,648 × 8,736.
pub const SIDE_LIMIT_PX: u32 = sinew_files::limits::PICTURE_SIDE.most as u32;

/// Grey levels, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    levels: Levels,
}

/// Grey levels in the depth they were recorded with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Levels {
    /// 0 black, 255 white.
    Eight(Vec<u8>),
    /// 0 black, 65535 white.
    Sixteen(Vec<u16>),
}

impl Picture {
    /// A picture of 8-bit grey levels.
    ///
    /// # Errors
    /// The numbers, when `levels` has not `width * height` values or a side is 0 or too long.
    pub fn from_luma8(width: usize, height: usize, levels: Vec<u8>) -> Result<Self, String> {
        check(width, height, levels.len())?;
        Ok(Self {
            width,
            height,
            levels: Levels::Eight(levels),
        })
    }

    /// A picture of 16-bit grey levels.
    ///
    /// # Errors
    /// As [`Picture::from_luma8`].
    pub fn from_luma16(width: usize, height: usize, levels: Vec<u16>) -> Result<Self, String> {
        check(width, height, levels.len())?;
        Ok(Self {
            width,
            height,
            levels: Levels::Sixteen(levels),
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

    pub(crate) fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Grey level, 0 black to 1 white.
    pub fn level(&self, x: usize, y: usize) -> f64 {
        let i = y * self.width + x;
        match &self.levels {
            Levels::Eight(v) => f64::from(v[i]) / 255.0,
            Levels::Sixteen(v) => f64::from(v[i]) / 65_535.0,
        }
    }

    /// The picture with its scale along the rows.
    pub(crate) fn lying(&self, upright: bool) -> Cow<'_, Self> {
        match upright {
            true => Cow::Owned(self.transposed()),
            false => Cow::Borrowed(self),
        }
    }

    /// Rows become columns: a scale that stands upright lies down.
    fn transposed(&self) -> Self {
        let levels = match &self.levels {
            Levels::Eight(v) => Levels::Eight(transpose(v, self.width, self.height)),
            Levels::Sixteen(v) => Levels::Sixteen(transpose(v, self.width, self.height)),
        };
        Self {
            width: self.height,
            height: self.width,
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

fn check(width: usize, height: usize, count: usize) -> Result<(), String> {
    check_sides(width, height)?;
    if count != width * height {
        return Err(format!(
            "{count} grey levels for {width} × {height} = {} px",
            width * height
        ));
    }
    Ok(())
}

/// Transposes in tiles, so that both sides of the copy stay in the cache.
fn transpose<T: Copy + Default>(from: &[T], width: usize, height: usize) -> Vec<T> {
    const TILE: usize = 32;
    let mut to = vec![T::default(); from.len()];
    for top in (0..height).step_by(TILE) {
        for left in (0..width).step_by(TILE) {
            for y in top..(top + TILE).min(height) {
                for x in left..(left + TILE).min(width) {
                    to[x * height + y] = from[y * width + x];
                }
            }
        }
    }
    to
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
