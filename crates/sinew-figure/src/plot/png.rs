//! Rasterisation of SVG with an embedded font.

#[cfg(feature = "png")]
use resvg::{tiny_skia, usvg};
#[cfg(feature = "png")]
use std::sync::{Arc, OnceLock};

/// Error in rendering a PNG.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The size in pixels is zero or too large.
    #[error(
        "a figure cannot be rendered as PNG at {scale} pixels per px: {width} × {height} pixels (at most {} each)",
        MAX_SIZE_PX
    )]
    Size {
        /// Pixels per CSS px.
        scale: f64,
        /// Width of the image, pixels.
        width: f64,
        /// Height of the image, pixels.
        height: f64,
    },
    /// The SVG is invalid (internal error).
    #[error("invalid SVG of the figure: {0}")]
    Svg(String),
    /// The program was built without the feature `png`.
    #[error(
        "this build of sinew supports SVG figures only; use a file name ending in .svg, or build with PNG support: cargo build --release --features png"
    )]
    NotBuilt,
}

/// Pixel image on white, row-major from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Width of the image, pixels.
    pub width: usize,
    /// Height of the image, pixels.
    pub height: usize,
    /// Red, green, blue and 255 (opaque) of every pixel.
    pub rgba: Vec<u8>,
}

/// Maximum width and height, pixels: half a metre at 800 dpi, and 1 GiB of memory for a square image.
const MAX_SIZE_PX: f64 = 16_384.0;

#[cfg(feature = "png")]
fn fonts() -> Arc<usvg::fontdb::Database> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    FONTS
        .get_or_init(|| {
            let mut db = usvg::fontdb::Database::new();
            db.load_font_data(include_bytes!("fonts/Roboto-Regular-subset.ttf").to_vec());
            db.load_font_data(include_bytes!("fonts/Roboto-Medium-subset.ttf").to_vec());
            db.set_sans_serif_family("Roboto");
            Arc::new(db)
        })
        .clone()
}

#[cfg(feature = "png")]
fn pixmap(svg: &str, scale: f64) -> Result<tiny_skia::Pixmap, PngError> {
    let options = usvg::Options {
        font_family: "Roboto".to_string(),
        fontdb: fonts(),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| PngError::Svg(e.to_string()))?;
    let width = (f64::from(tree.size().width()) * scale).round();
    let height = (f64::from(tree.size().height()) * scale).round();
    let fits = |v: f64| (1.0..=MAX_SIZE_PX).contains(&v);
    let size_error = PngError::Size {
        scale,
        width,
        height,
    };
    if !(fits(width) && fits(height)) {
        return Err(size_error);
    }
    let Some(mut pixels) = tiny_skia::Pixmap::new(width as u32, height as u32) else {
        return Err(size_error);
    };
    pixels.fill(tiny_skia::Color::WHITE);
    let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    Ok(pixels)
}

/// Draws `svg` into a PNG file, `scale` pixels per CSS pixel.
#[cfg(feature = "png")]
pub(super) fn render(svg: &str, scale: f64) -> Result<Vec<u8>, PngError> {
    pixmap(svg, scale)?
        .encode_png()
        .map_err(|e| PngError::Svg(e.to_string()))
}

#[cfg(not(feature = "png"))]
pub(super) fn render(_svg: &str, _scale: f64) -> Result<Vec<u8>, PngError> {
    Err(PngError::NotBuilt)
}

/// Draws `svg`, `scale` pixels per CSS pixel.
///
/// # Errors
/// Returns [`PngError::Size`] or [`PngError::Svg`] if the image cannot be rendered, and [`PngError::NotBuilt`] without
/// the feature `png`.
#[cfg(feature = "png")]
pub fn pixels(svg: &str, scale: f64) -> Result<Pixels, PngError> {
    let drawn = pixmap(svg, scale)?;
    // On white every pixel is opaque, so that no colour is multiplied by its opacity.
    Ok(Pixels {
        width: drawn.width() as usize,
        height: drawn.height() as usize,
        rgba: drawn.take(),
    })
}

/// Draws `svg`, `scale` pixels per CSS pixel.
///
/// # Errors
/// Returns [`PngError::NotBuilt`], because this build lacks the feature `png`.
#[cfg(not(feature = "png"))]
pub fn pixels(_svg: &str, _scale: f64) -> Result<Pixels, PngError> {
    Err(PngError::NotBuilt)
}
