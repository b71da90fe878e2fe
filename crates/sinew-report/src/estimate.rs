//! HTML report of an estimate.

use super::figures;
use super::format::{name_head, or_nan};
use super::session::trajectories;
use super::text::capitalised;
use super::uncorrected::{
    differences, equivalent_error, headline, joint_error, loss_reason, offsets,
};
use super::units::of_joint;
use super::warnings::recording_warnings;
use crate::log::format_name;
use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::{Basis, Estimate, JointEstimate, Loss, Origin, Quantity};
use sinew_figure::plot::Figure;
use sinew_figure::{
    Block, Columns, Headline, Page, Table, count, duration, given, rounded, share, with_interval,
};
use sinew_files::date::utc_text;
use sinew_model::offset::{Comparison, TorqueSource};

/// Renders an estimate as one HTML file without external resources.
///
/// Sections: absolute estimate (if there is one), uncorrected estimate, values, warnings, one section per joint with its
/// figure, excluded frames, recording and settings, origin of the values.
pub fn html(document: &EstimateDocument) -> String {
    page(document).html()
}

/// Plots the offsets of all tendons over the recording: of the session if there is one, else uncorrected.
pub fn figure(document: &EstimateDocument) -> Figure {
    match &document.session {
        Some(session) => trajectories(session),
        None => figures::offsets(&document.reading),
    }
}

/// Builds the page of [`html`].
pub fn page(document: &EstimateDocument) -> Page {
    let (estimate, session) = (&document.reading, document.session.as_ref());
    let mut page = Page::new(format!("Tendon elongation of {}", estimate.robot.name));
    page.subtitle = format!(
        "{}, {}, {} frames",
        estimate.recording.path,
        duration(estimate.recording.duration_s),
        count(estimate.recording.frames)
    );
    page.footer = format!("Sinew {}", estimate.sinew_version);

    let mut opening = Vec::new();
    if estimate.damaged {
        opening.push(Block::Notice(
            "The recording is partly damaged or not decodable. The estimate uses the readable part; the warnings state the data lost.".into(),
        ));
    }
    opening.push(Block::Headlines(
        estimate
            .joints
            .iter()
            .map(|j| Headline::from(headline(estimate, j)))
            .collect(),
    ));
    opening.push(Block::Paragraph(validity(estimate)));
    let mut page = match session {
        Some(session) => {
            let page = super::session::sections(page, session, name_head(&estimate.robot));
            page.section("Uncorrected estimate (paper)", opening)
        }
        None => page.section("", opening),
    };

    let elongation = |j: &JointEstimate| {
        let [mm, error] = [j.elongation_m, j.elongation_standard_error_m].map(|m| 1e3 * or_nan(m));
        with_interval(mm, error)
    };
    let mut numbers = vec![offsets(estimate, ("elongation ± 95 %\n(mm)", elongation)).into()];
    let changes = differences(estimate);
    if !changes.rows.is_empty() {
        let reference = estimate.settings.reference.as_deref();
        let reference = reference.unwrap_or("the reference");
        let caption = format!("Change relative to {reference}");
        numbers.push(changes.captioned(caption).into());
    }
    numbers.push(Block::Paragraph(
        "Scatter: standard deviation of the estimates of single frames. Std. error: standard error of their mean, including autocorrelation; ± is the half-width of the 95 % confidence interval. None of them covers errors of stiffness, masses, payload or contact, which are common to all frames. 1 % of K: change of the offset for a stiffness error of 1 %.".into(),
    ));
    let explanations: Vec<String> = estimate
        .joints
        .iter()
        .filter_map(equivalent_error)
        .collect();
    if !explanations.is_empty() {
        numbers.push(Block::List(explanations));
    }
    page = page.section("Values", numbers);

    let warnings = recording_warnings(document);
    if !warnings.is_empty() {
        let warnings = warnings.iter().map(ToString::to_string).collect();
        page = page.section("Warnings", vec![Block::List(warnings)]);
    }
    for joint in &estimate.joints {
        page = page.section(
            format!("{} {}", capitalised(name_head(&estimate.robot)), joint.name),
            joint_blocks(estimate, joint),
        );
    }
    page = page.section("Excluded frames", losses(estimate));
    page = page.section(
        "Recording, robot and settings",
        vec![Block::Table(circumstances(estimate))],
    );
    page.section(
        "Origin of the values",
        vec![
            Block::Paragraph(
                "δe = (θ_measured − q) − τ_el / K;  elongation ΔL = r · δe;  strain ε = ΔL / L  (Kirchhoff and von Stryk, IROS 2018, eq. 4 to 7). θ_measured and q are the motor and joint positions, τ_el the elastic torque, K the stiffness, r the radius of the joint pulley, L the tendon length.".into(),
            ),
            Table::facts(estimate.basis.iter().map(|b| basis_row(estimate, b))).into(),
        ],
    )
}

/// States the assumptions under which the uncorrected estimate is valid.
fn validity(estimate: &Estimate) -> String {
    let masses = match estimate.settings.source {
        TorqueSource::TorqueSensor => "the torque sensor",
        TorqueSource::Motor => "the motor torque and its friction",
        TorqueSource::Observer => "the masses of the robot description",
    };
    let absolute = format!(
        "The method is accurate for differences between two recordings with comparable motion. The absolute value depends on the stiffness, on {masses}, and on known payload and contacts; the table lists the effect of an error of 1 %."
    );
    match estimate.settings.reference {
        Some(_) => format!(
            "{absolute} The changes relative to the reference recording are valid if robot, payload and motion were comparable."
        ),
        None => {
            format!("{absolute} For the change since an earlier recording, use --reference LOG.")
        }
    }
}

