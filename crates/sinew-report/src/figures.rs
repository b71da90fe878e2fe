//! Figure of one joint of the uncorrected estimate: offset, torque, motion.

use super::format::or_nan;
use super::session::stacked;
use super::uncorrected::headline;
use super::units::{in_units, of_joint};
use sinew_estimate::replay::{Estimate, JointEstimate, Series};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};
use sinew_figure::{duration, given, rounded};
use sinew_model::offset::TorqueSource;

/// Maximum number of shaded unused intervals.
const MAX_SPANS: usize = 60;

/// Maximum number of intervals of a figure, about two pixels each.
const MAX_INTERVALS: usize = 350;

/// Plots a joint; returns the figure and its caption.
pub(super) fn joint(estimate: &Estimate, joint: &JointEstimate) -> (Figure, String) {
    let series = &coarse(&joint.series);
    let (unit, seconds) = time_unit(estimate.recording.duration_s);
    let time: Vec<f64> = series.time_s.iter().map(|t| t / seconds).collect();
    let end = estimate.recording.duration_s / seconds;
    let framed = |panel: Panel| match end.is_finite() && end > 0.0 {
        true => panel.x_range(0.0, end),
        false => panel,
    };
    let label = format!("time ({unit})");

    let (range, outside) = offset_range(series, joint);
    let units = of_joint(joint.slides);
    let unit = units.offset;
    let lows = mrad(&series.offset_min_rad);
    let spread = Band::new(
        "minimum to maximum",
        time.clone(),
        lows,
        mrad(&series.offset_max_rad),
    );
    let mean = Line::new("estimate", time.clone(), mrad(&series.offset_rad));
    let offset_label = in_units("offset δ_{e} (mrad)", units);
    let mut offset = framed(Panel::new("Offset", "", offset_label)).weight(1.35);
    offset = offset.band(spread).line(mean);
    if let Some((low, high)) = range {
        offset = offset.y_range(low, high);
    }
    for (from, to) in unused(series, &time) {
        offset = offset.span(from, to, "not used");
    }
    for injection in &estimate.settings.injected {
        if injection.joint == joint.name
            && let Some(from) = injection.from_s
        {
            let size = given(1e3 * injection.offset_rad);
            offset = offset.event(from / seconds, format!("{size} {unit} injected"));
        }
    }
    if let Some(mean_mrad) = joint.offset_rad.map(|x| 1e3 * x) {
        let mean = format!("mean {} {unit}", rounded(mean_mrad, 3));
        offset = offset.reference(mean_mrad, mean);
    }
    if let Some(d) = &joint.difference {
        let reference = format!("reference {} {unit}", rounded(1e3 * d.reference_rad, 3));
        offset = offset.reference(1e3 * d.reference_rad, reference);
    }
    let per_mrad = or_nan(joint.elongation_m) / or_nan(joint.offset_rad);
    if per_mrad.is_finite() {
        offset = offset.y_right("elongation (mm)", per_mrad);
    }

    let source = match estimate.settings.source {
        TorqueSource::TorqueSensor => "measured τ_{el}",
        TorqueSource::Motor => "τ_{el} from motor torque",
        TorqueSource::Observer => "observed τ_{el}",
    };
    let torques = Line::new(source, time.clone(), series.tau_el_nm.clone());
    let encoders = "encoders: K(θ_{measured} − q)";
    let spring = Line::new(encoders, time.clone(), series.tau_spring_nm.clone());
    let torque = framed(Panel::new("Torque", "", in_units("torque (N·m)", units)))
        .line(torques)
        .line(spring.colour(Colour::Orange).dash(Dash::Dashed));
    let q = Line::new("", time, series.q_rad.clone()).colour(Colour::Black);
    let position = format!("q ({})", units.position);
    let motion = framed(Panel::new("Motion", label, position))
        .weight(0.75)
        .line(q);
    let figure = Figure::new("")
        .seen(headline(estimate, joint))
        .size(820.0, 560.0)
        .panel(offset)
        .panel(torque)
        .panel(motion);

    let interval = match series.time_s.as_slice() {
        [first, second, ..] => second - first,
        _ => estimate.recording.duration_s,
    };
    let caption = format!(
        "Averages over {}. A difference of the two torques beyond their lag indicates an offset.{outside}",
        duration(interval)
    );
    (figure, caption)
}

/// Plots the uncorrected offsets of all estimated joints.
pub(super) fn offsets(estimate: &Estimate) -> Figure {
    let joints = || estimate.joints.iter().filter(|j| j.reason.is_none());
    let texts: Vec<String> = joints().map(|j| headline(estimate, j)).collect();
    let figure = Figure::new("Uncorrected offsets").seen(texts.join(". "));
    let panels = joints().filter_map(|j| {
        let mut panels = self::joint(estimate, j).0.panels.into_iter();
        let mut offset = panels.next()?;
        offset.title.clone_from(&j.name);
        Some((offset, panels.next_back()?.x_label))
    });
    let mut panels: Vec<(Panel, String)> = panels.collect();
    if let Some((last, label)) = panels.last_mut() {
        last.x_label.clone_from(label);
    }
    stacked(
        panels
            .into_iter()
            .fold(figure, |figure, (panel, _)| figure.panel(panel)),
    )
}

