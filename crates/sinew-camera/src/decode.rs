//! Decoding of PNG and JPEG into grey levels.

use super::picture::{LEVEL_RATIO_16_TO_8, Picture, check_sides};
use sinew_files::Budget;
use std::io::Cursor;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG_SIGNATURE: &[u8] = &[0xff, 0xd8, 0xff];

/// Weights of red, green and blue in the luminance of sRGB: row Y of the matrix from its primaries (ITU-R BT.709) and
/// white point (D65) to XYZ.
const LUMINANCE: [f32; 3] = [0.212_647_84, 0.715_179_2, 0.072_173_04];

/// Decodes PNG or JPEG independent of the file extension. Colour is converted to luminance; 16 bits are kept; an alpha
/// channel is ignored.
///
/// # Errors
/// Returns the message of the decoder, or the size if it exceeds [`Budget::PICTURE`].
pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
    if bytes.starts_with(PNG_SIGNATURE) {
        png(bytes)
    } else if bytes.starts_with(JPEG_SIGNATURE) {
        jpeg(bytes)
    } else {
        Err("unsupported format: expected PNG or JPEG".into())
    }
}

fn png(bytes: &[u8]) -> Result<Picture, String> {
    let limits = png::Limits {
        bytes: Budget::PICTURE.unpacked.length(),
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let header = decoder.read_header_info().map_err(|e| e.to_string())?;
    let (width, height) = (header.width as usize, header.height as usize);
    check_sides(width, height)?;
    // Palettes are converted to colours, and fewer than 8 bits to 8.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let mut samples = buffer(reader.output_buffer_size())?;
    reader.next_frame(&mut samples).map_err(|e| e.to_string())?;
    let (colour, depth) = reader.output_color_type();
    let levels = if depth == png::BitDepth::Sixteen {
        let (pairs, _) = samples.as_chunks::<2>();
        let deep = pairs.iter().map(|&pair| u16::from_be_bytes(pair));
        luminance(deep, colour.samples())
    } else {
        luminance(samples.into_iter().map(deeper), colour.samples())
    };
    Picture::from_luma16(width, height, levels)
}

fn jpeg(bytes: &[u8]) -> Result<Picture, String> {
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let no_header = || "missing image header".to_string();
    let (width, height) = decoder.dimensions().ok_or_else(no_header)?;
    check_sides(width, height)?;
    let space = match decoder.input_colorspace().ok_or_else(no_header)? {
        ColorSpace::Luma => ColorSpace::Luma,
        ColorSpace::LumaA => ColorSpace::LumaA,
        _ => ColorSpace::RGB,
    };
    decoder.set_options(options.jpeg_set_out_colorspace(space));
    let mut samples = buffer(Some(width * height * space.num_components()))?;
    decoder
        .decode_into(&mut samples)
        .map_err(|e| e.to_string())?;
    let levels = luminance(samples.into_iter().map(deeper), space.num_components());
    Picture::from_luma16(width, height, levels)
}

fn buffer(size_bytes: Option<usize>) -> Result<Vec<u8>, String> {
    let limit = Budget::PICTURE.unpacked.length();
    match size_bytes {
        Some(size) if size <= limit => Ok(vec![0; size]),
        _ => Err(format!(
            "image requires more than {} MiB of memory",
            limit >> 20
        )),
    }
}

fn deeper(level: u8) -> u16 {
    LEVEL_RATIO_16_TO_8 * u16::from(level)
}

/// Returns one level per pixel: the first of one or two channels, the luminance of three or four.
fn luminance(mut samples: impl Iterator<Item = u16>, channels: usize) -> Vec<u16> {
    if channels < 3 {
        return samples.step_by(channels).collect();
    }
    let pixel = || {
        let mut luma = 0.0;
        for weight in LUMINANCE {
            luma += f32::from(samples.next()?) * weight;
        }
        samples
            .by_ref()
            .take(channels - LUMINANCE.len())
            .for_each(drop);
        Some(luma.round() as u16)
    };
    std::iter::from_fn(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decode_grey_kept_colour_weighted_as_srgb() {
        let grey = (0..=255).flat_map(|v| [deeper(v); 3]);
        let levels = luminance(grey, 3);
        assert_eq!(levels, (0..=255).map(deeper).collect::<Vec<u16>>());
        // 65535 · 0.2126, 65535 · 0.7152, 65535 · 0.0722; opacity is ignored.
        let pure = [255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 255, 9];
        let levels = luminance(pure.into_iter().map(deeper), 4);
        assert_eq!(levels, [13_936, 46_869, 4_730]);
        let deep = [65_535, 0, 0, 0, 65_535, 0];
        assert_eq!(luminance(deep.into_iter(), 3), [13_936, 46_869]);
        assert_eq!(luminance([7, 1, 8, 2].into_iter(), 2), [7, 8]);
    }

    #[test]
    fn decode_other_format_returns_error() {
        let error = decode(b"GIF89a").unwrap_err();
        assert_eq!(error, "unsupported format: expected PNG or JPEG");
        assert!(decode(PNG_SIGNATURE).is_err());
        assert!(decode(JPEG_SIGNATURE).is_err());
    }
}
