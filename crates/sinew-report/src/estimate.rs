//! The report of an estimate.

use super::figures;
use super::sentences::{doubt, headline};
use super::shown::{MRAD_PER_PERCENT, or_nan};
use super::units::{Moves, TURNS, in_units, name_in_table, of_heads};
use super::warnings::reading_warnings;
use super::words::{basis_row, joint_refusal, loss_reason};
use crate::log::format_name;
use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::{Estimate, JointEstimate, Loss};
use sinew_figure::{
    Block, Headline, Page, Table, count, duration, given, rounded, share, with_interval,
};
use sinew_files::date::utc_text;
use sinew_log::SignalSource;
use sinew_model::offset::{Comparison, TorqueSource};

/// The estimate as one HTML file that opens offline.
///
/// What it says, in this order: the answer, each joint in a sentence; what to be careful about; the
/// table; for every joint its figure; what the paper's equation reads; recording, robot and settings;
/// what each number rests on.
pub fn html(document: &EstimateDocument) -> String {
    page(document).html()
}

/// [`html`] before it is text.
pub fn page(document: &EstimateDocument) -> Page {
    let (estimate, session) = (&document.reading, document.session.as_ref());
    let mut page = Page::new(format!("Tendon stretch of {}", estimate.robot.name));
    page.subtitle = format!(
        "{}, {}, {} frames",
        estimate.recording.path,
        duration(estimate.recording.duration_s),
        count(estimate.recording.frames)
    );
    page.footer = format!("Made by Sinew {}", estimate.sinew_version);

    let mut opening = Vec::new();
    if estimate.damaged {
        opening.push(Block::Notice(
            "A part of the recording was damaged or could not be decoded. The estimate uses what could be read; the warnings say what was lost.".into(),
        ));
    }
    opening.push(Block::Headlines(
        estimate
            .joints
            .iter()
            .map(|j| Headline::from(headline(estimate, j)))
            .collect(),
    ));
    opening.push(Block::Paragraph(how_sure(estimate)));
    let mut page = match session {
        Some(session) => {
            let page = super::session::sections(page, session);
            page.section("What the paper's equation reads", opening)
        }
        None => page.section("", opening),
    };

    let mut numbers = vec![Block::Table(offsets(estimate))];
    if estimate.joints.iter().any(|j| j.difference.is_some()) {
        numbers.push(Block::Table(differences(estimate)));
    }
    numbers.push(Block::Paragraph(
        "Scatter: standard deviation of the single estimates. Standard error: of their mean, with the correlation from one to the next taken into account; ± is twice that, half a 95 % interval. All three speak of this recording only, not of an error in stiffness, masses, payload or contact, which moves all estimates alike.".into(),
    ));
    let doubts: Vec<String> = estimate.joints.iter().filter_map(doubt).collect();
    if !doubts.is_empty() {
        numbers.push(Block::List(doubts));
    }
    page = page.section("Numbers", numbers);

    let warnings: Vec<String> = reading_warnings(document);
    if !warnings.is_empty() {
        page = page.section("Warnings", vec![Block::List(warnings)]);
    }
    for joint in &estimate.joints {
        page = page.section(format!("Joint {}", joint.name), of_joint(estimate, joint));
    }
    page = page.section("Frames not used", losses(estimate));
    page = page.section(
        "Recording, robot and settings",
        vec![Block::Table(circumstances(estimate))],
    );
    page.section(
        "What each number rests on",
        vec![
            Block::Paragraph(
                "δe = (θ_measured − q) − τ_el / K;  elongation ΔL = r · δe;  strain ε = ΔL / L  (Kirchhoff and von Stryk, IROS 2018, eq. 4 to 7). θ_measured and q are the motor and joint positions, τ_el the elastic torque, K the stiffness, r the radius of the joint's pulley, L the tendon's length.".into(),
            ),
            Block::Table(Table {
                rows: estimate
                    .basis
                    .iter()
                    .map(|b| basis_row(estimate, b).to_vec())
                    .collect(),
                ..Table::default()
            }),
        ],
    )
}

