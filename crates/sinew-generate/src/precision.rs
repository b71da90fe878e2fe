//! The same code in single precision: types, functions and numbers by name.

use crate::{Language, Precision};

impl Precision {
    /// The type of a number.
    fn real(self, language: Language) -> &'static str {
        match (self, language) {
            (Self::Double, Language::C) => "double",
            (Self::Single, Language::C) => "float",
            (Self::Double, Language::Rust) => "f64",
            (Self::Single, Language::Rust) => "f32",
        }
    }

    /// Name in running text.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Double => "double",
            Self::Single => "single",
        }
    }

    /// Sums of inputs from here on are no robot's.
    pub(crate) const fn largest(self) -> &'static str {
        match self {
            Self::Double => "1e60",
            Self::Single => "1e30",
        }
    }
}

/// Functions and constants with another name in single precision.
const FUNCTIONS: [&str; 7] = ["sin", "cos", "fabs", "exp", "expm1", "fmax", "sincos"];

/// Converts a text written for double precision to this precision. Comments and strings are unchanged.
pub(crate) fn written_in(text: &str, language: Language, precision: Precision) -> String {
    if precision == Precision::Double {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if first == '"' {
            string_length(rest)
        } else if first.is_ascii_digit() {
            let length = number_length(rest);
            out += &number(&rest[..length], language);
            rest = &rest[length..];
            continue;
        } else if first.is_ascii_alphabetic() || first == '_' {
            let end = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
            let length = rest.find(end).unwrap_or(rest.len());
            let name = &rest[..length];
            out += match name {
                "double" | "f64" => precision.real(language),
                "u64" => "u32",
                name => name,
            };
            if FUNCTIONS.contains(&name) && rest[length..].starts_with('(') {
                out.push('f');
            }
            rest = &rest[length..];
            continue;
        } else {
            first.len_utf8()
        };
        out += &rest[..length];
        rest = &rest[length..];
    }
    out
}

/// A string with its quotes.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return i + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

/// Returns the length of a number literal; the dots of a range are not part of it.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| {
        let rest = &text[from..];
        rest.find(|c: char| !c.is_ascii_digit())
            .unwrap_or(rest.len())
    };
    let mut end = digits(0);
    if text[end..].starts_with('.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if text[end..].starts_with('e') {
        let sign = usize::from(text[end + 1..].starts_with(['-', '+']));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// A number to the digits that single precision has. Whole ones stay.
fn number(text: &str, language: Language) -> String {
    let is_whole = text.bytes().all(|b| b.is_ascii_digit());
    match text.parse::<f32>() {
        Ok(value) if !is_whole => match language {
            Language::C => format!("{value:?}f"),
            Language::Rust => format!("{value:?}"),
        },
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_types_and_functions_are_single_and_words_stay() {
        let c = "/* 0.1 double sin( */ const double x[3] = {0.1, 1e-9, 12}; y = sin(x) + used(\"0.1 \\\" double\"); // 0.1\n";
        let single = "/* 0.1 double sin( */ const float x[3] = {0.1f, 1e-9f, 12}; y = sinf(x) + used(\"0.1 \\\" double\"); // 0.1\n";
        assert_eq!(written_in(c, Language::C, Precision::Single), single);
        assert_eq!(written_in(c, Language::C, Precision::Double), c);
        let rust = "let x: f64 = libm::exp(0.123456789012); (1e-9..=1e9).contains(&self.q[0].x)";
        let single = "let x: f32 = libm::expf(0.12345679); (1e-9..=1e9).contains(&self.q[0].x)";
        let written = written_in(rust, Language::Rust, Precision::Single);
        assert_eq!(written, single.replace("1e9)", "1000000000.0)"));
    }
}
