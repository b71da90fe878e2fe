//! HTML page of a fleet.

use super::weeks::{Week, weeks};
use super::{Found, MIN_DIFFERENCE, ROWS};
use crate::FleetError;
use crate::compare::show::{band, family, head, name, notes, row, scale, unit, verdict};
use crate::compare::{Comparison, Group, Verdict};
use crate::due::show as listed;
use crate::due::{Passage, TrackedTendon};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table, count};
use sinew_files::date::{DAY_S, day_of};
use sinew_files::plain;

/// Builds the page of a fleet.
pub(super) fn page(found: &Found) -> Page {
    let mut page = Page::new("Fleet: work and ropes");
    page.subtitle = format!(
        "as of {}: {} robots, {} tendons, {} records",
        day_of(found.due.now_utc_s),
        count(found.robots as u64),
        count(found.due.tendons as u64),
        count(found.records)
    );
    page.footer = format!("Sinew {}", env!("CARGO_PKG_VERSION"));
    let [ropes, map, batches] = &found.compared;
    page.section("", vec![Block::Headlines(headlines(found))])
        .section("Work by week", by_week(found))
        .section("Tendons, the worst first", worst(found))
        .section("Ropes", comparison(ropes, "Creep of each rope"))
        .section("Ropes by temperature", rope_map(map))
        .section("Batches", comparison(batches, "Creep of each batch"))
        .section("Notes", vec![Block::List(reading(found))])
}

fn tendons(n: usize) -> String {
    match n {
        1 => "1 tendon".into(),
        n => format!("{} tendons", count(n as u64)),
    }
}

fn headlines(found: &Found) -> Vec<Headline> {
    let due: Vec<&TrackedTendon> = found.due.due(found.within_days).collect();
    let passed = due
        .iter()
        .filter(|f| f.worst().is_some_and(Passage::is_passed));
    let passed = passed.count();
    let mut out = vec![match passed {
        0 => Headline::new(Level::Good, "no tendon has exceeded a limit"),
        n => Headline::new(Level::Alarm, format!("{} exceeded a limit", has(n))),
    }];
    let soon = due.len() - passed;
    let days = found.within_days;
    out.push(match soon {
        0 => Headline::new(
            Level::Good,
            format!("no other tendon may exceed one within {days} days"),
        ),
        n => Headline::new(
            Level::Watch,
            format!("{} more may exceed one within {days} days", tendons(n)),
        ),
    });
    for comparison in found.compared.iter().flatten() {
        for group in comparison.worse() {
            let family = family(group, comparison.by);
            let within = family.map_or(String::new(), |f| format!(" among those of {f}"));
            let text = format!(
                "{} creeps more than the others{within}, by {:.0} %",
                name(group, comparison.by),
                100.0 * (group.ratio[0] - 1.0)
            );
            out.push(Headline::new(Level::Watch, text));
        }
    }
    if !found.due.failed.is_empty() {
        let text = format!(
            "{} without a trend: see below",
            tendons(found.due.failed.len())
        );
        out.push(Headline::new(Level::Open, text));
    }
    if found.rejected > 0 {
        let text = format!(
            "{} files of records rejected: run sinew-fleet rows",
            found.rejected
        );
        out.push(Headline::new(Level::Open, text));
    }
    out
}

fn has(n: usize) -> String {
    match n {
        1 => "1 tendon has".into(),
        n => format!("{} have", tendons(n)),
    }
}

