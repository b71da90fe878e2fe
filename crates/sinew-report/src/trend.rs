//! The trend as figures and as a page for whoever keeps the robots running.

use sinew_estimate::trend::{JointTrend, TrendReport};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Block, Page, Table, rounded};

const DAY_S: f64 = 86_400.0;

/// Offset of one tendon over days since tensioning: sessions at the reference temperature, what the
/// trend knew, the forecast, limits and events.
pub fn figure(joint: &JointTrend) -> Figure {
    let s = &joint.series;
    let start = s.time_utc_s.first().copied().unwrap_or(joint.last_utc_s);
    let day = |t: &f64| (t - start) / DAY_S;
    let days: Vec<f64> = s.time_utc_s.iter().map(day).collect();
    let (low, high) = s.tracked_mrad.iter().map(|[m, h]| (m - h, m + h)).unzip();
    let mean = s.tracked_mrad.iter().map(|[m, _]| *m).collect();
    // As far ahead as it was watched, or until the first limit, at most four times as far.
    let watched = days.last().copied().unwrap_or(0.0).max(14.0);
    let reach = joint
        .limits
        .iter()
        .filter_map(|l| l.interval_95_days[1].or(l.days.map(|d| 1.3 * d)))
        .fold(watched, f64::max)
        .min(3.0 * watched);
    let end = days.last().copied().unwrap_or(0.0) + reach;
    let shown: Vec<usize> = (0..s.forecast_utc_s.len())
        .filter(|i| day(&s.forecast_utc_s[*i]) <= end)
        .collect();
    let ahead: Vec<f64> = shown.iter().map(|i| day(&s.forecast_utc_s[*i])).collect();
    let of = |q: usize| {
        shown
            .iter()
            .map(|i| s.forecast_mrad[*i][q])
            .collect::<Vec<f64>>()
    };
    let mut panel = Panel::new("", "days since the first session", "offset (mrad)")
        .band(Band::new("forecast, 95 %", ahead.clone(), of(0), of(2)).colour(Colour::Orange))
        .band(Band::new("known then, 95 %", days.clone(), low, high))
        .line(
            Line::new(
                format!("sessions, at {} °C", rounded(joint.reference_c, 3)),
                days.clone(),
                s.at_reference_mrad.clone(),
            )
            .colour(Colour::Grey)
            .width(1.0),
        )
        .line(Line::new("trend", days, mean))
        .line(
            Line::new("forecast, median", ahead, of(1))
                .colour(Colour::Orange)
                .dash(Dash::Dashed),
        )
        .x_range(0.0, end);
    for limit in &joint.limits {
        // A limit far above all that happens would flatten the curve.
        let top = of(2).into_iter().fold(joint.offset_mrad[0].abs(), f64::max);
        if limit.limit_mrad < 1.5 * top && limit.kind == "re-tension" {
            panel = panel.reference(limit.limit_mrad, limit.kind.clone());
        }
    }
    // The first session after a jump looks off until the next agrees with it.
    let jumped = |t: f64| (joint.events.iter()).any(|e| (e.time_utc_s - t).abs() < 0.5 * DAY_S);
    let last_off = (0..s.off.len())
        .rev()
        .find(|i| s.off[*i] && !jumped(s.time_utc_s[*i]));
    if let Some(i) = last_off {
        panel = panel.note(
            day(&s.time_utc_s[i]),
            s.at_reference_mrad[i],
            "off by itself",
        );
    }
    for event in &joint.events {
        panel = panel.event(day(&event.time_utc_s), event.kind.clone());
    }
    Figure::new(format!("Offset of {}", joint.name))
        .subtitle(joint.verdict.clone())
        .size(820.0, 360.0)
        .panel(panel)
}

/// `12.3 ± 0.4`, or a dash.
fn plus_minus(value: Option<[f64; 2]>) -> String {
    value.map_or("–".into(), |[m, h]| {
        format!("{} ± {}", rounded(m, 3), rounded(h, 2))
    })
}

