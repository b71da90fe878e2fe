//! Estimate of a session: terminal tables, figures, and sections of the report.

pub(crate) mod messages;

pub(crate) use messages::{at_least, change_kind, combination, passed_mm, remedy};
pub use messages::{provisional_intervals, session_sentences, verdict};

use crate::format::{CI_HEAD, CI_LEGEND, plus_minus, plus_minus_cells};
use crate::text::{TerminalText, capitalised, or_dash, yes_no};
use crate::units::{in_units, in_units_of, name_in_table, of_heads, of_joint};
use crate::warnings::session_warnings;
use messages::{external_force, headline, online_inconsistent, reference};
use sinew_estimate::NuisanceChange;
use sinew_estimate::session::{BlockEstimate, OnlineTrajectory, SessionEstimate, TendonEstimate};
use sinew_figure::plot::{Band, Colour, Figure, Line, Panel};
use sinew_figure::{Block, Columns, Page, Table, probability, rounded};
use sinew_model::Gaussian;

/// Builds the columns with offset and elongation of every tendon, with names under `head`.
fn tendons<'a>(session: &'a SessionEstimate, head: &str) -> Columns<&'a TendonEstimate> {
    let heads = of_heads(session.joints.iter().map(|j| j.slides));
    Columns::of(&session.joints)
        .words(head, |j| name_in_table(&j.name, j.slides, heads))
        .columns(["offset\n(mrad)", CI_HEAD], |j| {
            plus_minus_cells(Some(j.offset_rad), 1e3)
        })
        .columns(["elongation\n(mm)", CI_HEAD], |j| {
            plus_minus_cells(j.elongation_m, 1e3)
        })
}

/// Tabulates the offsets of joints that several tendons or strands actuate together; `None` without any.
fn joint_offsets(session: &SessionEstimate) -> Option<Table> {
    let offsets = Some(&session.joint_offsets).filter(|offsets| !offsets.is_empty())?;
    let table = Columns::of(offsets)
        .words("joint", |j| &j.name)
        .columns(["joint offset\n(mrad)", CI_HEAD], |j| {
            plus_minus_cells(Some(j.offset_rad), 1e3)
        });
    Some(table.table())
}

/// Builds the columns with prior and posterior of nuisance parameters, under four headings.
pub(crate) fn nuisance_columns<'a>(
    changes: impl IntoIterator<Item = &'a NuisanceChange>,
    [of, parameter, before, after]: [&str; 4],
) -> Columns<&'a NuisanceChange> {
    Columns::of(changes)
        .words(of, |n| n.joint.clone().unwrap_or_default())
        .words(parameter, |n| {
            format!("{} {}", n.name, n.unit).trim_end().to_owned()
        })
        .column(before, |n| plus_minus(n.prior, 1.0))
        .column(after, |n| plus_minus(n.posterior, 1.0))
}

fn nuisance(session: &SessionEstimate, head: &str) -> Table {
    let heads = [head, "parameter", "prior\n± 95 %", "posterior\n± 95 %"];
    let table = nuisance_columns(&session.nuisance, heads);
    table.column("updated", |n| yes_no(n.moved)).table()
}

/// Renders the estimate of a session for a terminal, with names under `head`.
///
/// * `with_nuisance`: whether to list the nuisance parameters.
pub(crate) fn render(
    out: &mut TerminalText,
    session: &SessionEstimate,
    with_nuisance: bool,
    head: &str,
) {
    out.paragraph(reference(session));
    let table = tendons(session, head)
        .column("strain\n(%)", |j| {
            let [strain, _] = plus_minus_cells(j.strain_ratio, 100.0);
            strain
        })
        .column("result", |j| verdict(j.verdict));
    out.table(in_units_of(
        table.table(),
        of_heads(session.joints.iter().map(|j| j.slides)),
    ));
    out.paragraph(CI_LEGEND);
    out.add("\n");
    if let Some(offsets) = joint_offsets(session) {
        out.table(offsets);
        out.add("\n");
    }
    for line in session_sentences(session) {
        out.paragraph(line);
    }
    if let Some(online) = &session.online {
        out.add("\n");
        render_online(out, online, session, head);
    }
    if with_nuisance {
        out.add("\nnuisance parameters\n");
        out.table(nuisance(session, head));
    }
}

