//! The absolute estimate as sections of the report.

use sinew_estimate::absolute::{Absolute, AbsoluteJoint};
use sinew_figure::plot::{Band, Colour, Figure, Line, Panel};
use sinew_figure::{Block, Page, Table, rounded};

/// Adds what the joint estimate says.
pub(super) fn sections(page: Page, said: &Absolute) -> Page {
    let since = match &said.baseline {
        Some(baseline) => format!("Since the baseline ({baseline})"),
        None => "Against the encoders' zero, without a baseline".into(),
    };
    let mut opening = vec![
        Block::Headlines(said.joints.iter().map(headline).collect()),
        Block::Paragraph(
            "All joints estimated together with stiffness, masses, friction, encoder errors, temperature and payload; stretches that fit nothing are left out as contact. ± is half the 95 % interval.".into(),
        ),
        Block::Table(offsets(said)),
    ];
    opening.push(Block::List(said.sentences()));
    if !said.warnings.is_empty() {
        opening.push(Block::List(said.warnings.clone()));
    }
    let mut page = page.section(since, opening);
    for (i, joint) in said.joints.iter().enumerate() {
        page = page.section(
            format!("Joint {} since the baseline", joint.name),
            vec![Block::Figure(
                Box::new(course(said, i)),
                "Thin line: what each block of 0.2 s says once everything else is taken off. Grey: left out as contact or disturbance.".into(),
            )],
        );
    }
    page.section(
        "Estimated along",
        vec![
            Block::Paragraph(
                "What was believed before and after, ± one standard deviation. What the data did not move rests on the tolerance alone.".into(),
            ),
            Block::Table(nuisance(said)),
        ],
    )
}

fn headline(joint: &AbsoluteJoint) -> String {
    let size = match (joint.elongation_mm, joint.interval_95_mm) {
        (Some(mm), Some(interval)) => {
            format!("{} ± {} mm", rounded(mm.abs(), 2), rounded(interval, 2))
        }
        _ => format!(
            "{} ± {} mrad at the joint",
            rounded(joint.offset_mrad.abs(), 2),
            rounded(joint.interval_95_mrad, 2)
        ),
    };
    let limit = match (joint.limit_passed, joint.retension_at_mm) {
        (Some(true), Some(limit)) => {
            format!(
                "; past the {} mm at which to tension again",
                rounded(limit, 2)
            )
        }
        _ => String::new(),
    };
    match joint.verdict.as_str() {
        "longer" => format!("{}: tendon longer by {size}{limit}", joint.name),
        "shorter" => format!("{}: tendon shorter by {size}", joint.name),
        "unchanged" => format!("{}: no stretch seen ({size})", joint.name),
        _ => format!("{}: this recording can't tell ({size})", joint.name),
    }
}

fn offsets(said: &Absolute) -> Table {
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
    let optional = |v: Option<f64>| v.map_or_else(|| "–".into(), |v| rounded(v, 3));
    Table {
        caption: String::new(),
        head: head.map(String::from).to_vec(),
        rows: said
            .joints
            .iter()
            .map(|j| {
                vec![
                    j.name.clone(),
                    rounded(j.offset_mrad, 3),
                    rounded(j.interval_95_mrad, 2),
                    optional(j.elongation_mm),
                    optional(j.interval_95_mm),
                    rounded(j.stiffness_change_percent[0], 2),
                    rounded(j.stiffness_change_percent[1], 2),
                    format!(
                        "{} to {}",
                        rounded(j.torque_range_nm[0], 2),
                        rounded(j.torque_range_nm[1], 2)
                    ),
                ]
            })
            .collect(),
    }
}

/// Offset of a joint over the recording.
fn course(said: &Absolute, i: usize) -> Figure {
    let joint = &said.joints[i];
    let course = &said.course;
    let times: Vec<f64> = course.iter().map(|c| c.time_s).collect();
    let blocks: Vec<f64> = course
        .iter()
        .map(|c| {
            if c.weight > 0.5 {
                c.block_mrad[i]
            } else {
                f64::NAN
            }
        })
        .collect();
    let estimate: Vec<f64> = course.iter().map(|c| c.offset_mrad[i]).collect();
    let half: Vec<f64> = course.iter().map(|c| c.interval_95_mrad[i]).collect();
    let low = estimate.iter().zip(&half).map(|(e, h)| e - h).collect();
    let high = estimate.iter().zip(&half).map(|(e, h)| e + h).collect();
    let mut panel = Panel::new("", "time (s)", "offset δ_{e} (mrad)")
        .band(Band::new("95 %", times.clone(), low, high))
        .line(
            Line::new("blocks", times.clone(), blocks)
                .colour(Colour::Black)
                .width(0.7),
        )
        .line(Line::new("estimate", times, estimate).step());
    for left in &said.left_out {
        panel = panel.span(left.from_s, left.to_s, "");
    }
    for step in &joint.steps {
        panel = panel.event(
            step.time_s,
            format!("{} {} mrad", step.kind, rounded(step.size_mrad, 2)),
        );
    }
    for change in &said.payload_changes {
        panel = panel.event(
            change.time_s,
            format!("payload {} kg", rounded(change.change_kg, 2)),
        );
    }
    if let Some(mm) = joint.elongation_mm
        && (mm / joint.offset_mrad).is_finite()
    {
        panel = panel.y_right("elongation (mm)", mm / joint.offset_mrad);
    }
    Figure::new("").size(820.0, 300.0).panel(panel)
}

fn nuisance(said: &Absolute) -> Table {
    let shown =
        |[mean, deviation]: [f64; 2]| format!("{} ± {}", rounded(mean, 3), rounded(deviation, 2));
    Table {
        caption: String::new(),
        head: ["what", "unit", "before", "after", "moved by the data"]
            .map(String::from)
            .to_vec(),
        rows: said
            .nuisance
            .iter()
            .map(|m| {
                vec![
                    format!("{} {}", m.joint, m.name).trim().to_string(),
                    m.unit.clone(),
                    shown(m.prior),
                    shown(m.posterior),
                    if m.moved { "yes" } else { "no" }.into(),
                ]
            })
            .collect(),
    }
}
