//! The trend as figures and as a page.

use super::terminal::MONTH_S;
use super::words::{
    event_name, format_basis, format_life, format_limit, format_meaning, format_note,
    format_passage, format_sureness, format_verdict, format_when, limit_name, plus_minus_or_dash,
    sessions,
};
use crate::words::plus_minus;
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_model::Z95;
use sinew_trend::{JointTrend, Limit, TrendEventKind, TrendReport, TrendVerdict};

/// Offset of one tendon over days since tensioning: sessions at the reference temperature, what the
/// trend knew, the forecast, limits and events.
pub fn figure(joint: &JointTrend) -> Figure {
    let s = &joint.series;
    let start = s.first().map_or(joint.last_utc_s, |p| p.time_utc_s);
    // Cycles where sessions have no dates.
    let per_s = joint
        .cycles
        .and_then(|c| c.per_s)
        .filter(|_| !joint.is_dated());
    let unit_s = per_s.map_or(DAY_S, |per_s| 1.0 / per_s);
    let day = |t: f64| (t - start) / unit_s;
    let days: Vec<f64> = s.iter().map(|p| day(p.time_utc_s)).collect();
    let tracked = |z: f64| -> Vec<f64> {
        (s.iter().map(|p| p.tracked_rad))
            .map(|t| 1e3 * t.mean + z * (1e3 * Z95 * t.deviation))
            .collect()
    };
    let at_reference: Vec<f64> = (s.iter())
        .map(|p| p.at_reference_rad.map_or(f64::NAN, |y| 1e3 * y))
        .collect();
    // As far ahead as it was watched, or until the first limit, at most four times as far.
    let watched = days.last().copied().unwrap_or(0.0);
    let watched = if per_s.is_none() && watched > 2.0 {
        watched.max(14.0)
    } else {
        watched.max(1e-3)
    };
    let reach = joint
        .limits
        .iter()
        .filter_map(|l| l.after_high_s.or(l.after_s.map(|t| 1.3 * t)))
        .map(|t| t / unit_s)
        .fold(watched, f64::max)
        .min(3.0 * watched);
    let end = days.last().copied().unwrap_or(0.0) + reach;
    let shown = || joint.forecast.iter().filter(|f| day(f.time_utc_s) <= end);
    let ahead: Vec<f64> = shown().map(|f| day(f.time_utc_s)).collect();
    let low = shown().map(|f| 1e3 * f.interval_95_rad.low).collect();
    let high: Vec<f64> = shown().map(|f| 1e3 * f.interval_95_rad.high).collect();
    let median = shown().map(|f| 1e3 * f.offset_rad).collect();
    // A limit far above all that happens would flatten the curve.
    let top = (high.iter().copied()).fold((1e3 * joint.offset_rad.mean).abs(), f64::max);
    let axis = match per_s {
        Some(_) => "cycles since the first session".into(),
        None if !joint.is_dated() => "days since the first session".into(),
        None => format!("days since the first session, on {}", day_of(start)),
    };
    let mut panel = Panel::new("", axis, "offset (mrad)")
        .band(Band::new("forecast, 95 %", ahead.clone(), low, high).colour(Colour::Orange))
        .band(Band::new(
            "known then, 95 %",
            days.clone(),
            tracked(-1.0),
            tracked(1.0),
        ))
        .points(
            Points::new(
                format!("sessions, at {} °C", rounded(joint.reference_c, 3)),
                days.clone(),
                at_reference.clone(),
            )
            .colour(Colour::Grey)
            .size(3.5),
        )
        .line(Line::new("trend", days, tracked(0.0)))
        .line(
            Line::new("forecast, median", ahead, median)
                .colour(Colour::Orange)
                .dash(Dash::Dashed),
        )
        .x_range(0.0, end);
    if joint.is_dated() {
        panel = panel.x_days_since(start);
    }
    for limit in &joint.limits {
        let limit_mrad = 1e3 * limit.limit_rad;
        if limit_mrad < 1.5 * top && matches!(limit.limit, Limit::Retension { .. }) {
            panel = panel.reference(limit_mrad, limit_name(limit.limit));
        }
    }
    // The first session after a jump looks off until the next agrees with it.
    let jumped = |t: f64| (joint.events.iter()).any(|e| (e.time_utc_s - t).abs() < 0.5 * unit_s);
    let last_off = s.iter().rposition(|p| p.is_off && !jumped(p.time_utc_s));
    if let Some(i) = last_off {
        panel = panel.note(day(s[i].time_utc_s), at_reference[i], "off by itself");
    }
    for event in &joint.events {
        panel = panel.event(day(event.time_utc_s), event_name(event.kind));
    }
    Figure::new(format!("Offset of {}", joint.name))
        .subtitle(format_verdict(joint))
        .seen(seen(joint))
        .size(820.0, 360.0)
        .panel(panel)
}

