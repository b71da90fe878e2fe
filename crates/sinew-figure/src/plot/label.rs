//! Text of figures: width estimation and SVG markup.

use std::fmt::Write as _;

/// Advance widths of Roboto Regular for U+0020 to U+007E, in hundredths of an em.
///
/// The other font families named in the SVG (Helvetica, Arial, Liberation Sans) differ by a few per cent; [`width`]
/// adds this margin.
const ADVANCE: [u8; 95] = [
    25, 26, 32, 62, 56, 73, 62, 17, 34, 35, 43, 57, 20, 28, 26, 41, 56, 56, 56, 56, 56, 56, 56, 56,
    56, 56, 24, 21, 51, 55, 52, 47, 90, 65, 62, 65, 66, 57, 55, 68, 71, 27, 55, 63, 54, 87, 71, 69,
    63, 69, 62, 59, 60, 65, 64, 89, 63, 60, 60, 27, 41, 27, 42, 45, 31, 54, 56, 52, 56, 53, 35, 56,
    55, 24, 24, 51, 24, 88, 55, 57, 56, 57, 34, 52, 33, 55, 48, 75, 50, 47, 50, 34, 24, 34, 68,
];

/// Font size of a subscript relative to its line.
const SUBSCRIPT: f64 = 0.75;
/// Shift of a subscript below its line, relative to the font size of the line.
const SHIFT: f64 = 0.25;

/// Returns the estimated width of a text, px; an upper bound rather than a mean.
pub(super) fn width(text: &str, size_px: f64) -> f64 {
    let mut em = 0.0;
    for (piece, subscript) in pieces(text) {
        let scale = if subscript { SUBSCRIPT } else { 1.0 };
        for c in piece.chars() {
            let hundredths = match c {
                ' '..='~' => ADVANCE[c as usize - 0x20],
                '·' | '’' | '‘' => 26,
                '°' | '¹' | '²' | '³' | '⁻' => 38,
                c if (c as u32) < 0x0500 => 60,
                // Chinese, Japanese, Korean, symbols
                c if (0x2000..0x2300).contains(&(c as u32)) => 60,
                _ => 100,
            };
            em += scale * f64::from(hundredths) / 100.0;
        }
    }
    1.05 * em * size_px
}

/// Splits `τ_{el}` into plain and subscript pieces.
fn pieces(text: &str) -> impl Iterator<Item = (&str, bool)> {
    let mut rest = text;
    let mut pending: Option<&str> = None;
    std::iter::from_fn(move || {
        if let Some(sub) = pending.take() {
            return Some((sub, true));
        }
        if rest.is_empty() {
            return None;
        }
        if let Some(start) = rest.find("_{")
            && let Some(length) = rest[start..].find('}')
        {
            let plain = &rest[..start];
            pending = Some(&rest[start + 2..start + length]);
            rest = &rest[start + length + 1..];
            return Some((plain, false));
        }
        Some((std::mem::take(&mut rest), false))
    })
}

/// Returns the text without subscript braces.
pub(super) fn plain(text: &str) -> String {
    pieces(text).map(|(piece, _)| piece).collect()
}

/// Returns the text as content of an SVG `text` element of a font size.
///
/// Shifts and sizes of subscripts are numbers in user units: some SVG readers ignore `em`, `%` and `baseline-shift`.
pub(super) fn markup(text: &str, size_px: f64) -> String {
    let mut out = String::with_capacity(text.len());
    let mut lowered = false;
    for (piece, subscript) in pieces(text) {
        if piece.is_empty() {
            continue;
        }
        let words = escape_xml(piece);
        let shift = SHIFT * size_px;
        let _ = match (subscript, lowered) {
            (true, false) => write!(
                out,
                "<tspan dy=\"{shift}\" font-size=\"{}\">{words}</tspan>",
                SUBSCRIPT * size_px
            ),
            (true, true) => write!(
                out,
                "<tspan font-size=\"{}\">{words}</tspan>",
                SUBSCRIPT * size_px
            ),
            (false, true) => write!(out, "<tspan dy=\"{}\">{words}</tspan>", -shift),
            (false, false) => {
                out.push_str(&words);
                Ok(())
            }
        };
        lowered = subscript;
    }
    out
}

/// Escapes a text for XML and HTML, as content and in quoted attributes.
///
/// Control characters, which XML does not permit, become U+FFFD; line ends become spaces.
pub fn escape_xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Wraps a text at spaces into lines of at most `room_px`.
pub(super) fn wrap(text: &str, size_px: f64, room_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size_px) <= room_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

/// Truncates a text to `room_px` with an ellipsis; `None` if too little remains.
pub(super) fn shorten(text: &str, size_px: f64, room_px: f64) -> Option<String> {
    if width(text, size_px) <= room_px {
        return Some(text.to_string());
    }
    let mut plain: Vec<char> = pieces(text).flat_map(|(p, _)| p.chars()).collect();
    while plain.len() > 3 {
        plain.pop();
        let cut: String = plain.iter().collect::<String>().trim_end().to_string() + "…";
        if width(&cut, size_px) <= room_px {
            return Some(cut);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_go_down_and_come_back() {
        // 12 px: a quarter down and up again, at three quarters of the size, as plain numbers.
        assert_eq!(
            markup("τ_{el} and <θ>", 12.0),
            "τ<tspan dy=\"3\" font-size=\"9\">el</tspan><tspan dy=\"-3\"> and &lt;θ&gt;</tspan>"
        );
        // Two subscripts in sequence are on the same line.
        let twice = markup("K_{I}_{el} K", 20.0);
        let shifts = twice.split(" dy=\"").skip(1);
        let shifts: Vec<f64> = shifts
            .map(|s| {
                s.split('"')
                    .next()
                    .unwrap_or_default()
                    .parse()
                    .expect("a number")
            })
            .collect();
        assert_eq!(shifts, [5.0, -5.0], "{twice}");
        assert_eq!(markup("broken _{ brace", 12.0), "broken _{ brace");
    }

    #[test]
    fn escape_xml_replaces_control_characters() {
        assert_eq!(
            escape_xml("a\u{0}\u{7}b\nc\"'"),
            "a\u{fffd}\u{fffd}b c&quot;&#39;"
        );
    }

    #[test]
    fn long_words_are_cut_and_long_texts_wrapped() {
        assert!(wrap("one two three four", 10.0, 50.0).len() > 1);
        assert!(shorten("left_shoulder_pitch_joint", 10.0, 60.0).is_some_and(|t| t.ends_with('…')));
        assert_eq!(shorten("elbow", 10.0, 1.0), None);
    }
}
