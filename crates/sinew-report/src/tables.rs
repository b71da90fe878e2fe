//! What a terminal of 80 columns shows of an estimate: tables and paragraphs.

use super::sentences::headline;
use super::session_sentences::session_sentences;
use super::shown::{MRAD_PER_PERCENT, or_nan};
use super::text::{paragraph, plain, table};
use super::units::{Units, in_units, name_in_table, of_heads};
use super::words::{loss_reason, newtons, plus_minus, plus_minus_cells};
use sinew_estimate::baseline::MergeSummary;
use sinew_estimate::replay::{Estimate, JointEstimate, Loss};
use sinew_estimate::session::{LiveCourse, SessionEstimate, TendonEstimate, Verdict};
use sinew_estimate::{EstimateDocument, NuisanceChange};
use sinew_figure::{rounded, with_interval};
use sinew_files::names;
use sinew_log::SignalSource;
use sinew_model::Gaussian;

/// A paragraph whose following lines are indented.
fn words(text: &str) -> String {
    paragraph(&plain(text), 2)
}

/// A table whose cells may hold names from files.
fn cells(head: &[&str], rows: Vec<Vec<String>>, names: usize) -> String {
    let row = |row: Vec<String>| row.iter().map(|cell| plain(cell)).collect();
    table(head, rows.into_iter().map(row).collect(), names)
}

/// A word in the table's language for what isn't there.
fn optional(x: Option<f64>, digits: u8) -> String {
    x.map_or("–".to_string(), |x| rounded(x, digits))
}

/// One answer: the session's, with everything estimated along where `nuisance` asks for it, or the
/// paper's reading.
pub fn document(document: &EstimateDocument, nuisance: bool) -> String {
    let recording = recording(&document.reading);
    match &document.session {
        Some(answer) => recording + &session(answer, nuisance),
        None => recording + &reading(&document.reading),
    }
}

/// What was read, in a line.
fn recording(e: &Estimate) -> String {
    let r = &e.recording;
    words(&format!(
        "{}: {}, {} s, {} frames at {} Hz",
        e.robot.name,
        r.path,
        rounded(r.duration_s, 4),
        r.frames,
        rounded(or_nan(r.rate_hz), 4)
    ))
}

/// Where everything was taken from, a line each.
pub fn taken(e: &Estimate) -> Vec<String> {
    let robot = format!("robot from {}, URDF from {}", e.robot.file, e.robot.urdf);
    let sources = e.recording.sources.iter();
    let source = |s: &SignalSource| format!("{} from {}", s.quantity.symbol(), s.source);
    [vec![robot], sources.map(source).collect()].concat()
}

/// The paper's reading.
fn reading(e: &Estimate) -> String {
    let mut out = String::new();
    let head = [
        "joint",
        "reading\nmrad",
        "error\nmrad",
        "scatter\nmrad",
        "stretch\nmm",
        "strain\n%",
        "used\n%",
        "1 % of K\nmrad",
    ];
    let heads = of_heads(&e.joints);
    let row = |j: &JointEstimate| joint_row(j, heads);
    out += &in_units_of(&head, heads, e.joints.iter().map(row).collect());
    out.push('\n');
    let changed_row = |j: &JointEstimate| difference_row(j, heads);
    let changes: Vec<_> = e.joints.iter().filter_map(changed_row).collect();
    let changed = !changes.is_empty();
    if changed {
        let head = [
            "joint",
            "reference\nmrad",
            "change\n± 95 %, mrad",
            "change\nmm",
            "1 % of K\nmrad",
        ];
        out += &in_units_of(&head, heads, changes);
        out.push('\n');
    }
    let headlines = e.joints.iter().map(|joint| words(&headline(e, joint)));
    out.extend(headlines);
    out.push('\n');
    out.extend(losses(e).iter().map(|loss| words(loss)));
    let rest = if changed {
        "The change is right as far as robot, payload and motion were alike."
    } else {
        "A reading takes stiffness, masses, payload and contact as known: it is no verdict. --method absolute gives one, --reference LOG2 shows what changed."
    };
    out + &paragraph(rest, 0)
}

/// A table whose heads name the units of joints that turn, in those that the joints have.
fn in_units_of(head: &[&str], units: Units, rows: Vec<Vec<String>>) -> String {
    let head: Vec<String> = head.iter().map(|h| in_units(h, units)).collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    cells(&head, rows, 1)
}

