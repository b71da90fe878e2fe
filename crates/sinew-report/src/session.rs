//! The session's estimate as sections of the report.

use crate::session_sentences::{change_kind, session_sentences};
use crate::units::{Moves, in_units, name_in_table, of_heads};
use crate::warnings::session_warnings;
use crate::words::{plus_minus, plus_minus_cells};
use sinew_estimate::NuisanceChange;
use sinew_estimate::session::{
    BlockEstimate, LimitState, SessionEstimate, TendonChange, TendonChangeKind, TendonEstimate,
    Verdict,
};
use sinew_figure::plot::{Band, Colour, Figure, Line, Panel};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded, with_interval};

/// Adds what the joint estimate says.
pub(super) fn sections(page: Page, session: &SessionEstimate) -> Page {
    let since = match &session.baseline {
        Some(baseline) => format!("Since the baseline ({baseline})"),
        None => "Against the encoders' zero, without a baseline".into(),
    };
    let mut opening = vec![
        Block::Headlines(session.joints.iter().map(headline).collect()),
        Block::Paragraph(
            "All joints estimated together with stiffness, masses, friction, encoder errors, temperature and payload; times that fit nothing are left out as contact. ± is half a 95 % interval, on the whole page.".into(),
        ),
        Block::Table(offsets(session)),
    ];
    opening.push(Block::List(session_sentences(session)));
    if !session.warnings.is_empty() {
        opening.push(Block::List(session_warnings(session)));
    }
    let mut page = page.section(since, opening);
    for (i, joint) in session.joints.iter().enumerate() {
        page = page.section(
            format!("Joint {} over the recording", joint.name),
            vec![Block::Figure(
                Box::new(course(session, i)),
                "Thin line: what each block of 0.2 s says once everything else is taken off. Grey: left out as contact or disturbance.".into(),
            )],
        );
    }
    let moved = session.nuisance.iter().filter(|n| n.moved).count();
    page.section(
        "Estimated along",
        vec![
            Block::Paragraph(
                "What was believed before and after; ± is half the 95 % interval. What the data did not move rests on the tolerance alone.".into(),
            ),
            Block::Folded(
                format!("{} parameters, {} of them moved by the data", session.nuisance.len(), moved),
                vec![Block::Table(nuisance(session))],
            ),
        ],
    )
}

/// What an answer asks for: a rope that failed or a limit that is passed, a change, nothing, or more data.
fn level(joint: &TendonEstimate) -> Level {
    let failed = |c: &TendonChange| {
        matches!(
            c.kind,
            TendonChangeKind::StrandFailure | TendonChangeKind::SlipOrStrandFailure
        )
    };
    let passed = joint
        .retension
        .is_some_and(|r| r.state == LimitState::Passed);
    if passed || joint.changes.iter().any(failed) {
        return Level::Alarm;
    }
    match joint.verdict {
        Verdict::Longer | Verdict::Shorter => Level::Watch,
        _ if !joint.changes.is_empty() => Level::Watch,
        Verdict::Unchanged => Level::Good,
        Verdict::CannotTell => Level::Open,
    }
}

fn headline(joint: &TendonEstimate) -> Headline {
    let size = match joint.elongation_m {
        Some(m) => format!(
            "{} mm",
            with_interval(1e3 * m.mean.abs(), 1e3 * m.deviation)
        ),
        None => {
            let offset = joint.offset_rad.scaled(1e3);
            let mrad = with_interval(offset.mean.abs(), offset.deviation);
            format!("{mrad} {} at the joint", joint.units().offset)
        }
    };
    let passed = joint.retension.filter(|r| r.state == LimitState::Passed);
    let limit = passed.map_or(String::new(), |limit| {
        format!(
            "; beyond its limit of {} mm: tension it again",
            rounded(1e3 * limit.elongation_m, 2)
        )
    });
    let slip = |c: &TendonChange| {
        let size = c.size_rad?.scaled(1e3);
        let mrad = with_interval(size.mean, size.deviation);
        let kind = change_kind(c.kind);
        let unit = joint.units().offset;
        Some(format!("; {kind} of {mrad} {unit} at {:.1} s", c.time_s))
    };
    let slip: String = joint.changes.iter().filter_map(slip).collect();
    let limit = limit + &slip;
    let name = &joint.name;
    let text = match joint.verdict {
        Verdict::Longer => format!("{name}: the tendon is longer by {size}{limit}"),
        Verdict::Shorter => format!("{name}: the tendon is shorter by {size}{slip}"),
        Verdict::Unchanged => format!("{name}: no stretch seen ({size}){slip}"),
        Verdict::CannotTell => format!("{name}: can't tell from this recording ({size}){slip}"),
    };
    Headline::new(level(joint), text)
}

