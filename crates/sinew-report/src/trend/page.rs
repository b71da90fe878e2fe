//! HTML report of a trend.

use super::figure::figure;
use super::messages::{
    event_line, event_name, format_basis, format_life, format_limit, format_verdict, format_when,
    limit_line, limit_name, note_message, now, plus_minus_or_dash, sessions,
};
use crate::format::plus_minus;
use crate::text::or_dash;
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, probability, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_model::Z95;
use sinew_trend::{JointTrend, TrendEventKind, TrendReport, TrendVerdict};

/// Renders a trend as one HTML file.
pub fn html(report: &TrendReport) -> String {
    page(report).html()
}

/// Builds the report of a trend.
pub fn page(report: &TrendReport) -> Page {
    let name = report.robot.as_deref().unwrap_or("robot");
    let mut page = Page::new(format!("Tendon trend of {name}"));
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
        .column("strain\n(%)", |j| plus_minus_or_dash(j.strain_ratio, 100.0))
        .captioned(
            "Present values at the reference temperature; ± is the half-width of the 95 % interval",
        );
    page = page.section("", vec![Block::Headlines(headlines), now.into()]);
    for joint in &report.joints {
        page = page.section(joint.name.clone(), joint_blocks(joint));
    }
    let mut how = vec![
        "Offset and elongation refer to the last tensioning, strain to the first one.".into(),
        "A forecast assumes unchanged use of the robot and no failure.".into(),
        "A step change is suspected after one session, and confirmed or withdrawn by the next."
            .into(),
    ];
    how.extend(report.notes.iter().map(|n| note_message(n).to_string()));
    page.section("Notes", vec![Block::List(how)])
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
            .column("exceeded (probability)", |l| {
                probability(l.passed_probability)
            })
            .column("forecast (days)", |l| {
                or_dash(l.after_s, |t| rounded(t / DAY_S, 3))
            })
            .column("date", |l| or_dash(l.at_utc_s, day_of));
        let limits = limits.captioned("Limits; forecast in days after the last session");
        blocks.push(limits.into());
        // Sentences are too long for a table.
        let passages = joint.limits.iter().map(|l| limit_line(l, joint));
        blocks.push(Block::List(passages.collect()));
    }
    if let Some(life) = &joint.life {
        let life = format!("Replacement: {}", format_life(life, joint));
        blocks.push(Block::List(vec![life]));
    }
    if !joint.events.is_empty() {
        let events = Columns::of(&joint.events)
            .column("date", |e| format_when(joint, e.time_utc_s))
            .words("event", |e| event_name(e.kind))
            .column("size (mrad)", |e| plus_minus_or_dash(e.size_rad, 1e3))
            .words("probability", |e| match e.kind {
                TrendEventKind::Tensioned { stated: true } => "specified".into(),
                _ => {
                    let day = format_when(joint, e.confirmed_utc_s);
                    format!("{} on {day}", probability(e.probability))
                }
            });
        blocks.push(events.captioned("Events").into());
        // Sentences are too long for a table.
        let meanings = joint.events.iter().map(|e| event_line(e, joint));
        blocks.push(Block::List(meanings.collect()));
    }
    let source = match joint.tensioned_specified {
        true => "",
        false => " (not specified: assumed one hour before its baseline or first session)",
    };
    let tensioned = format_when(joint, joint.tensioned_utc_s);
    let baseline = rounded(1e3 * Z95 * joint.baseline_error_rad.std, 2);
    let shared = rounded(1e3 * joint.systematic_error_rad, 2);
    let mut facts = vec![
        ("Forecast based on", format_basis(&joint.basis)),
        ("Tensioned", format!("{tensioned}{source}")),
        (
            "Systematic error from the baseline",
            format!("± {baseline} mrad, part of the interval of the offset"),
        ),
        (
            "Correlated error of neighbouring sessions (standard deviation)",
            format!("{shared} mrad"),
        ),
        (
            "Actual / reported standard deviation",
            rounded(joint.reported_width_ratio, 2),
        ),
    ];
    let drift = joint.drift_rad_per_k.map(|drift| plus_minus(drift, 1e3));
    facts.extend(drift.map(|drift| ("Temperature drift (mrad/K)", drift)));
    blocks.push(Table::facts(facts).into());
    blocks
}
