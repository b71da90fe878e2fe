//! How long a rope lasts and where it wears out first, in words, rows and a picture.

use super::spoken;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Columns, Table, rounded};
use sinew_rope::{BreakCause, Ends, Life, Place, Spot};

/// Above this, a portion's share of life is worth a table, 0 to 1.
const TOLD_SHARE: f64 = 0.01;

pub(super) fn cause(cause: BreakCause) -> &'static str {
    match cause {
        BreakCause::CreepRupture => "creep under load",
        BreakCause::BendingFatigue => "bending over its pulleys",
    }
}

/// When it breaks, and what is known of that.
pub(super) fn lasts(life: &Life) -> String {
    let when = match life.breaks_after_s {
        Some(s) => format!(
            "breaks after {} (95 %: {} to {}) of {}",
            spoken(s.value),
            spoken(s.low),
            spoken(s.high),
            cause(life.cause)
        ),
        None => "lasts longer than 300 years, by what is known of creep and bending".into(),
    };
    let share = rounded(100.0 * life.end_share, 2);
    match life.ends {
        Ends::NotStated => when,
        Ends::Spliced => format!("{when}; its splices keep {share} % of its strength"),
        Ends::Knotted => format!("{when}; its knots keep {share} % of its strength"),
    }
}

/// Whether the map of its weak spots says anything.
pub(super) fn is_told(life: &Life) -> bool {
    life.spots.len() > 1 && life.spots.iter().any(|s| s.damage() > TOLD_SHARE)
}

/// Portion by portion, what is used up of its life; a star marks the weakest.
pub(super) fn spots(life: &Life) -> Table {
    let most = life.spots.iter().map(|s| s.damage()).fold(0.0, f64::max);
    let mark = |s: &Spot| if s.damage() == most { " *" } else { "" };
    let percent = |share: f64| rounded(100.0 * share, 2);
    let mm = |s: &Spot, m: f64, at_ends: &str| match s.place {
        Place::Rope => rounded(1e3 * m, 4),
        Place::Ends => at_ends.into(),
    };
    Columns::of(&life.spots)
        .words("from, mm", |s| mm(s, s.from_m, "ends") + mark(s))
        .column("to, mm", |s| mm(s, s.to_m, "–"))
        .column("pulleys", |s| s.guides)
        .column("creep, %", |s| percent(s.creep_damage))
        .column("bending, %", |s| percent(s.bending_damage))
        .table()
}

/// What is used up of the rope's life along its route.
pub(super) fn figure(life: &Life) -> Figure {
    let along = life.spots.iter().filter(|s| s.place == Place::Rope);
    let mut x = Vec::new();
    let (mut all, mut bent) = (Vec::new(), Vec::new());
    for s in along {
        x.extend([1e3 * s.from_m, 1e3 * s.to_m]);
        all.extend([100.0 * s.damage(); 2]);
        bent.extend([100.0 * s.bending_damage; 2]);
    }
    let panel = Panel::new("", "along the rope from the drive (mm)", "life used up (%)")
        .line(Line::new("creep and bending", x.clone(), all).colour(Colour::Orange))
        .line(
            Line::new("bending", x, bent)
                .colour(Colour::Blue)
                .dash(Dash::Solid),
        );
    Figure::new("").size(820.0, 260.0).panel(panel)
}