fn by_week(found: &Found) -> Vec<Block> {
    let number = (found.within_days / 7.0).round() as usize;
    let (overdue, weeks) = weeks(&found.due, number);
    let begins = |i: usize| found.due.now_utc_s + 7.0 * DAY_S * i as f64;
    let rows = (weeks.iter().enumerate()).map(|(i, week)| {
        vec![
            day_of(begins(i)),
            week.median.to_string(),
            week.median_by.to_string(),
            format!("{} … {}", week.upper_by, week.lower_by),
        ]
    });
    let overdue = vec![
        "overdue".into(),
        overdue.to_string(),
        "–".into(),
        "–".into(),
    ];
    let head = [
        "week from",
        "due (median)",
        "due by its end (median)",
        "95 % interval",
    ];
    let table = Table::new(&head, std::iter::once(overdue).chain(rows)).captioned(
        "Number of tendons that exceed a limit; cumulative columns exclude the overdue ones",
    );
    vec![
        Block::Figure(
            Box::new(weeks_figure(&weeks, begins(0))),
            "Without the overdue tendons. The band is the 95 % interval: from the upper to the lower end of the interval of each \
             date."
                .into(),
        ),
        table.into(),
    ]
}

fn weeks_figure(weeks: &[Week], now_utc_s: f64) -> Figure {
    let days: Vec<f64> = (0..=weeks.len()).map(|i| 7.0 * i as f64).collect();
    let of = |f: fn(&Week) -> usize| -> Vec<f64> {
        let ends = weeks.iter().map(|w| f(w) as f64);
        std::iter::once(0.0).chain(ends).collect()
    };
    let end = weeks.last().copied().unwrap_or_default();
    let seen = format!(
        "By {}, {} exceed a limit by the median, at least {} and at most {} (95 %)",
        day_of(now_utc_s + 7.0 * DAY_S * weeks.len() as f64),
        tendons(end.median_by),
        end.upper_by,
        end.lower_by
    );
    let axis = format!("days from {}", day_of(now_utc_s));
    let panel = Panel::new("", axis, "tendons due")
        .band(Band::new(
            "95 %",
            days.clone(),
            of(|w| w.upper_by),
            of(|w| w.lower_by),
        ))
        .line(Line::new("median", days.clone(), of(|w| w.median_by)))
        .x_range(0.0, days.last().copied().unwrap_or(7.0))
        .x_days_since(now_utc_s);
    Figure::new("Tendons that become due")
        .seen(seen)
        .size(820.0, 300.0)
        .panel(panel)
}

fn worst(found: &Found) -> Vec<Block> {
    let due: Vec<&TrackedTendon> = found.due.due(found.within_days).collect();
    let mut out = Vec::new();
    if due.is_empty() {
        out.push(Block::Paragraph(format!(
            "No tendon may exceed a limit within {} days.",
            found.within_days
        )));
    } else {
        let head = [&listed::HEAD[..], &["site", "batch"]].concat();
        let maybe = |text: &Option<String>| text.as_deref().map_or("–".into(), plain);
        let rows = due.iter().take(ROWS).filter_map(|f| {
            let mut row = listed::row(f, f.worst()?, found.due.now_utc_s);
            row.extend([maybe(&f.site), maybe(&f.fit.batch)]);
            Some(row)
        });
        out.push(Table::new(&head, rows).into());
        if due.len() > ROWS {
            out.push(Block::Paragraph(format!(
                "{} more: sinew-fleet due --within {} --csv FILE writes all.",
                due.len() - ROWS,
                found.within_days
            )));
        }
    }
    if !found.due.failed.is_empty() {
        let failed = found.due.failed.iter();
        let failed = failed
            .map(|(robot, joint, reason)| plain(&format!("{robot}, {joint}: no trend: {reason}")));
        out.push(Block::List(failed.collect()));
    }
    out
}

/// Paragraph with the reason for a missing comparison.
fn without(error: &FleetError) -> Vec<Block> {
    vec![Block::Paragraph(format!("No comparison: {error}"))]
}

fn level(verdict: &Verdict) -> Colour {
    match verdict {
        Verdict::Worse => Colour::Orange,
        Verdict::Better => Colour::Green,
        _ => Colour::Grey,
    }
}

