//! The ledger as text and as one HTML page.

use super::PaperError;
use super::decider::decided_by;
use super::ledger::{Ledger, LedgerRow, LedgerStatus};
use super::page::SOURCE;
use sinew_figure::{Block, Headline, Level, Page, Table};
use sinew_files::write_file;
use sinew_report::text::{indented, paragraph};
use std::path::Path;

const STATUSES: [LedgerStatus; 4] = [
    LedgerStatus::Holds,
    LedgerStatus::Open,
    LedgerStatus::Contradicted,
    LedgerStatus::NotJudged,
];

/// Writes `ledger.html` into `folder`, which must exist; the ledger then names it.
///
/// # Errors
/// [`PaperError`]; the file is whole or not there.
pub fn write_ledger(ledger: &mut Ledger, folder: &Path) -> Result<(), PaperError> {
    let path = folder.join("ledger.html");
    write_file(&path, html(ledger).as_bytes())?;
    ledger.html = Some(path);
    Ok(())
}

/// How many sentences became what.
fn counts(ledger: &Ledger) -> String {
    let counts = STATUSES.map(|status| format!("{} {}", ledger.count(status), status.name()));
    format!(
        "{} sentences of the paper: {}",
        ledger.rows.len(),
        counts.join(", ")
    )
}

/// As text: a sentence a paragraph.
pub fn render_ledger(ledger: &Ledger) -> String {
    const INDENT: usize = 4;
    let mut out = paragraph(&counts(ledger), 0);
    for row in &ledger.rows {
        out.push('\n');
        let line = format!("{}, {}: {}", row.place.name(), row.status.name(), row.text);
        out.push_str(&paragraph(&line, INDENT));
        out.push_str(&indented(&details(row), INDENT, INDENT));
    }
    if let Some(path) = &ledger.html {
        out.push_str(&format!("\n{}\n", path.display()));
    }
    out
}

/// What was found, by what rule, what decides it and which command shows it.
fn details(row: &LedgerRow) -> String {
    let Some(figure) = row.figure else {
        return row.criterion.clone();
    };
    let mut text = format!("found {}; {}", row.found, row.criterion);
    if let Some(deciders) = decided_by(&row.decided_by) {
        text += &format!("; decided by {deciders}");
    }
    text + &format!(" (sinew paper {figure})")
}

fn html(ledger: &Ledger) -> String {
    let level = match (
        ledger.count(LedgerStatus::Contradicted),
        ledger.count(LedgerStatus::Open),
    ) {
        (0, 0) => Level::Good,
        (0, _) => Level::Open,
        _ => Level::Watch,
    };
    let mut page = Page {
        footer: format!("Made by Sinew {}.", env!("CARGO_PKG_VERSION")),
        ..Page::new("Every sentence of the paper")
    }
    .section(
        "",
        vec![
            Block::Headlines(vec![Headline::new(level, counts(ledger))]),
            Block::Paragraph(format!(
                "The sentences are in our words. Those on arms are judged on {}, a simulation; those on ropes on the catalogue's virtual ropes, whose parameters are starting guesses. The paper's curves are not available as data: nothing is compared with a digitised curve.",
                ledger.robot
            )),
            Block::Table(overview(ledger)),
        ],
    );
    for status in STATUSES {
        let rows: Vec<&LedgerRow> = ledger.rows.iter().filter(|r| r.status == status).collect();
        if rows.is_empty() {
            continue;
        }
        let lines = rows
            .iter()
            .map(|row| format!("{}: {} – {}", row.place.name(), row.text, details(row)))
            .collect();
        page = page.section(heading(status), vec![Block::List(lines)]);
    }
    page.section("Source", vec![Block::Paragraph(SOURCE.into())])
        .html()
}

fn heading(status: LedgerStatus) -> &'static str {
    match status {
        LedgerStatus::Holds => "What holds, and by what rule",
        LedgerStatus::Open => "What is open",
        LedgerStatus::Contradicted => "What is contradicted",
        LedgerStatus::NotJudged => "What is not judged, and why",
    }
}

fn overview(ledger: &Ledger) -> Table {
    let rows = ledger.rows.iter().map(|row| {
        vec![
            row.place.name().into(),
            row.status.name().into(),
            row.text.clone(),
            row.found.clone(),
            row.figure.map_or_else(|| "–".into(), |f| f.to_string()),
        ]
    });
    Table::new(&["where", "verdict", "sentence", "found", "figure"], rows)
        .worded(&["verdict", "sentence", "figure"])
}