fn how_sure(estimate: &Estimate) -> String {
    let masses = match estimate.settings.source {
        TorqueSource::TorqueSensor => "the torque sensor",
        TorqueSource::Motor => "the motor torque, its friction",
        TorqueSource::Observer => "the masses in the robot's description",
    };
    let absolute = format!(
        "The method is right in differences: what changed between two recordings of like motion. The absolute value rests on the stiffness and on {masses}, and on a payload and contacts being known; the table says what 1 % of error there adds."
    );
    match estimate.settings.reference {
        Some(_) => format!(
            "{absolute} These are differences to the reference recording; they are as sure as robot, payload and motion were alike."
        ),
        None => format!(
            "{absolute} Estimate again with --reference and an earlier recording to see what changed."
        ),
    }
}

/// Unit of an offset at a joint.
fn unit_of(estimate: &Estimate, joint: &str) -> &'static str {
    let found = estimate.joints.iter().find(|j| j.name == joint);
    found.map_or(TURNS, Moves::units).offset
}

fn offsets(estimate: &Estimate) -> Table {
    let head = [
        "joint",
        "offset δe, mrad",
        "scatter, mrad",
        "standard error, mrad",
        "elongation ± 95 %, mm",
        "strain, %",
        "frames used",
        "1 % too much stiffness adds, mrad",
    ];
    let heads = of_heads(&estimate.joints);
    Table {
        head: head.map(|h| in_units(h, heads)).to_vec(),
        rows: estimate
            .joints
            .iter()
            .map(|j| {
                let none = || "–".to_string();
                let optional = |v: Option<f64>| v.map_or_else(none, |v| rounded(v, 3));
                let error_mm = 1e3 * or_nan(j.elongation_standard_error_m);
                vec![
                    name_in_table(j, heads),
                    rounded(1e3 * or_nan(j.offset_rad), 4),
                    rounded(1e3 * or_nan(j.scatter_rad), 2),
                    rounded(1e3 * or_nan(j.standard_error_rad), 2),
                    j.elongation_m
                        .map_or_else(none, |m| with_interval(1e3 * m, error_mm)),
                    optional(j.strain_ratio.map(|strain| 100.0 * strain)),
                    share(j.usable_share),
                    rounded(
                        MRAD_PER_PERCENT * or_nan(j.offset_per_stiffness_error_rad),
                        2,
                    ),
                ]
            })
            .collect(),
        ..Table::default()
    }
}

fn differences(estimate: &Estimate) -> Table {
    let head = [
        "joint",
        "reference, mrad",
        "difference ± 95 %, mrad",
        "difference, mm",
        "1 % too much stiffness adds, mrad",
    ];
    let heads = of_heads(&estimate.joints);
    Table {
        caption: format!(
            "Difference to {}",
            estimate
                .settings
                .reference
                .as_deref()
                .unwrap_or("the reference")
        ),
        head: head.map(|h| in_units(h, heads)).to_vec(),
        rows: estimate
            .joints
            .iter()
            .filter_map(|j| j.difference.as_ref().map(|d| (j, d)))
            .map(|(j, d)| {
                vec![
                    name_in_table(j, heads),
                    rounded(1e3 * d.reference_rad, 4),
                    with_interval(1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad)),
                    d.elongation_m.map_or("–".into(), |m| rounded(1e3 * m, 3)),
                    rounded(MRAD_PER_PERCENT * d.offset_per_stiffness_error_rad, 2),
                ]
            })
            .collect(),
        ..Table::default()
    }
}