/// Renders the online estimate at the end of the recording.
fn render_online(
    out: &mut TerminalText,
    online: &OnlineTrajectory,
    session: &SessionEstimate,
    head: &str,
) {
    out.paragraph("Online estimate at the end of the recording");
    let heads = of_heads(session.joints.iter().map(|j| j.slides));
    // The online estimate does not contain tendons with friction along their path.
    let pairs = || {
        let joints = online.joints.iter();
        joints.filter_map(move |now| {
            let mut all = session.joints.iter();
            Some((now, all.find(|joint| joint.name == now.name)?))
        })
    };
    let table = Columns::of(pairs())
        .words(head, |(_, joint)| {
            name_in_table(&joint.name, joint.slides, heads)
        })
        .columns(["offset\n(mrad)", CI_HEAD], |(now, _)| {
            plus_minus_cells(Some(now.offset_rad), 1e3)
        })
        .column("stiffness change\n(probability)", |(now, _)| {
            or_dash(now.stiffness_changed_probability, probability)
        });
    out.table(in_units_of(table.table(), heads));
    out.add("\n");
    out.paragraph(provisional_intervals(online));
    let force = online.external_force.as_ref();
    if let Some(force) = force.filter(|f| f.is_reportable()) {
        out.paragraph(external_force(force));
    }
    let inconsistent = pairs().filter(|(now, joint)| {
        // The online estimate uses no reference contacts, so the batch estimate by motion is compared.
        let batch = (joint.anchored.as_ref()).map_or(joint.offset_rad, |a| a.by_motion_rad);
        let difference = Gaussian::new(
            now.offset_rad.mean - batch.mean,
            now.offset_rad.std.hypot(batch.std),
        );
        difference.is_nonzero_95()
    });
    let inconsistent: Vec<String> = inconsistent.map(|(now, _)| now.name.clone()).collect();
    if !inconsistent.is_empty() {
        out.paragraph(online_inconsistent(&inconsistent));
    }
}

/// Adds the sections of the session estimate to a report, with names under `head`.
pub(super) fn sections(page: Page, session: &SessionEstimate, head: &str) -> Page {
    let since = match &session.baseline {
        Some(baseline) => format!("Offsets relative to the baseline ({baseline})"),
        None => "Offsets relative to the encoder zero (no baseline)".into(),
    };
    let mut opening = vec![
        Block::Headlines(session.joints.iter().map(headline).collect()),
        Block::Paragraph(format!(
            "The offsets of all {head}s are estimated jointly with stiffness, masses, friction, encoder errors, temperature and payload. Times that are inconsistent with the model are rejected as contact or disturbance. ± is the half-width of the 95 % credible interval throughout this report."
        )),
        Block::Table(numbers(session, head)),
    ];
    opening.extend(joint_offsets(session).map(Block::Table));
    opening.push(Block::List(session_sentences(session)));
    if !session.warnings.is_empty() {
        let warnings = session_warnings(session);
        opening.push(Block::List(
            warnings.iter().map(ToString::to_string).collect(),
        ));
    }
    let mut page = page.section(since, opening);
    for (i, joint) in session.joints.iter().enumerate() {
        page = page.section(
            format!("{} {}: offset over time", capitalised(head), joint.name),
            vec![Block::Figure(
                Box::new(trajectory(session, i)),
                "Thin line: averages over 0.2 s after removal of all other estimated effects. Grey: rejected as contact or disturbance.".into(),
            )],
        );
    }
    let moved = session.nuisance.iter().filter(|n| n.moved).count();
    page.section(
        "Nuisance parameters",
        vec![
            Block::Paragraph(
                "Prior and posterior; ± is the half-width of the 95 % credible interval. Parameters not determined by the data keep their prior.".into(),
            ),
            Block::Folded(
                format!("{} parameters, {} updated by the data", session.nuisance.len(), moved),
                vec![nuisance(session, head).into()],
            ),
        ],
    )
}

