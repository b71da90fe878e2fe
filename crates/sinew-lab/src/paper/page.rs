//! A figure as files: SVG, PNG and one HTML page that opens offline.

use super::{PaperError, PaperFigure, Sentence};
use crate::output::write_file;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Files of one figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The drawing, scalable.
    pub svg: PathBuf,
    /// The drawing, 2 px per CSS px.
    pub png: PathBuf,
    /// The page: drawing, sentences, assumptions.
    pub html: PathBuf,
}

/// Writes `NAME.svg`, `NAME.png` and `NAME.html` into `folder`, which must exist.
///
/// # Errors
/// [`PaperError`]; each file is whole or not there.
pub fn write(figure: &PaperFigure, folder: &Path) -> Result<Written, PaperError> {
    let at = |ending: &str| folder.join(format!("{}.{ending}", figure.name));
    let written = Written {
        svg: at("svg"),
        png: at("png"),
        html: at("html"),
    };
    const SCALE: f64 = 2.0;
    write_file(&written.svg, figure.figure.svg().as_bytes())?;
    write_file(&written.png, &figure.figure.png(SCALE)?)?;
    write_file(&written.html, html(figure).as_bytes())?;
    Ok(written)
}

/// The page as text.
fn html(figure: &PaperFigure) -> String {
    let mut out = String::from("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">");
    out.push_str("<meta name=\"viewport\" content=\"width=device-width\">");
    let _ = write!(out, "<title>{}</title>", escaped(&figure.title));
    out.push_str("<style>");
    out.push_str(STYLE);
    out.push_str("</style></head><body>");
    let _ = write!(out, "<h1>{}</h1>", escaped(&figure.title));
    for paragraph in &figure.about {
        let _ = write!(out, "<p>{}</p>", escaped(paragraph));
    }
    let _ = write!(out, "<figure>{}</figure>", figure.figure.svg());
    out.push_str("<h2>What it should show</h2><table><thead><tr><th></th><th>Sentence</th><th class=\"n\">Found</th><th>Holds when</th></tr></thead><tbody>");
    for sentence in &figure.sentences {
        row(&mut out, sentence);
    }
    out.push_str("</tbody></table><h2>What is assumed</h2><ul>");
    for assumption in &figure.assumptions {
        let _ = write!(out, "<li>{}</li>", escaped(assumption));
    }
    out.push_str("</ul><p class=\"source\">After J. Kirchhoff and O. von Stryk, <i>New Insights in Synthetic Fiber Rope Elongation and its Detection for Ultra Lightweight Tendon Driven Series Elastic Robots</i>, IROS 2018. Made by Sinew ");
    out.push_str(env!("CARGO_PKG_VERSION"));
    out.push_str(".</p></body></html>\n");
    out
}

fn row(out: &mut String, s: &Sentence) {
    let (class, word) = if s.holds {
        ("yes", "holds")
    } else {
        ("no", "does not hold")
    };
    let _ = write!(
        out,
        "<tr class=\"{class}\"><td>{word}</td><td>{}</td><td class=\"n\">{}&nbsp;{}</td><td>{}</td></tr>",
        escaped(&s.text),
        number(s.value),
        escaped(s.unit),
        escaped(&s.criterion)
    );
}

/// Three digits that matter.
fn number(v: f64) -> String {
    let size = v.abs();
    if size == 0.0 {
        "0".into()
    } else if size < 1e-3 {
        format!("{v:.1e}").replace('-', "−")
    } else if size < 1.0 {
        format!("{v:.3}").replace('-', "−")
    } else if size < 100.0 {
        format!("{v:.2}").replace('-', "−")
    } else {
        format!("{v:.0}").replace('-', "−")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;color:#1d1f24;max-width:1140px;margin:2rem auto;padding:0 1rem}\
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}figure{margin:1.5rem 0;overflow-x:auto}svg{max-width:100%;height:auto}\
table{border-collapse:collapse;width:100%}th,td{text-align:left;vertical-align:top;padding:.4rem .6rem;border-bottom:1px solid #dfe2e7}\
td.n,th.n{text-align:right;white-space:nowrap}tr.yes td:first-child{color:#00704f;white-space:nowrap}tr.no td:first-child{color:#b3330f;font-weight:600}\
.source{color:#5c626d;font-size:.9rem}";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits_and_text_is_escaped() {
        assert_eq!(number(15.1473), "15.15");
        assert_eq!(number(-75.94), "−75.94");
        assert_eq!(number(2.85e-4), "2.8e−4");
        assert_eq!(number(0.0751), "0.075");
        assert_eq!(escaped("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