/// Unit of the offset of a joint.
fn unit_of(estimate: &Estimate, joint: &str) -> &'static str {
    let found = estimate.joints.iter().find(|j| j.name == joint);
    of_joint(found.is_some_and(|j| j.slides)).offset
}

fn joint_blocks(estimate: &Estimate, joint: &JointEstimate) -> Vec<Block> {
    if let Some(reason) = joint.reason {
        let reason = joint_error(reason);
        return vec![Block::Paragraph(format!("No estimate: {reason}."))];
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
            "Stiffness {} {}; elastic torque {low} to {high} {torque}, mean {mean} {torque}; {} of {} frames used ({}).",
            given(or_nan(joint.stiffness_nm_per_rad)),
            of_joint(joint.slides).stiffness,
            count(joint.usable_frames),
            count(estimate.recording.frames),
            share(joint.usable_share)
        )),
    ];
    if !joint.losses.is_empty() {
        blocks.push(loss_table("Excluded frames", &joint.losses));
    }
    blocks
}

fn losses(estimate: &Estimate) -> Vec<Block> {
    if estimate.losses.is_empty() {
        return vec![Block::Paragraph(
            "No frame was excluded for all joints; see the sections of the joints.".into(),
        )];
    }
    vec![loss_table("For all joints", &estimate.losses)]
}

fn loss_table(caption: &str, losses: &[Loss]) -> Block {
    Columns::of(losses)
        .column("reason", |l| loss_reason(l.reason))
        .column("frames", |l| count(l.frames))
        .column("share", |l| share(l.share))
        .captioned(caption)
        .into()
}

fn circumstances(estimate: &Estimate) -> Table {
    let (recording, robot, settings) = (&estimate.recording, &estimate.robot, &estimate.settings);
    let format = format_name(recording.format);
    let mut rows = vec![("recording", format!("{} ({format})", recording.path))];
    let sources = recording.sources.iter();
    rows.extend(sources.map(|s| (s.quantity.symbol(), format!("from {}", s.source))));
    rows.extend(utc_text(recording.start_time_ns).map(|date| ("start", date)));
    let (length, frames) = (duration(recording.duration_s), count(recording.frames));
    let rate = rounded(or_nan(recording.rate_hz), 4);
    let parts = match recording.segments {
        1 => "1 segment".to_string(),
        n => format!("{n} segments separated by gaps"),
    };
    let torque = match settings.source {
        TorqueSource::Observer => "momentum observer",
        TorqueSource::TorqueSensor => "joint torque sensors",
        TorqueSource::Motor => "motor torque",
    };
    let comparison = match settings.comparison {
        Comparison::Matched => "matched: θ − q filtered like the torque",
        Comparison::Paper => "paper: θ − q unfiltered, torque filtered",
    };
    let velocities = match settings.velocity_filter_rad_per_s.map(given) {
        Some(cutoff) => format!("from positions, state-variable filter, cut-off {cutoff} rad/s"),
        None => "as recorded".into(),
    };
    let external = match settings.tau_ext {
        true => "as recorded",
        false => "assumed zero",
    };
    rows.extend([
        (
            "duration",
            format!("{length}, {frames} frames at {rate} Hz, {parts}"),
        ),
        ("robot", format!("{} ({})", robot.name, robot.file)),
        ("URDF", robot.urdf.clone()),
        ("elastic torque", torque.into()),
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
        rows.push(("injected offset", format!("{size} {unit} at {joint}{from}")));
    }
    rows.extend(settings.reference.clone().map(|file| ("reference", file)));
    Table::facts(rows)
}

/// Names a quantity with its unit, and its origin.
fn basis_row(estimate: &Estimate, basis: &Basis) -> (&'static str, String) {
    let quantity = match basis.quantity {
        Quantity::Positions => "motor and joint positions, rad",
        Quantity::ElasticTorque => "elastic torque, N·m",
        Quantity::Transmission => "stiffness, N·m/rad; friction; tendon geometry, mm",
        Quantity::ExternalTorque => "external torque, N·m",
        Quantity::Offset => "offset, mrad; elongation, mm; strain, %",
    };
    let file = &estimate.robot.file;
    let based_on = match (basis.based_on, basis.quantity) {
        (Origin::Measured, Quantity::ElasticTorque) => {
            "measured by joint torque sensors in the recording".into()
        }
        (Origin::Measured, _) => "measured in the recording".into(),
        (Origin::Observed, _) => format!(
            "computed by the momentum observer from the positions and the masses of {}",
            estimate.robot.urdf
        ),
        (Origin::MotorTorque, _) => format!(
            "computed from the recorded motor torque, and the motor inertia and friction of {file}"
        ),
        (Origin::Stated, _) => format!("as specified in {file}; not fitted to this recording"),
        (Origin::AssumedExact, _) => "as recorded, assumed exact".into(),
        (Origin::Estimated, _) => "estimated; the standard error covers the scatter within this recording, not errors of stiffness, masses or payload; differences between recordings with comparable motion are more accurate than absolute values".into(),
    };
    (quantity, based_on)
}