fn mrad(rad: &[f64]) -> Vec<f64> {
    rad.iter().map(|x| 1e3 * x).collect()
}

fn time_unit(duration_s: f64) -> (&'static str, f64) {
    match duration_s {
        d if d > 3.0 * 3600.0 => ("h", 3600.0),
        d if d > 600.0 => ("min", 60.0),
        _ => ("s", 1.0),
    }
}

/// Returns the range of the offset axis, and a sentence for the caption about values outside it.
///
/// The range contains all means and 98 % of the band, so that single spikes do not flatten the curve.
fn offset_range(series: &Series, joint: &JointEstimate) -> (Option<(f64, f64)>, String) {
    let finite = |v: &[f64]| -> Vec<f64> {
        let mut v: Vec<f64> = mrad(v).into_iter().filter(|x| x.is_finite()).collect();
        v.sort_by(f64::total_cmp);
        v
    };
    let means = finite(&series.offset_rad);
    let (lows, highs) = (
        finite(&series.offset_min_rad),
        finite(&series.offset_max_rad),
    );
    let (Some(&mean_low), Some(&mean_high)) = (means.first(), means.last()) else {
        return (None, String::new());
    };
    let at = |v: &[f64], share: f64| {
        let place = (share * v.len().saturating_sub(1) as f64) as usize;
        v.get(place).copied()
    };
    let mut low = mean_low.min(at(&lows, 0.01).unwrap_or(mean_low));
    let mut high = mean_high.max(at(&highs, 0.99).unwrap_or(mean_high));
    if let Some(d) = &joint.difference {
        low = low.min(1e3 * d.reference_rad);
        high = high.max(1e3 * d.reference_rad);
    }
    let margin = 0.08 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let min = lows.first().copied().unwrap_or(low);
    let max = highs.last().copied().unwrap_or(high);
    // Report only values outside by at least a fifth of the axis.
    let margin = 0.2 * (high - low);
    let outside = if min < low - margin || max > high + margin {
        let [min, max] = [min, max].map(|x| rounded(x, 3));
        let unit = of_joint(joint.slides).offset;
        format!(
            " Single estimates range from {min} to {max} {unit}; the axis omits the outermost 1 %."
        )
    } else {
        String::new()
    };
    ((low < high).then_some((low, high)), outside)
}

/// Returns intervals without a usable frame; if there are too many, the longest.
fn unused(series: &Series, time: &[f64]) -> Vec<(f64, f64)> {
    let half = match time {
        [first, second, ..] => 0.5 * (second - first),
        _ => return Vec::new(),
    };
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut pending: Option<(f64, f64)> = None;
    for (&t, &share) in time.iter().zip(&series.usable_share) {
        if share > 0.0 {
            spans.extend(pending.take());
        } else {
            pending = Some((pending.map_or(t - half, |p| p.0), t + half));
        }
    }
    spans.extend(pending);
    if spans.len() > MAX_SPANS {
        spans.sort_by(|a, b| (b.1 - b.0).total_cmp(&(a.1 - a.0)));
        spans.truncate(MAX_SPANS);
    }
    spans
}

/// Averages the series over at most [`MAX_INTERVALS`] intervals: minimum and maximum are those of all values.
fn coarse(series: &Series) -> Series {
    let group = series.time_s.len().div_ceil(MAX_INTERVALS).max(1);
    let mean = |chunk: &[f64]| {
        let finite = || chunk.iter().filter(|v| v.is_finite());
        finite().sum::<f64>() / finite().count() as f64
    };
    let mean_of = |values: &[f64]| values.chunks(group).map(mean).collect();
    // `min` and `max` ignore NaN; a chunk of NaN only stays NaN.
    let extreme = |values: &[f64], of: fn(f64, f64) -> f64| -> Vec<f64> {
        let fold = |chunk: &[f64]| chunk.iter().copied().fold(f64::NAN, of);
        values.chunks(group).map(fold).collect()
    };
    Series {
        time_s: mean_of(&series.time_s),
        offset_rad: mean_of(&series.offset_rad),
        offset_min_rad: extreme(&series.offset_min_rad, f64::min),
        offset_max_rad: extreme(&series.offset_max_rad, f64::max),
        tau_el_nm: mean_of(&series.tau_el_nm),
        tau_spring_nm: mean_of(&series.tau_spring_nm),
        q_rad: mean_of(&series.q_rad),
        usable_share: mean_of(&series.usable_share),
    }
}
