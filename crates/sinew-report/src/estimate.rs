//! The report of an estimate.

use super::figures;
use super::reading::{differences, doubt, headline, readings};
use super::units::of_joint;
use super::warnings::reading_warnings;
use super::words::{joint_refusal, loss_reason, or_nan};
use crate::log::format_name;
use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::{Basis, Estimate, JointEstimate, Loss, Origin, Quantity};
use sinew_figure::{
    Block, Columns, Headline, Page, Table, count, duration, given, rounded, share, with_interval,
};
use sinew_files::date::utc_text;
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

    let stretch = |j: &JointEstimate| {
        let [mm, error] = [j.elongation_m, j.elongation_standard_error_m].map(|m| 1e3 * or_nan(m));
        with_interval(mm, error)
    };
    let mut numbers = vec![readings(estimate, ("stretch ± 95 %\nmm", stretch)).into()];
    let changes = differences(estimate);
    if !changes.rows.is_empty() {
        let reference = estimate.settings.reference.as_deref();
        let reference = reference.unwrap_or("the reference");
        let caption = format!("Difference to {reference}");
        numbers.push(changes.captioned(caption).into());
    }
    numbers.push(Block::Paragraph(
        "Scatter: standard deviation of the single estimates. Error: standard error of their mean, with the correlation from one to the next taken into account; ± is twice that, half a 95 % interval. All three speak of this recording only, not of an error in stiffness, masses, payload or contact, which moves all estimates alike. 1 % of K: what 1 % too much stiffness adds.".into(),
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
        page = page.section(
            format!("Joint {}", joint.name),
            joint_blocks(estimate, joint),
        );
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
            Table::facts(estimate.basis.iter().map(|b| basis_row(estimate, b))).into(),
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
    of_joint(found.is_some_and(|j| j.slides)).offset
}

fn joint_blocks(estimate: &Estimate, joint: &JointEstimate) -> Vec<Block> {
    if let Some(why) = joint.refused {
        let why = joint_refusal(why);
        return vec![Block::Paragraph(format!("No estimate: {why}."))];
    }
    let (figure, caption) = figures::joint(estimate, joint);
    let tau_el = joint.tau_el_nm;
    let torque = of_joint(joint.slides).torque;
    let shown = |t: Option<f64>| rounded(or_nan(t), 3);
    let low = shown(tau_el.map(|t| t.min));
    let mean = shown(tau_el.map(|t| t.mean));
    let high = shown(tau_el.map(|t| t.max));
    let mut blocks = vec![
        Block::Figure(Box::new(figure), caption),
        Block::Paragraph(format!(
            "Stiffness {} {}; elastic torque from {low} to {high} {torque}, {mean} {torque} on average; {} of {} frames used ({}).",
            given(or_nan(joint.stiffness_nm_per_rad)),
            of_joint(joint.slides).stiffness,
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
    Columns::of(losses)
        .column("reason", |l| loss_reason(l.reason))
        .column("frames", |l| count(l.frames))
        .column("of all frames", |l| share(l.share))
        .captioned(caption)
        .into()
}

fn circumstances(estimate: &Estimate) -> Table {
    let (recording, robot, settings) = (&estimate.recording, &estimate.robot, &estimate.settings);
    let format = format_name(recording.format);
    let mut rows = vec![("recording", format!("{} ({format})", recording.path))];
    let sources = recording.sources.iter();
    rows.extend(sources.map(|s| (s.quantity.symbol(), format!("from {}", s.source))));
    rows.extend(utc_text(recording.start_time_ns).map(|date| ("begins", date)));
    let (length, frames) = (duration(recording.duration_s), count(recording.frames));
    let rate = rounded(or_nan(recording.rate_hz), 4);
    let parts = match recording.segments {
        1 => "without a gap".to_string(),
        n => format!("in {n} parts with gaps between them"),
    };
    let torque = match settings.source {
        TorqueSource::Observer => "the momentum observer",
        TorqueSource::TorqueSensor => "the joint torque sensors",
        TorqueSource::Motor => "the motor torque",
    };
    let comparison = match settings.comparison {
        Comparison::Matched => "matched: θ − q passes the same filters as the torque",
        Comparison::Paper => "the paper's: θ − q unfiltered against a filtered torque",
    };
    let velocities = match settings.velocity_filter_rad_per_s.map(given) {
        Some(cutoff) => format!("from positions, state-variable filter at {cutoff} rad/s"),
        None => "as recorded".into(),
    };
    let external = match settings.tau_ext {
        true => "as recorded",
        false => "taken as zero",
    };
    rows.extend([
        (
            "length",
            format!("{length}, {frames} frames at {rate} Hz, {parts}"),
        ),
        ("robot", format!("{} ({})", robot.name, robot.file)),
        ("URDF", robot.urdf.clone()),
        ("elastic torque from", torque.into()),
        ("comparison", comparison.into()),
        (
            "observer gain K_I",
            format!("{} 1/s", given(settings.gain_per_s)),
        ),
        ("velocities", velocities),
        ("external torque", external.into()),
    ]);
    for injection in &settings.injected {
        let joint = &injection.joint;
        let from = injection.from_s.map(duration);
        let from = from.map_or(String::new(), |t| format!(" from {t} on"));
        let (size, unit) = (given(1e3 * injection.offset_rad), unit_of(estimate, joint));
        rows.push(("added by hand", format!("{size} {unit} at {joint}{from}")));
    }
    rows.extend(settings.reference.clone().map(|file| ("reference", file)));
    Table::facts(rows)
}

/// A quantity with its unit, and what it rests on.
fn basis_row(estimate: &Estimate, basis: &Basis) -> (&'static str, String) {
    let quantity = match basis.quantity {
        Quantity::Positions => "motor and joint positions, rad",
        Quantity::ElasticTorque => "elastic torque, N·m",
        Quantity::Transmission => "stiffness, N·m/rad; friction; tendon geometry, mm",
        Quantity::ExternalTorque => "external torque, N·m",
        Quantity::Offset => "offset, mrad; elongation, mm; strain, %",
    };
    let file = &estimate.robot.file;
    let rests_on = match (basis.rests_on, basis.quantity) {
        (Origin::Measured, Quantity::ElasticTorque) => {
            "measured by the joint torque sensors, in the recording".into()
        }
        (Origin::Measured, _) => "measured, in the recording".into(),
        (Origin::Observed, _) => format!(
            "computed by the momentum observer from the positions and the masses of {}; not measured",
            estimate.robot.urdf
        ),
        (Origin::MotorTorque, _) => format!(
            "computed from the recorded motor torque, motor inertia and friction of {file}"
        ),
        (Origin::Stated, _) => format!("as stated in {file}; not fitted to this recording"),
        (Origin::TakenAsKnown, _) => "as recorded, taken as known".into(),
        (Origin::Estimated, _) => "the estimate; its standard error covers the scatter within this recording, not an error of stiffness, masses or payload: differences between recordings of like motion are surer than absolute values".into(),
    };
    (quantity, rests_on)
}