fn offsets(session: &SessionEstimate) -> Table {
    let head = [
        "joint",
        "offset, mrad",
        "±, mrad",
        "elongation, mm",
        "±, mm",
        "stiffness against robot.toml, %",
        "±, %",
        "torque, N·m",
    ];
    let heads = of_heads(&session.joints);
    Table {
        head: head.map(|h| in_units(h, heads)).to_vec(),
        rows: session
            .joints
            .iter()
            .map(|j| {
                let [offset, offset_half] = plus_minus_cells(Some(j.offset_rad), 1e3);
                let [elongation, elongation_half] = plus_minus_cells(j.elongation_m, 1e3);
                let [stiffness, stiffness_half] =
                    plus_minus_cells(Some(j.stiffness_change_ratio), 100.0);
                vec![
                    name_in_table(j, heads),
                    offset,
                    offset_half,
                    elongation,
                    elongation_half,
                    stiffness,
                    stiffness_half,
                    format!(
                        "{} to {}",
                        rounded(j.torque_nm.min, 2),
                        rounded(j.torque_nm.max, 2)
                    ),
                ]
            })
            .collect(),
        ..Table::default()
    }
}

/// Offset of a joint over the recording.
fn course(session: &SessionEstimate, i: usize) -> Figure {
    let joint = &session.joints[i];
    let blocks = &session.blocks;
    let times: Vec<f64> = blocks.iter().map(|b| b.time_s).collect();
    let of_blocks = |f: &dyn Fn(&BlockEstimate) -> f64| -> Vec<f64> {
        blocks.iter().map(|b| 1e3 * f(b)).collect()
    };
    let seen = of_blocks(&|b| match b.is_left_out() {
        true => f64::NAN,
        false => b.block_rad[i],
    });
    let estimate = of_blocks(&|b| b.offset_rad[i].mean);
    let low = of_blocks(&|b| b.offset_rad[i].interval_95().low);
    let high = of_blocks(&|b| b.offset_rad[i].interval_95().high);
    let unit = joint.units().offset;
    let mut panel = Panel::new(
        "",
        "time (s)",
        in_units("offset δ_{e} (mrad)", joint.units()),
    )
    .band(Band::new("95 %", times.clone(), low, high))
    .line(
        Line::new("blocks", times.clone(), seen)
            .colour(Colour::Black)
            .width(0.7),
    )
    .line(Line::new("estimate", times, estimate).step());
    for left in &session.left_out {
        panel = panel.span(left.from_s, left.to_s, "left out");
    }
    for change in &joint.changes {
        let size = change.size_rad.map_or(0.0, |size| 1e3 * size.mean);
        let label = format!("{} {} {unit}", change_kind(change.kind), rounded(size, 2));
        panel = panel.event(change.time_s, label);
    }
    for change in &session.payload_changes {
        let label = format!("payload {} kg", rounded(change.change_kg.mean, 2));
        panel = panel.event(change.time_s, label);
    }
    if let Some(elongation) = joint.elongation_m {
        let per_mrad = elongation.mean / joint.offset_rad.mean;
        if per_mrad.is_finite() {
            panel = panel.y_right("elongation (mm)", per_mrad);
        }
    }
    Figure::new("")
        .size(820.0, 300.0)
        .seen(headline(joint).text)
        .panel(panel)
}

fn nuisance(session: &SessionEstimate) -> Table {
    let head = ["what", "unit", "before", "after", "moved by the data"];
    Table::new(&head, session.nuisance.iter().map(nuisance_row))
}

fn nuisance_row(n: &NuisanceChange) -> Vec<String> {
    let joint = n.joint.as_deref().unwrap_or("");
    vec![
        format!("{joint} {}", n.name).trim().to_string(),
        n.unit.clone(),
        plus_minus(n.prior, 1.0),
        plus_minus(n.posterior, 1.0),
        if n.moved { "yes" } else { "no" }.into(),
    ]
}
