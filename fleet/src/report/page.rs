//! The page.

use super::weeks::{Week, weeks};
use super::{Found, LEAST, ROWS};
use crate::FleetError;
use crate::compare::show::{band, family, head, name, notes, row, scale, unit, verdict};
use crate::compare::{Comparison, Group, Verdict};
use crate::due::show as listed;
use crate::due::{Followed, Passage};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table, count};
use sinew_files::date::{DAY_S, day_of};
use sinew_files::plain;

/// The page of a fleet.
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
        .section("How to read this", vec![Block::List(reading(found))])
}

fn tendons(n: usize) -> String {
    match n {
        1 => "1 tendon".into(),
        n => format!("{} tendons", count(n as u64)),
    }
}

fn headlines(found: &Found) -> Vec<Headline> {
    let due: Vec<&Followed> = found.due.due(found.within_days).collect();
    let passed = due
        .iter()
        .filter(|f| f.worst().is_some_and(Passage::is_passed));
    let passed = passed.count();
    let mut out = vec![match passed {
        0 => Headline::new(Level::Good, "no tendon has passed a limit"),
        n => Headline::new(Level::Alarm, format!("{} passed a limit", has(n))),
    }];
    let soon = due.len() - passed;
    let days = found.within_days;
    out.push(match soon {
        0 => Headline::new(Level::Good, format!("no other can within {days} days")),
        n => Headline::new(
            Level::Watch,
            format!("{} more may within {days} days", tendons(n)),
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
    if !found.due.refused.is_empty() {
        let text = format!(
            "{} without a trend: see below",
            tendons(found.due.refused.len())
        );
        out.push(Headline::new(Level::Open, text));
    }
    if found.refused > 0 {
        let text = format!(
            "{} files of records were refused: run sinew-fleet rows",
            found.refused
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
            week.likely.to_string(),
            week.likely_by.to_string(),
            format!("{} … {}", week.surely_by, week.maybe_by),
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
        "due, likely",
        "by its end, likely",
        "surely … maybe",
    ];
    let table = Table::new(&head, std::iter::once(overdue).chain(rows)).captioned(
        "Tendons that pass a limit; without those that are overdue where 'by its end' counts",
    );
    vec![
        Block::Figure(
            Box::new(weeks_figure(&weeks, begins(0))),
            "Beside those that are overdue. The band reaches from tendons that surely have passed a limit by then to all \
             that may have, at 95 % each."
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
        "By {} {} have likely passed a limit, {} surely and {} at most",
        day_of(now_utc_s + 7.0 * DAY_S * weeks.len() as f64),
        tendons(end.likely_by),
        end.surely_by,
        end.maybe_by
    );
    let axis = format!("days from {}", day_of(now_utc_s));
    let panel = Panel::new("", axis, "tendons due")
        .band(Band::new(
            "95 %",
            days.clone(),
            of(|w| w.surely_by),
            of(|w| w.maybe_by),
        ))
        .line(Line::new("likely", days.clone(), of(|w| w.likely_by)))
        .x_range(0.0, days.last().copied().unwrap_or(7.0))
        .x_days_since(now_utc_s);
    Figure::new("Tendons that come to be due")
        .seen(seen)
        .size(820.0, 300.0)
        .panel(panel)
}

fn worst(found: &Found) -> Vec<Block> {
    let due: Vec<&Followed> = found.due.due(found.within_days).collect();
    let mut out = Vec::new();
    if due.is_empty() {
        out.push(Block::Paragraph(format!(
            "No tendon may pass a limit within {} days.",
            found.within_days
        )));
    } else {
        let head = [&listed::HEAD[..], &["site", "batch"]].concat();
        let known = |text: &Option<String>| text.as_deref().map_or("–".into(), plain);
        let rows = due.iter().take(ROWS).filter_map(|f| {
            let mut row = listed::row(f, f.worst()?, found.due.now_utc_s);
            row.extend([known(&f.site), known(&f.fit.batch)]);
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
    if !found.due.refused.is_empty() {
        let told = found.due.refused.iter();
        let told =
            told.map(|(robot, joint, why)| plain(&format!("{robot}, {joint}: no trend: {why}")));
        out.push(Block::List(told.collect()));
    }
    out
}

/// Why a comparison isn't there.
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
        let caption = "Of a typical tendon, freed of what else differs; lines are 95 %.";
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
        "What this rests on".into(),
        vec![Block::List(notes(found, LEAST))],
    ));
    out
}

/// Creep of every group with its interval, a row each, coloured by verdict.
fn creep_figure(found: &Comparison, title: &str) -> Option<Figure> {
    let known: Vec<&Group> = (found.groups.iter())
        .filter(|g| g.creep.iter().all(|c| c.is_finite()))
        .collect();
    let worst = known
        .iter()
        .max_by(|a, b| a.creep[0].total_cmp(&b.creep[0]))?;
    let place = |i: usize| (known.len() - i) as f64;
    let k = scale(found.unit);
    let mut panel = Panel::new("", format!("creep ({})", unit(found.unit)), "");
    for level_of in [Verdict::Worse, Verdict::Better, Verdict::CantTell] {
        let same = |g: &&Group| level(&g.verdict) == level(&level_of);
        let groups: Vec<(usize, &Group)> = (known.iter().copied().enumerate())
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
    let names = known.iter().enumerate();
    let names = names.map(|(i, g)| (place(i), name(g, found.by))).collect();
    let seen = format!(
        "{} groups; {} creeps most, by {:.0} {}",
        known.len(),
        name(worst, found.by),
        k * worst.creep[0],
        unit(found.unit)
    );
    let panel = panel.y_names(names).y_range(0.4, known.len() as f64 + 0.6);
    Some(
        Figure::new(title)
            .seen(seen)
            .size(820.0, 90.0 + 24.0 * known.len() as f64)
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
        // Beside each other, so that intervals show.
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
        "no rope can be told from the others at any temperature".into(),
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
        "{}, with 95 %; –: no tendons, or no way to tell",
        unit(found.unit)
    );
    vec![
        Block::Figure(
            Box::new(figure),
            "A band of 10 K each; lines are 95 %.".into(),
        ),
        Table::new(&head, rows).captioned(caption).into(),
        Block::Folded(
            "What this rests on".into(),
            vec![Block::List(notes(found, LEAST))],
        ),
    ]
}

fn reading(found: &Found) -> Vec<String> {
    vec![
        "A tendon is due when its limit is passed, or when the lower end of its interval lies within the weeks shown.".into(),
        format!(
            "{} were followed by the whole trend. {} can't reach a limit within these weeks, by a bound.",
            tendons(found.due.followed.len()),
            tendons(found.due.out_of_reach)
        ),
        "Forecasts suppose that robots are used as before and that nothing fails.".into(),
        "Creep is growth per decade of time of a typical tendon. 'More by' counts from the middle one of the others.".into(),
        "The chance that any verdict of one comparison is wrong is 5 % at most.".into(),
    ]
}