fn of_joint(estimate: &Estimate, joint: &JointEstimate) -> Vec<Block> {
    if let Some(why) = joint.refused {
        let why = joint_refusal(why);
        return vec![Block::Paragraph(format!("No estimate: {why}."))];
    }
    let (figure, caption) = figures::joint(estimate, joint);
    let tau_el = joint.tau_el_nm;
    let torque = joint.units().torque;
    let shown = |t: Option<f64>| rounded(or_nan(t), 3);
    let low = shown(tau_el.map(|t| t.min));
    let mean = shown(tau_el.map(|t| t.mean));
    let high = shown(tau_el.map(|t| t.max));
    let mut blocks = vec![
        Block::Figure(Box::new(figure), caption),
        Block::Paragraph(format!(
            "Stiffness {} {}; elastic torque from {low} to {high} {torque}, {mean} {torque} on average; {} of {} frames used ({}).",
            given(or_nan(joint.stiffness_nm_per_rad)),
            joint.units().stiffness,
            count(joint.usable_frames),
            count(estimate.recording.frames),
            share(joint.usable_share)
        )),
    ];
    if !joint.losses.is_empty() {
        blocks.push(loss_table("Why the others were not", &joint.losses));
    }
    blocks
}

fn losses(estimate: &Estimate) -> Vec<Block> {
    if estimate.losses.is_empty() {
        return vec![Block::Paragraph(
            "No frame was lost for all joints; what single joints could not use stands with them."
                .into(),
        )];
    }
    vec![loss_table("For any joint", &estimate.losses)]
}

fn loss_table(caption: &str, losses: &[Loss]) -> Block {
    Block::Table(
        Table::new(
            &["reason", "frames", "of all frames"],
            losses.iter().map(|l| {
                vec![
                    loss_reason(l.reason).into(),
                    count(l.frames),
                    share(l.share),
                ]
            }),
        )
        .captioned(caption),
    )
}

fn circumstances(estimate: &Estimate) -> Table {
    let (recording, robot, settings) = (&estimate.recording, &estimate.robot, &estimate.settings);
    let mut rows: Vec<[String; 2]> = Vec::new();
    let mut add = |name: &str, value: String| rows.push([name.to_string(), value]);
    add(
        "recording",
        format!("{} ({})", recording.path, format_name(recording.format)),
    );
    for SignalSource {
        quantity, source, ..
    } in &recording.sources
    {
        add(quantity.symbol(), format!("from {source}"));
    }
    if let Some(date) = utc_text(recording.start_time_ns) {
        add("begins", date);
    }
    add(
        "length",
        format!(
            "{}, {} frames at {} Hz, {}",
            duration(recording.duration_s),
            count(recording.frames),
            rounded(or_nan(recording.rate_hz), 4),
            match recording.segments {
                1 => "without a gap".to_string(),
                n => format!("in {n} parts with gaps between them"),
            }
        ),
    );
    add("robot", format!("{} ({})", robot.name, robot.file));
    add("URDF", robot.urdf.clone());
    add(
        "elastic torque from",
        match settings.source {
            TorqueSource::Observer => "the momentum observer".into(),
            TorqueSource::TorqueSensor => "the joint torque sensors".into(),
            TorqueSource::Motor => "the motor torque".into(),
        },
    );
    add(
        "comparison",
        match settings.comparison {
            Comparison::Matched => "matched: θ − q passes the same filters as the torque".into(),
            Comparison::Paper => "the paper's: θ − q unfiltered against a filtered torque".into(),
        },
    );
    add(
        "observer gain K_I",
        format!("{} 1/s", given(settings.gain_per_s)),
    );
    add(
        "velocities",
        match settings.velocity_filter_rad_per_s {
            Some(cutoff) => format!(
                "from positions, state-variable filter at {} rad/s",
                given(cutoff)
            ),
            None => "as recorded".into(),
        },
    );
    add(
        "external torque",
        if settings.tau_ext {
            "as recorded"
        } else {
            "taken as zero"
        }
        .into(),
    );
    for injection in &settings.injected {
        let from = injection
            .from_s
            .map_or(String::new(), |t| format!(" from {} on", duration(t)));
        add(
            "added by hand",
            format!(
                "{} {} at {}{from}",
                given(1e3 * injection.offset_rad),
                unit_of(estimate, &injection.joint),
                injection.joint
            ),
        );
    }
    if let Some(reference) = &settings.reference {
        add("reference", reference.clone());
    }
    Table {
        rows: rows.into_iter().map(Vec::from).collect(),
        ..Table::default()
    }
}
