//! PNG and JPEG bytes to grey levels.

use super::picture::{Picture, check_sides};
use std::io::Cursor;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most memory a decoder may take for one frame, bytes.
const MEMORY_LIMIT_BYTES: usize = sinew_files::limits::PICTURE_MEMORY.length();
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG_SIGNATURE: &[u8] = &[0xff, 0xd8, 0xff];

/// Share of red, green and blue in the luminance of sRGB: the row Y of the matrix from its
/// primaries (ITU-R BT.709) and white point (D65) to XYZ.
const LUMINANCE: [f32; 3] = [0.212_647_84, 0.715_179_2, 0.072_173_04];

/// Decodes PNG or JPEG, whatever the file is called. Colour becomes luminance; 16 bits stay 16; an
/// alpha channel is ignored.
///
/// # Errors
/// What the decoder says, or the size where it is beyond [`crate::SIDE_LIMIT_PX`].
pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
    if bytes.starts_with(PNG_SIGNATURE) {
        png(bytes)
    } else if bytes.starts_with(JPEG_SIGNATURE) {
        jpeg(bytes)
    } else {
        Err("it is neither PNG nor JPEG".into())
    }
}

fn png(bytes: &[u8]) -> Result<Picture, String> {
    let limits = png::Limits {
        bytes: MEMORY_LIMIT_BYTES,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let header = decoder.read_header_info().map_err(|e| e.to_string())?;
    let (width, height) = (header.width as usize, header.height as usize);
    check_sides(width, height)?;
    // Palettes become colours and fewer than 8 bits become 8.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let mut samples = buffer(reader.output_buffer_size())?;
    reader.next_frame(&mut samples).map_err(|e| e.to_string())?;
    let (colour, depth) = reader.output_color_type();
    let channels = colour.samples();
    if depth == png::BitDepth::Sixteen {
        let (pairs, _) = samples.as_chunks::<2>();
        let samples: Vec<u16> = pairs.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
        let levels = luminance(samples, channels, u16::MAX.into(), |v| v as u16);
        return Picture::from_luma16(width, height, levels);
    }
    let levels = luminance(samples, channels, u8::MAX.into(), |v| v as u8);
    Picture::from_luma8(width, height, levels)
}

fn jpeg(bytes: &[u8]) -> Result<Picture, String> {
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let no_header = || "it has no header".to_string();
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
    let levels = luminance(samples, space.num_components(), u8::MAX.into(), |v| v as u8);
    Picture::from_luma8(width, height, levels)
}

fn buffer(size_bytes: Option<usize>) -> Result<Vec<u8>, String> {
    match size_bytes {
        Some(size) if size <= MEMORY_LIMIT_BYTES => Ok(vec![0; size]),
        _ => Err(format!(
            "it takes more than {} MiB of memory",
            MEMORY_LIMIT_BYTES >> 20
        )),
    }
}

/// One level per pixel: the first channel of one or two, the luminance of three or four.
///
/// `white` is the level of white. The sum is formed in single precision of 0 to 1.
fn luminance<T: Copy + Into<f32>>(
    samples: Vec<T>,
    channels: usize,
    white: f32,
    level: impl Fn(f32) -> T,
) -> Vec<T> {
    let share = 1.0 / white;
    match channels {
        1 => samples,
        2 => samples.chunks_exact(2).map(|pixel| pixel[0]).collect(),
        _ => samples
            .chunks_exact(channels)
            .map(|pixel| {
                let mut luma = 0.0;
                for (&sample, weight) in pixel.iter().zip(LUMINANCE) {
                    luma += sample.into() * share * weight;
                }
                level((luma * white).round())
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_stays_and_colours_weigh_as_in_srgb() {
        let grey: Vec<u8> = (0..=255).flat_map(|v| [v, v, v]).collect();
        let levels = luminance(grey, 3, 255.0, |v| v as u8);
        assert_eq!(levels, (0..=255).collect::<Vec<u8>>());
        // 255 · 0.2126, 255 · 0.7152, 255 · 0.0722; opacity has no part in it.
        let pure = vec![255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 255, 9];
        assert_eq!(luminance(pure, 4, 255.0, |v| v as u8), [54, 182, 18]);
        let deep = vec![65_535_u16, 0, 0, 0, 65_535, 0];
        assert_eq!(luminance(deep, 3, 65_535.0, |v| v as u16), [13_936, 46_869]);
        assert_eq!(
            luminance(vec![7_u8, 1, 8, 2], 2, 255.0, |v| v as u8),
            [7, 8]
        );
    }

    #[test]
    fn other_files_are_refused() {
        let error = decode(b"GIF89a").unwrap_err();
        assert_eq!(error, "it is neither PNG nor JPEG");
        assert!(decode(PNG_SIGNATURE).is_err());
        assert!(decode(JPEG_SIGNATURE).is_err());
    }
}
