//! The drawing.

use super::super::data::{Curve, PanelData, SeriesData};
use super::super::row::{Knowledge, RobotCase, Row};
use super::cases::FACTORS;
use super::climb::{Climb, RUN_S, TOUCH_N, TOUCH_S};
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_sim::control::ContactScore;

const COLOURS: [Colour; 3] = [Colour::Black, Colour::Orange, Colour::Blue];
const DASHES: [Dash; 3] = [Dash::Solid, Dash::DashDotted, Dash::LongDashed];

/// Every hundredth of a second is finer than a pixel.
fn thinned(climb: &Climb, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let every = 10;
    let pick = |v: &[f64]| v.iter().step_by(every).copied().collect();
    (pick(&climb.time_s), pick(values))
}

/// The curves as data: position errors.
pub(super) fn panels(climbs: &[Climb; 3]) -> Vec<PanelData> {
    let joints = ["shoulder_pitch", "elbow"];
    joints
        .iter()
        .enumerate()
        .map(|(slot, joint)| PanelData {
            title: format!("{joint}: q − q_d"),
            series: climbs
                .iter()
                .map(|c| {
                    let (time_s, error_rad) = thinned(c, &c.error_rad[slot]);
                    SeriesData {
                        name: c.name.into(),
                        time_s,
                        curve: Curve::AngleRad(error_rad),
                    }
                })
                .collect(),
        })
        .collect()
}

pub(super) fn figure(climbs: &[Climb; 3], rows: &[Row]) -> Figure {
    Figure::new("Effect of stretched ropes on controller and collision detection")
        .subtitle("Ropes of shoulder pitch and elbow 10 mrad longer; before and after correction")
        .size(1120.0, 900.0)
        .columns(2)
        .panel(position(climbs))
        .panel(torque(climbs))
        .panel(trade_off(rows))
        .panel(at_rest(rows))
}

fn position(climbs: &[Climb; 3]) -> Panel {
    let mut panel = Panel::new("Shoulder's position", "time (s)", "q − q_{d} (mrad)")
        .x_range(0.0, RUN_S)
        .y_range(-17.0, 25.0);
    for ((climb, colour), dash) in climbs.iter().zip(COLOURS).zip(DASHES) {
        let (t, error_rad) = thinned(climb, &climb.error_rad[0]);
        let v = error_rad.iter().map(|e| 1e3 * e).collect();
        let line = Line::new(climb.name, t, v).colour(colour);
        panel = panel.line(line.dash(dash).width(1.4));
    }
    panel.span(TOUCH_S.0, TOUCH_S.0 + TOUCH_S.1, "touch")
}

fn torque(climbs: &[Climb; 3]) -> Panel {
    let mut panel = Panel::new("Shoulder's external torque", "time (s)", "estimated (N·m)")
        .x_range(0.0, RUN_S)
        .span(TOUCH_S.0, TOUCH_S.0 + TOUCH_S.1, format!("{TOUCH_N} N"));
    for ((climb, colour), dash) in climbs.iter().zip(COLOURS).zip(DASHES) {
        let (t, v) = thinned(climb, &climb.tau_ext_nm[0]);
        let line = Line::new("", t, v).colour(colour);
        panel = panel.line(line.dash(dash).width(1.4));
    }
    let corrected = &climbs[2];
    let (t, high) = thinned(corrected, &corrected.threshold_nm[0]);
    let low = high.iter().map(|h| -h).collect();
    panel
        .line(
            Line::new("threshold", t.clone(), high)
                .colour(Colour::Grey)
                .dash(Dash::Dashed)
                .width(1.0),
        )
        .line(
            Line::new("", t, low)
                .colour(Colour::Grey)
                .dash(Dash::Dashed)
                .width(1.0),
        )
}

/// Missed and false over the threshold, from nervous to deaf.
fn trade_off(rows: &[Row]) -> Panel {
    use Knowledge::{Estimate, Nothing};
    use RobotCase::{NewRopes, Stretched};
    let curves = [
        (NewRopes, Nothing, "new ropes"),
        (Stretched, Nothing, "stretched, uncorrected"),
        (Stretched, Estimate, "corrected by estimate"),
    ];
    let mut panel = Panel::new(
        "Contacts missed (solid), false alarm (dashed)",
        "threshold (1: nominal)",
        "% of the contacts, % of the contact-free time",
    )
    .x_range(0.0, FACTORS.iter().fold(0.0, |a, f| f.max(a)))
    .y_range(-2.0, 102.0);
    for ((robot, knowledge, name), colour) in curves.into_iter().zip(COLOURS) {
        let is = |r: &&Row| r.robot == robot && r.knowledge == knowledge;
        let Some(row) = rows.iter().find(is) else {
            continue;
        };
        let own = (1.0, &row.contacts);
        let others = row
            .sensitivities
            .iter()
            .map(|s| (s.threshold_factor, &s.contacts));
        let mut points: Vec<(f64, &ContactScore)> = others.chain([own]).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let curve = |name: &str, of: fn(&ContactScore) -> f64, dash| {
            let (x, y) = points.iter().map(|(f, s)| (*f, 100.0 * of(s))).unzip();
            Line::new(name, x, y).colour(colour).dash(dash).width(1.6)
        };
        panel = panel
            .line(curve(name, ContactScore::missed_share, Dash::Solid))
            .line(curve("", ContactScore::false_share, Dash::Dashed));
    }
    panel
}

/// Error at rest of every row in which the set-point is another one.
fn at_rest(rows: &[Row]) -> Panel {
    // Tolerances of the detector do not affect the motion.
    let moves = |r: &&Row| r.knowledge != Knowledge::EstimateAndTolerances;
    let shown: Vec<&Row> = rows.iter().filter(moves).collect();
    let spread_mrad = |r: &Row| 1e3 * r.joints[0].rest_rad.std;
    let right = shown
        .iter()
        .map(|r| r.rest_mrad(0) + spread_mrad(r))
        .fold(0.0, f64::max);
    let mut panel = Panel::new(
        "Error at rest, shoulder pitch (bars: ± one σ of the sessions)",
        "RMS of q − q_{d} (mrad)",
        "row, from below",
    )
    .x_range(0.0, 1.7 * right)
    .y_range(0.0, shown.len() as f64 + 1.0);
    for (i, r) in shown.iter().enumerate() {
        let y = (shown.len() - i) as f64;
        let (v, s) = (r.rest_mrad(0), spread_mrad(r));
        let colour = match (r.knowledge, r.robot) {
            (Knowledge::Nothing, RobotCase::NewRopes) => Colour::Black,
            (Knowledge::Nothing, _) => Colour::Orange,
            _ => Colour::Blue,
        };
        panel = panel
            .line(
                Line::new("", vec![v - s, v + s], vec![y, y])
                    .colour(colour)
                    .width(1.2),
            )
            .line(
                Line::new("", vec![v, v], vec![y - 0.3, y + 0.3])
                    .colour(colour)
                    .width(4.0),
            )
            .note(
                1.05 * right,
                y,
                format!("{}: {}", r.robot.name(), r.knowledge.name()),
            );
    }
    panel
}
