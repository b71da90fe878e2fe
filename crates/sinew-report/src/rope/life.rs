//! Lifetime of a rope and distribution of its wear: sentence, table and figure.

use super::spoken;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Columns, Table, rounded};
use sinew_rope::life::LIFE_MOST_S;
use sinew_rope::{BreakCause, DamageSite, Place, RopeLifetime, RopeTermination};

/// Minimum share of the life used in a section for a table of the wear, 0 to 1.
const MIN_DAMAGE: f64 = 0.01;

/// Names the cause of a failure.
pub(crate) fn cause(cause: BreakCause) -> &'static str {
    match cause {
        BreakCause::CreepRupture => "creep rupture",
        BreakCause::BendingFatigue => "bending fatigue",
    }
}

/// Formats a lifetime, which is limited to 300 years.
pub(crate) fn limited(life_s: f64) -> String {
    match life_s < LIFE_MOST_S {
        true => spoken(life_s),
        false => "> 300 years".into(),
    }
}

/// States the predicted lifetime with its cause.
pub(crate) fn lifetime(life: &RopeLifetime) -> String {
    let when = match life.breaks_after_s {
        Some(s) => format!(
            "predicted lifetime {} (95 % interval {} to {}), cause {}",
            limited(s.value),
            limited(s.low),
            limited(s.high),
            cause(life.cause)
        ),
        None if life.broken_share > 0.0 => {
            "predicted lifetime > 300 years in more than 97.5 % of the draws (creep and bending only)"
                .into()
        }
        None => "predicted lifetime > 300 years (creep and bending only)".into(),
    };
    let share = rounded(100.0 * life.termination_share, 2);
    match life.termination {
        RopeTermination::NotSpecified => when,
        RopeTermination::Spliced => format!("{when}; splices retain {share} % of the strength"),
        RopeTermination::Knotted => format!("{when}; knots retain {share} % of the strength"),
    }
}

/// Whether any of several sections has significant wear.
pub(crate) fn is_significant(life: &RopeLifetime) -> bool {
    life.spots.len() > 1 && life.spots.iter().any(|s| s.damage() > MIN_DAMAGE)
}

/// Tabulates the life used per section; a star marks the weakest.
pub(crate) fn spots(life: &RopeLifetime) -> Table {
    let max = life.spots.iter().map(|s| s.damage()).fold(0.0, f64::max);
    let mark = |s: &DamageSite| if s.damage() == max { " *" } else { "" };
    let percent = |share: f64| rounded(100.0 * share, 2);
    let mm = |s: &DamageSite, m: f64, at_ends: &str| match s.place {
        Place::Rope => rounded(1e3 * m, 4),
        Place::Termination => at_ends.into(),
    };
    Columns::of(&life.spots)
        .words("from (mm)", |s| mm(s, s.from_m, "ends") + mark(s))
        .column("to (mm)", |s| mm(s, s.to_m, "–"))
        .column("pulleys", |s| s.guides)
        .column("creep (%)", |s| percent(s.creep_damage))
        .column("bending (%)", |s| percent(s.bending_damage))
        .table()
}

/// Plots the life used along the rope.
pub(crate) fn figure(life: &RopeLifetime) -> Figure {
    let along = life.spots.iter().filter(|s| s.place == Place::Rope);
    let mut x = Vec::new();
    let (mut total, mut bending) = (Vec::new(), Vec::new());
    for s in along {
        x.extend([1e3 * s.from_m, 1e3 * s.to_m]);
        total.extend([100.0 * s.damage(); 2]);
        bending.extend([100.0 * s.bending_damage; 2]);
    }
    let panel = Panel::new("", "along the rope from the drive (mm)", "life used (%)")
        .line(Line::new("creep and bending", x.clone(), total).colour(Colour::Orange))
        .line(
            Line::new("bending", x, bending)
                .colour(Colour::Blue)
                .dash(Dash::Solid),
        );
    Figure::new("").size(820.0, 260.0).panel(panel)
}