fn comparison(found: &Result<Comparison, FleetError>, title: &str) -> Vec<Block> {
    let found = match found {
        Ok(found) => found,
        Err(error) => return without(error),
    };
    let mut out = Vec::new();
    if let Some(figure) = creep_figure(found, title) {
        let caption = "Typical tendon, adjusted for other factors; lines are 95 % intervals.";
        out.push(Block::Figure(Box::new(figure), caption.into()));
    }
    let mut head = head(found);
    head[4] = "verdict";
    for together in found.groups.chunk_by(|a, b| a.key.family == b.key.family) {
        let table = Table::new(&head, together.iter().map(|g| row(g, found)));
        let family = together.first().and_then(|g| family(g, found.by));
        out.push(match family {
            Some(family) => table.captioned(family).into(),
            None => table.into(),
        });
    }
    out.push(Block::Folded(
        "Basis of the comparison".into(),
        vec![Block::List(notes(found, MIN_DIFFERENCE))],
    ));
    out
}

/// Creep of every group with its interval, a row each, coloured by verdict.
fn creep_figure(found: &Comparison, title: &str) -> Option<Figure> {
    let groups: Vec<&Group> = (found.groups.iter())
        .filter(|g| g.creep.iter().all(|c| c.is_finite()))
        .collect();
    let worst = groups
        .iter()
        .max_by(|a, b| a.creep[0].total_cmp(&b.creep[0]))?;
    let place = |i: usize| (groups.len() - i) as f64;
    let k = scale(found.unit);
    let mut panel = Panel::new("", format!("creep ({})", unit(found.unit)), "");
    for level_of in [Verdict::Worse, Verdict::Better, Verdict::Inconclusive] {
        let same = |g: &&Group| level(&g.verdict) == level(&level_of);
        let groups: Vec<(usize, &Group)> = (groups.iter().copied().enumerate())
            .filter(|(_, g)| same(g))
            .collect();
        if groups.is_empty() {
            continue;
        }
        // A whisker lies along the axis: a short line each.
        for (i, group) in &groups {
            let [_, low, high] = group.creep.map(|c| k * c);
            let line = Line::new("", vec![low, high], vec![place(*i); 2]);
            panel = panel.line(line.colour(level(&level_of)).width(1.5));
        }
        let x = groups.iter().map(|(_, g)| k * g.creep[0]).collect();
        let y = groups.iter().map(|(i, _)| place(*i)).collect();
        let points = Points::new(verdict(&level_of), x, y).colour(level(&level_of));
        let labels = groups.iter().map(|(_, g)| name(g, found.by)).collect();
        panel = panel.points(points.labels(labels));
    }
    let names = groups.iter().enumerate();
    let names = names.map(|(i, g)| (place(i), name(g, found.by))).collect();
    let seen = format!(
        "{} groups; {} creeps most, by {:.0} {}",
        groups.len(),
        name(worst, found.by),
        k * worst.creep[0],
        unit(found.unit)
    );
    let panel = panel.y_names(names).y_range(0.4, groups.len() as f64 + 0.6);
    Some(
        Figure::new(title)
            .seen(seen)
            .size(820.0, 90.0 + 24.0 * groups.len() as f64)
            .panel(panel),
    )
}

