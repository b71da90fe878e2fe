//! The trend as a page.

use super::figure::figure;
use super::words::{
    event_line, event_name, format_basis, format_life, format_limit, format_note, format_verdict,
    format_when, limit_line, limit_name, now, plus_minus_or_dash, sessions,
};
use crate::text::or_dash;
use crate::words::plus_minus;
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_model::Z95;
use sinew_trend::{JointTrend, TrendEventKind, TrendReport, TrendVerdict};

/// The page as one HTML file.
pub fn html(report: &TrendReport) -> String {
    page(report).html()
}

/// The page.
pub fn page(report: &TrendReport) -> Page {
    let name = report.robot.as_deref().unwrap_or("robot");
    let mut page = Page::new(format!("Tendons of {name}: trend"));
    page.subtitle = report
        .joints
        .iter()
        .max_by(|a, b| a.last_utc_s.total_cmp(&b.last_utc_s))
        .map_or(String::new(), |j| {
            format!("as of {}", format_when(j, j.last_utc_s))
        });
    page.footer = format!("Sinew {}", report.sinew_version);
    let headlines = (report.joints.iter())
        .map(|j| {
            Headline::new(
                level(j.verdict),
                format!("{}: {}", j.name, format_verdict(j)),
            )
        })
        .collect();
    let now = now(report)
        .column("strain\n%", |j| plus_minus_or_dash(j.strain_ratio, 100.0))
        .captioned("Now, at the reference temperature; ± is half a 95 % interval");
    page = page.section("", vec![Block::Headlines(headlines), now.into()]);
    for joint in &report.joints {
        page = page.section(joint.name.clone(), joint_blocks(joint));
    }
    let mut how = vec![
        "Offset and elongation count since the last tensioning, strain since the first.".into(),
        "A forecast supposes that the robot is used as before and that nothing fails.".into(),
        "A jump is suspected after one session and confirmed by the next that agrees.".into(),
    ];
    how.extend(report.notes.iter().map(format_note));
    page.section("How to read this", vec![Block::List(how)])
}

fn level(verdict: TrendVerdict) -> Level {
    match verdict {
        TrendVerdict::Retension | TrendVerdict::Replace | TrendVerdict::ReplaceByAge => {
            Level::Alarm
        }
        TrendVerdict::Inspect | TrendVerdict::Watch => Level::Watch,
        TrendVerdict::Wait => Level::Good,
        TrendVerdict::NoLimit => Level::Open,
    }
}

fn joint_blocks(joint: &JointTrend) -> Vec<Block> {
    let mut blocks = vec![Block::Figure(
        Box::new(figure(joint)),
        format!(
            "{} to {}: {}; reference temperature {} °C",
            format_when(joint, joint.first_utc_s),
            format_when(joint, joint.last_utc_s),
            sessions(joint),
            rounded(joint.reference_c, 3)
        ),
    )];
    if !joint.limits.is_empty() {
        let limits = Columns::of(&joint.limits)
            .column("limit", |l| limit_name(l.limit))
            .column("value", |l| format_limit(l.limit))
            .column("passed with probability", |l| {
                format!("{:.2}", l.passed_probability)
            })
            .column("in days", |l| or_dash(l.after_s, |t| rounded(t / DAY_S, 3)))
            .column("on", |l| or_dash(l.at_utc_s, day_of));
        let limits = limits.captioned("Limits; days count from the last session");
        blocks.push(limits.into());
        // Too long for a table's cell.
        let passages = joint.limits.iter().map(|l| limit_line(l, joint));
        blocks.push(Block::List(passages.collect()));
    }
    if let Some(life) = &joint.life {
        let life = format!("Replace {}", format_life(life, joint));
        blocks.push(Block::List(vec![life]));
    }
    if !joint.events.is_empty() {
        let events = Columns::of(&joint.events)
            .column("seen from", |e| format_when(joint, e.time_utc_s))
            .words("what", |e| event_name(e.kind))
            .column("by, mrad", |e| plus_minus_or_dash(e.size_rad, 1e3))
            .words("sure", |e| match e.kind {
                TrendEventKind::Tensioned { stated: true } => "stated".into(),
                _ => {
                    let day = format_when(joint, e.confirmed_utc_s);
                    format!("{:.1} %, {day}", 100.0 * e.probability)
                }
            });
        blocks.push(events.captioned("Events").into());
        // Too long for a table's cell.
        let meanings = joint.events.iter().map(|e| event_line(e, joint));
        blocks.push(Block::List(meanings.collect()));
    }
    let stated = match joint.tensioned_stated {
        true => "",
        false => " (not stated: an hour before its baseline or first session)",
    };
    let tensioned = format_when(joint, joint.tensioned_utc_s);
    let baseline = rounded(1e3 * Z95 * joint.baseline_error_rad.deviation, 2);
    let shared = rounded(1e3 * joint.shared_error_rad, 2);
    let mut facts = vec![
        ("Forecast rests on", format_basis(&joint.basis)),
        ("Tensioned", format!("{tensioned}{stated}")),
        (
            "Error that all sessions since the baseline share, mrad",
            format!("± {baseline}: it is in the offset's ±, however many sessions there are"),
        ),
        (
            "Error that neighbouring sessions share, standard deviation",
            format!("{shared} mrad"),
        ),
        (
            "Sessions' own error over what they state",
            rounded(joint.stated_width_ratio, 2),
        ),
    ];
    let drift = joint.drift_rad_per_k.map(|drift| plus_minus(drift, 1e3));
    facts.extend(drift.map(|drift| ("Drift with temperature, mrad/K", drift)));
    blocks.push(Table::facts(facts).into());
    blocks
}