fn joint_row(j: &JointEstimate, heads: Units) -> Vec<String> {
    vec![
        name_in_table(j, heads),
        rounded(1e3 * or_nan(j.offset_rad), 4),
        rounded(1e3 * or_nan(j.standard_error_rad), 2),
        rounded(1e3 * or_nan(j.scatter_rad), 2),
        optional(j.elongation_m.map(|m| 1e3 * m), 3),
        optional(j.strain_ratio.map(|strain| 100.0 * strain), 3),
        format!("{:.1}", 100.0 * j.usable_share),
        rounded(
            MRAD_PER_PERCENT * or_nan(j.offset_per_stiffness_error_rad),
            2,
        ),
    ]
}

/// What changed since the reference; `None` without one.
fn difference_row(j: &JointEstimate, heads: Units) -> Option<Vec<String>> {
    let d = j.difference.as_ref()?;
    Some(vec![
        name_in_table(j, heads),
        rounded(1e3 * d.reference_rad, 4),
        with_interval(1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad)),
        optional(d.elongation_m.map(|m| 1e3 * m), 3),
        rounded(MRAD_PER_PERCENT * d.offset_per_stiffness_error_rad, 2),
    ])
}

/// What was not used, joint by joint; what every joint lost stands at the end, once.
fn losses(e: &Estimate) -> Vec<String> {
    let frames = |loss: &Loss| match loss.frames {
        1 => "1 frame".to_string(),
        n => format!("{n} frames"),
    };
    let mut out = Vec::new();
    for joint in &e.joints {
        for loss in joint.losses.iter().filter(|l| !e.losses.contains(l)) {
            out.push(format!(
                "not used: {} ({:.1} %) of {}, {}",
                frames(loss),
                100.0 * loss.share,
                joint.name,
                loss_reason(loss.reason)
            ));
        }
    }
    let of_all = e.losses.iter();
    out.extend(of_all.map(|l| format!("not used: {}, {}", frames(l), loss_reason(l.reason))));
    out
}

/// The session's estimate; with everything estimated along where `nuisance` asks for it.
fn session(session: &SessionEstimate, nuisance: bool) -> String {
    let since = match &session.baseline {
        Some(first) => format!("since {first}"),
        None => "against the encoders' zero".into(),
    };
    let mut out = words(&format!("offsets {since}, with 95 % intervals"));
    let head = [
        "joint",
        "offset\nmrad",
        "± (95 %)\nmrad",
        "stretch\nmm",
        "± (95 %)\nmm",
        "strain\n%",
        "verdict",
    ];
    let heads = of_heads(&session.joints);
    let row = |j: &TendonEstimate| tendon_row(j, heads);
    out += &in_units_of(&head, heads, session.joints.iter().map(row).collect());
    out.push('\n');
    out.extend(session_sentences(session).iter().map(|line| words(line)));
    if let Some(course) = &session.live {
        out.push('\n');
        out += &live(course, session);
    }
    if nuisance {
        let row = |n: &NuisanceChange| {
            let mut row = nuisance_row(n);
            row.push(if n.moved { "yes" } else { "no" }.into());
            row
        };
        let head = [
            "joint",
            "parameter",
            "before\n± 95 %",
            "after\n± 95 %",
            "moved",
        ];
        out.push('\n');
        out += &cells(&head, session.nuisance.iter().map(row).collect(), 2);
    }
    out
}