/// Tabulates the results of all tendons for the report.
fn numbers(session: &SessionEstimate, head: &str) -> Table {
    let torques = |j: &&TendonEstimate| {
        let torque_nm = j.torque_nm;
        // All blocks of a joint may be excluded.
        match torque_nm.min <= torque_nm.max {
            true => format!(
                "{} to {}",
                rounded(torque_nm.min, 2),
                rounded(torque_nm.max, 2)
            ),
            false => "–".to_owned(),
        }
    };
    let table = tendons(session, head)
        .columns(["stiffness vs. robot.toml\n(%)", CI_HEAD], |j| {
            plus_minus_cells(Some(j.stiffness_change_ratio), 100.0)
        })
        .column("torque\n(N·m)", torques);
    in_units_of(
        table.table(),
        of_heads(session.joints.iter().map(|j| j.slides)),
    )
}

/// Plots the offset of a joint over the recording.
fn trajectory(session: &SessionEstimate, i: usize) -> Figure {
    Figure::new("")
        .size(820.0, 300.0)
        .seen(headline(&session.joints[i]).text)
        .panel(trajectory_panel(session, i))
}

/// Plots the offsets of all tendons over the recording.
pub(crate) fn trajectories(session: &SessionEstimate) -> Figure {
    let texts: Vec<String> = session.joints.iter().map(|j| headline(j).text).collect();
    let figure = Figure::new(capitalised(&reference(session))).seen(texts.join(". "));
    let last = session.joints.len().saturating_sub(1);
    let panels = session.joints.iter().enumerate().map(|(i, joint)| {
        let mut panel = trajectory_panel(session, i);
        panel.title.clone_from(&joint.name);
        if i < last {
            panel.x_label.clear();
        }
        panel
    });
    stacked(panels.fold(figure, Figure::panel))
}

/// Sets the size of a figure of stacked panels of equal height.
pub(crate) fn stacked(figure: Figure) -> Figure {
    const TITLE_AND_AXIS_PX: f64 = 70.0;
    const PANEL_PX: f64 = 150.0;
    let height_px = TITLE_AND_AXIS_PX + PANEL_PX * figure.panels.len() as f64;
    figure.size(820.0, height_px)
}

/// Plots the offset of a joint over the recording, with its events.
fn trajectory_panel(session: &SessionEstimate, i: usize) -> Panel {
    let joint = &session.joints[i];
    let blocks = &session.blocks;
    let times: Vec<f64> = blocks.iter().map(|b| b.time_s).collect();
    let of_blocks = |f: &dyn Fn(&BlockEstimate) -> f64| -> Vec<f64> {
        blocks.iter().map(|b| 1e3 * f(b)).collect()
    };
    let averages = of_blocks(&|b| match b.is_rejected() {
        true => f64::NAN,
        false => b.block_rad[i],
    });
    let estimate = of_blocks(&|b| b.offset_rad[i].mean);
    let low = of_blocks(&|b| b.offset_rad[i].interval_95().low);
    let high = of_blocks(&|b| b.offset_rad[i].interval_95().high);
    let unit = of_joint(joint.slides).offset;
    let averages = Line::new("0.2 s averages", times.clone(), averages);
    let label = in_units("offset δ_{e} (mrad)", of_joint(joint.slides));
    let mut panel = Panel::new("", "time (s)", label)
        .band(Band::new("95 % interval", times.clone(), low, high))
        .line(averages.colour(Colour::Black).width(0.7))
        .line(Line::new("estimate", times, estimate).step());
    for rejected in &session.rejected_intervals {
        panel = panel.span(rejected.from_s, rejected.to_s, "rejected");
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
    panel
}