/// What the figure shows: the verdict, where the offset stands, which way it goes.
fn seen(joint: &JointTrend) -> String {
    let rate = joint.rate_rad_per_s;
    let way = match rate.mean {
        _ if rate.mean.abs() < rate.half_width_95() => "hardly changes",
        up if up > 0.0 => "still grows",
        _ => "falls",
    };
    format!(
        "{}: {}. The offset is {} mrad and {way}, by {} mrad a month; ± is 95 %",
        joint.name,
        format_verdict(joint),
        plus_minus(joint.offset_rad, 1e3),
        plus_minus(rate, 1e3 * MONTH_S)
    )
}

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
    let head = [
        "tendon",
        "offset, mrad",
        "elongation, mm",
        "strain, %",
        "creep, mrad/month",
    ];
    let rows = (report.joints.iter()).map(|j| {
        vec![
            j.name.clone(),
            plus_minus(j.offset_rad, 1e3),
            plus_minus_or_dash(j.elongation_m, 1e3),
            plus_minus_or_dash(j.strain_ratio, 100.0),
            plus_minus(j.rate_rad_per_s, 1e3 * MONTH_S),
        ]
    });
    page = page.section(
        "",
        vec![
            Block::Headlines(headlines),
            Block::Table(
                Table::new(&head, rows)
                    .captioned("Now, at the reference temperature; ± is half a 95 % interval"),
            ),
        ],
    );
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
        blocks.push(Block::Table(
            Table::new(
                &["limit", "value", "passed with probability", "in days", "on"],
                (joint.limits.iter()).map(|l| {
                    let days = l.after_s.map(|t| rounded(t / DAY_S, 3));
                    vec![
                        limit_name(l.limit).into(),
                        format_limit(l.limit),
                        format!("{:.2}", l.passed_probability),
                        days.unwrap_or_else(|| "–".into()),
                        l.at_utc_s.map_or("–".into(), day_of),
                    ]
                }),
            )
            .captioned("Limits; days count from the last session"),
        ));
        // Too long for a table's cell.
        let passages = joint.limits.iter();
        blocks.push(Block::List(
            passages
                .map(|l| format!("{}: {}", limit_name(l.limit), format_passage(l, joint)))
                .collect(),
        ));
    }
    if let Some(life) = &joint.life {
        blocks.push(Block::List(vec![format!(
            "Replace {}",
            format_life(life, joint)
        )]));
    }
    if !joint.events.is_empty() {
        blocks.push(Block::Table(
            Table::new(
                &["seen from", "what", "by, mrad", "sure"],
                (joint.events.iter()).map(|e| {
                    vec![
                        format_when(joint, e.time_utc_s),
                        event_name(e.kind).into(),
                        plus_minus_or_dash(e.size_rad, 1e3),
                        match e.kind {
                            TrendEventKind::Tensioned { stated: true } => "stated".into(),
                            _ => format!(
                                "{:.1} %, {}",
                                100.0 * e.probability,
                                format_when(joint, e.confirmed_utc_s)
                            ),
                        },
                    ]
                }),
            )
            .worded(&["what", "sure"])
            .captioned("Events"),
        ));
        // Too long for a table's cell.
        let meanings = joint.events.iter();
        blocks.push(Block::List(
            meanings
                .map(|e| {
                    let sure = format_sureness(e).map_or(String::new(), |s| format!("; {s}"));
                    let day = format_when(joint, e.time_utc_s);
                    format!("{day}: {}{sure}", format_meaning(e))
                })
                .collect(),
        ));
    }
    let mut facts = vec![
        ["Forecast rests on".to_string(), format_basis(&joint.basis)],
        [
            "Tensioned".into(),
            format!(
                "{}{}",
                format_when(joint, joint.tensioned_utc_s),
                if joint.tensioned_stated {
                    ""
                } else {
                    " (not stated: an hour before its baseline or first session)"
                }
            ),
        ],
        [
            "Error that all sessions since the baseline share, mrad".into(),
            format!(
                "± {}: it is in the offset's ±, however many sessions there are",
                rounded(1e3 * Z95 * joint.baseline_error_rad.deviation, 2)
            ),
        ],
        [
            "Error that neighbouring sessions share, standard deviation".into(),
            format!("{} mrad", rounded(1e3 * joint.shared_error_rad, 2)),
        ],
        [
            "Sessions' own error over what they state".into(),
            rounded(joint.stated_width_ratio, 2),
        ],
    ];
    if let Some(drift) = joint.drift_rad_per_k {
        let drift = plus_minus(drift, 1e3);
        facts.push(["Drift with temperature, mrad/K".into(), drift]);
    }
    blocks.push(Block::Table(Table::new(
        &[],
        facts.into_iter().map(Vec::from),
    )));
    blocks
}