/// Ropes over bands of temperature: creep by rope and band, as a figure and a table.
fn rope_map(found: &Result<Comparison, FleetError>) -> Vec<Block> {
    let found = match found {
        Ok(found) => found,
        Err(error) => return without(error),
    };
    let mut bands: Vec<f64> = (found.groups.iter())
        .filter_map(|g| g.key.family.as_deref()?.parse().ok())
        .collect();
    bands.sort_by(f64::total_cmp);
    bands.dedup();
    let mut ropes: Vec<&str> = found.groups.iter().map(|g| g.key.name.as_str()).collect();
    ropes.sort_unstable();
    ropes.dedup();
    let k = scale(found.unit);
    let at = |rope: &str, band: f64| {
        let here = |g: &&Group| {
            g.key.name == rope && g.key.family.as_deref().and_then(|f| f.parse().ok()) == Some(band)
        };
        let group = found.groups.iter().find(here)?;
        group.creep.iter().all(|c| c.is_finite()).then_some(group)
    };
    let mut panel = Panel::new(
        "",
        "temperature (°C)",
        format!("creep ({})", unit(found.unit)),
    );
    if let (Some(first), Some(last)) = (bands.first(), bands.last()) {
        panel = panel.x_range(*first, last + 10.0);
    }
    let middle = 0.5 * (ropes.len() as f64 - 1.0);
    for (i, (rope, colour)) in ropes.iter().zip(Colour::CYCLE.iter().cycle()).enumerate() {
        let own: Vec<(f64, &Group)> = bands
            .iter()
            .filter_map(|b| Some((*b, at(rope, *b)?)))
            .collect();
        // Side by side, so that the intervals are visible.
        let x: Vec<f64> = own
            .iter()
            .map(|(b, _)| b + 5.0 + (i as f64 - middle) * 0.8)
            .collect();
        let of = |which: usize| {
            own.iter()
                .map(|(_, g)| k * g.creep[which])
                .collect::<Vec<f64>>()
        };
        panel = panel
            .line(
                Line::new("", x.clone(), of(0))
                    .colour(*colour)
                    .dash(Dash::Dashed)
                    .width(1.0),
            )
            .points(
                Points::new(plain(rope), x, of(0))
                    .colour(*colour)
                    .intervals(of(1), of(2)),
            );
    }
    let most = (found.groups.iter())
        .filter(|g| g.creep[0].is_finite())
        .max_by(|a, b| a.creep[0].total_cmp(&b.creep[0]));
    let seen = most.map_or(
        "no rope differs significantly from the others at any temperature".into(),
        |g| {
            format!(
                "{} creeps most, from {}: {:.0} {}",
                name(g, found.by),
                family(g, found.by).unwrap_or_default(),
                k * g.creep[0],
                unit(found.unit)
            )
        },
    );
    let figure = Figure::new("Creep over temperature")
        .seen(seen)
        .size(820.0, 340.0)
        .panel(panel);
    let head: Vec<String> = std::iter::once("rope".to_owned())
        .chain(bands.iter().map(|b| band(&format!("{b:.0}"))))
        .collect();
    let rows = ropes.iter().map(|rope| {
        let cells = bands.iter().map(|band| match at(rope, *band) {
            None => "–".into(),
            Some(g) => {
                let [creep, low, high] = g.creep.map(|c| crate::compare::show::three(k * c));
                format!("{creep} ({low} … {high})")
            }
        });
        std::iter::once(plain(rope))
            .chain(cells)
            .collect::<Vec<String>>()
    });
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let caption = format!(
        "{}, with 95 % interval; –: no tendons or not identifiable",
        unit(found.unit)
    );
    vec![
        Block::Figure(
            Box::new(figure),
            "Bands of 10 K; lines are 95 % intervals.".into(),
        ),
        Table::new(&head, rows).captioned(caption).into(),
        Block::Folded(
            "Basis of the comparison".into(),
            vec![Block::List(notes(found, MIN_DIFFERENCE))],
        ),
    ]
}

fn reading(found: &Found) -> Vec<String> {
    vec![
        "A tendon is due when its limit is exceeded, or when the lower end of its interval lies within the weeks shown.".into(),
        format!(
            "{} were tracked by the full trend. {} cannot reach a limit within these weeks, because an upper bound is below it.",
            tendons(found.due.followed.len()),
            tendons(found.due.out_of_reach)
        ),
        "Forecasts assume unchanged use of the robots and no failures.".into(),
        "Creep is growth per decade of time of a typical tendon. The difference is relative to the median of the other groups.".into(),
        "The probability that any verdict of one comparison is wrong is at most 5 %.".into(),
    ]
}