/// What the form beside a running robot made of it.
fn live(course: &LiveCourse, session: &SessionEstimate) -> String {
    let mut out = words("Block by block, as beside the running robot, at the end");
    let head = [
        "joint",
        "offset\nmrad",
        "± (95 %)\nmrad",
        "stiffness changed\nprobability, %",
    ];
    let heads = of_heads(&session.joints);
    let rows = course
        .joints
        .iter()
        .zip(&session.joints)
        .map(|(now, joint)| {
            let [offset, half] = plus_minus_cells(Some(now.offset_rad), 1e3);
            let probability = now.stiffness_changed_probability.map(|p| 100.0 * p);
            vec![
                name_in_table(joint, heads),
                offset,
                half,
                optional(probability, 2),
            ]
        });
    out += &in_units_of(&head, heads, rows.collect());
    out.push('\n');
    out += &words(&doubts(course));
    let force = course.external_force.as_ref();
    out.extend(force.filter(|f| f.is_worth_a_word()).map(|force| {
        let what = match force.is_stated {
            true => "The constant force from outside, which was stated, is".into(),
            false => format!(
                "A constant force from outside acts ({:.0} % likely):",
                100.0 * force.probability
            ),
        };
        let newtons = newtons(force.force_n);
        words(&format!("{what} {newtons} N along x, y and z of the base"))
    }));
    let apart = (course.joints.iter().zip(&session.joints)).filter(|(now, joint)| {
        // By motion alone, as it reads no stop and no mark.
        let batch = (joint.anchored.as_ref()).map_or(joint.offset_rad, |a| a.by_motion_rad);
        let off = Gaussian::new(
            now.offset_rad.mean - batch.mean,
            now.offset_rad.deviation.hypot(batch.deviation),
        );
        off.is_nonzero_95()
    });
    let apart: Vec<String> = apart.map(|(now, _)| now.name.clone()).collect();
    if !apart.is_empty() {
        out += &words(&format!(
            "At {} it contradicts the estimate above. Believe that: this form sees no later data",
            names::list(&apart)
        ));
    }
    out
}

/// When a course was in doubt, in a sentence.
pub fn doubts(course: &LiveCourse) -> String {
    let spans = course.doubts.iter().map(|d| {
        let [from, to] = [d.from_s, d.to_s].map(|s| rounded(s, 3));
        format!("{from} to {to} s")
    });
    let spans: Vec<String> = spans.collect();
    match (&spans[..], course.in_doubt) {
        ([], _) => "It was never in doubt".into(),
        (_, true) => format!(
            "In doubt from {}, and so at the end: the batch above goes over all of it",
            spans.join(", ")
        ),
        (_, false) => format!("In doubt from {}", spans.join(", ")),
    }
}

fn tendon_row(j: &TendonEstimate, heads: Units) -> Vec<String> {
    let [offset, offset_half] = plus_minus_cells(Some(j.offset_rad), 1e3);
    let [elongation, elongation_half] = plus_minus_cells(j.elongation_m, 1e3);
    let [strain, _] = plus_minus_cells(j.strain_ratio, 100.0);
    vec![
        name_in_table(j, heads),
        offset,
        offset_half,
        elongation,
        elongation_half,
        strain,
        verdict(j.verdict).into(),
    ]
}

/// A verdict in a word or two.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Longer => "longer",
        Verdict::Shorter => "shorter",
        Verdict::Unchanged => "unchanged",
        Verdict::CannotTell => "can't tell",
    }
}

fn nuisance_row(n: &NuisanceChange) -> Vec<String> {
    vec![
        n.joint.clone().unwrap_or_default(),
        format!("{} {}", n.name, n.unit).trim_end().to_string(),
        plus_minus(n.prior, 1.0),
        plus_minus(n.posterior, 1.0),
    ]
}

/// What a recording right after tensioning taught.
pub fn baseline(learned: &SessionEstimate) -> String {
    let row = |j: &TendonEstimate| {
        let [change, half] = plus_minus_cells(Some(j.stiffness_change_ratio), 100.0);
        vec![j.name.clone(), change, half]
    };
    let head = ["joint", "stiffness against robot.toml\n%", "± (95 %)\n%"];
    words(&format!(
        "{}: {} s, {} poses, {:.0} % left out as disturbed",
        learned.recording,
        rounded(learned.duration_s, 4),
        learned.poses,
        100.0 * learned.left_out_share
    )) + &cells(&head, learned.joints.iter().map(row).collect(), 1)
        + "\n"
}

/// What several baselines taught together.
pub fn merged(summary: &MergeSummary, files: usize) -> String {
    let moved = || summary.nuisance.iter().filter(|m| m.moved);
    let head = [
        "joint or link",
        "parameter",
        "at the start\n± 95 %",
        "now\n± 95 %",
    ];
    words(&format!(
        "{}: {files} files, {} recordings; {} of {} parameters are surer by a fifth or have moved",
        summary.robot,
        summary.recordings.len(),
        moved().count(),
        summary.nuisance.len()
    )) + &cells(&head, moved().map(nuisance_row).collect(), 2)
        + "\n"
}