/// The page.
pub fn html(report: &TrendReport) -> String {
    let name = report.robot.as_deref().unwrap_or("robot");
    let mut page = Page::new(format!("Tendons of {name}: trend"));
    page.subtitle = report
        .joints
        .iter()
        .map(|j| j.last_day.clone())
        .max()
        .map_or(String::new(), |d| format!("as of {d}"));
    page.footer = format!("Sinew {}", report.sinew_version);
    let headlines = (report.joints.iter())
        .map(|j| format!("{}: {}", j.name, j.verdict))
        .collect();
    let head = [
        "tendon",
        "offset, mrad",
        "elongation, mm",
        "strain, %",
        "creep, mrad/month",
    ];
    let rows = (report.joints.iter())
        .map(|j| {
            vec![
                j.name.clone(),
                plus_minus(Some(j.offset_mrad)),
                plus_minus(j.elongation_mm),
                plus_minus(j.strain_percent),
                plus_minus(Some(j.rate_mrad_per_month)),
            ]
        })
        .collect();
    page = page.section(
        "",
        vec![
            Block::Headlines(headlines),
            Block::Table(Table {
                caption: "Now, at the reference temperature; ± is half a 95 % interval".into(),
                head: head.map(String::from).to_vec(),
                rows,
            }),
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
    how.extend(report.notes.iter().cloned());
    page.section("How to read this", vec![Block::List(how)])
        .html()
}

fn joint_blocks(joint: &JointTrend) -> Vec<Block> {
    let mut blocks = vec![Block::Figure(
        Box::new(figure(joint)),
        format!(
            "{} sessions from {} to {}, {} of them without information; reference temperature {} °C",
            joint.sessions,
            joint.first_day,
            joint.last_day,
            joint.without_information,
            rounded(joint.reference_c, 3)
        ),
    )];
    if !joint.limits.is_empty() {
        blocks.push(Block::Table(Table {
            caption: "Limits; brackets are 95 % intervals, days from the last session".into(),
            head: ["limit", "value", "passed with probability", "passed"]
                .map(String::from)
                .to_vec(),
            rows: (joint.limits.iter())
                .map(|l| {
                    vec![
                        l.kind.clone(),
                        l.stated.clone(),
                        format!("{:.2}", l.passed_probability),
                        l.said.clone(),
                    ]
                })
                .collect(),
        }));
    }
    if !joint.events.is_empty() {
        blocks.push(Block::Table(Table {
            caption: "Events".into(),
            head: ["seen from", "what", "by, mrad", "sure"]
                .map(String::from)
                .to_vec(),
            rows: (joint.events.iter())
                .map(|e| {
                    vec![
                        e.day.clone(),
                        e.kind.clone(),
                        plus_minus(e.size_mrad),
                        if e.stated {
                            "stated".into()
                        } else {
                            format!("{:.1} %, {}", 100.0 * e.probability, e.confirmed_day)
                        },
                    ]
                })
                .collect(),
        }));
        // Too long for a table's cell.
        let meanings = joint.events.iter();
        blocks.push(Block::List(
            meanings
                .map(|e| format!("{}: {}", e.day, e.meaning))
                .collect(),
        ));
    }
    let mut facts = vec![
        ["Forecast rests on".to_string(), joint.basis.clone()],
        [
            "Tensioned".into(),
            format!(
                "{}{}",
                joint.tensioned_day,
                if joint.tensioned_stated {
                    ""
                } else {
                    " (not stated: the first session)"
                }
            ),
        ],
        [
            "Error that sessions share".into(),
            format!("{} mrad", rounded(joint.shared_error_mrad, 2)),
        ],
        [
            "Sessions' own error over what they state".into(),
            rounded(joint.stated_width_factor, 2),
        ],
    ];
    if joint.drift_mrad_per_k.is_some() {
        facts.push([
            "Drift with temperature, mrad/K".into(),
            plus_minus(joint.drift_mrad_per_k),
        ]);
    }
    blocks.push(Block::Table(Table {
        caption: String::new(),
        head: Vec::new(),
        rows: facts.into_iter().map(Vec::from).collect(),
    }));
    blocks
}
