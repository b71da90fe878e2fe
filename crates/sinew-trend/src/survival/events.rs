//! Lifetimes from dated events at places of robots.

use super::lives::{LifeEnd, Lives, RopeLife, end_of, no_column};
use super::result::{AgeUnit, SurvivalNote};
use crate::RecordError;
use sinew_files::csv::{Row, Table};
use sinew_files::date::{DAY_S, day_of, parse_utc_s};
use sinew_files::{Fault, names};
use std::collections::BTreeMap;

/// Dates say the day: a rope that broke on the day it was put in lasted about half of one, s.
const SAME_DAY_S: f64 = 0.5 * DAY_S;

/// Words of a table that a note repeats.
const WORDS_TOLD: usize = 5;

/// Which columns of a table say what.
#[derive(Debug, Clone, PartialEq)]
pub struct EventColumns {
    /// Day of an event.
    pub date: String,
    /// What happened, in words.
    pub event: String,
    /// The place: one column or several together.
    pub unit: Vec<String>,
    /// What ropes are counted with, beside all together.
    pub group: Option<String>,
    /// Places with the same word here were watched together: until the last event of any of them. `None`: all of the
    /// table were.
    pub watched: Option<String>,
    /// Until when places were watched, s since 1970; `None`: until the last event of those watched together.
    pub until_utc_s: Option<f64>,
    /// Whether a rope that broke was replaced the same day, though no row says so.
    pub repaired: bool,
}

impl Default for EventColumns {
    fn default() -> Self {
        Self {
            date: "date".into(),
            event: "event".into(),
            unit: vec!["unit".into()],
            group: None,
            watched: None,
            until_utc_s: None,
            repaired: false,
        }
    }
}

impl EventColumns {
    /// The place of a row: its columns' words together; `None` where all are empty.
    pub(super) fn unit_of(&self, row: &Row<'_>) -> Option<String> {
        let words: Vec<&str> = self.unit.iter().filter_map(|c| row.text(c)).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// The group of a row.
    pub(super) fn group_of(&self, row: &Row<'_>) -> Option<String> {
        let column = self.group.as_deref()?;
        row.text(column).map(str::to_string)
    }
}

/// What an event means for the rope of its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Meaning {
    /// It was seen, and stays.
    Seen,
    /// A new rope was put in.
    Installed,
    /// The rope was replaced before it broke.
    Replaced,
    /// The rope broke. That another was put in shows by what comes after.
    Broke,
    /// The rope was taken out, and none put in.
    Retired,
}

impl Meaning {
    /// From words, as they stand in a ticket: "broken (crimp let go)", "loose; retensioned".
    fn of(words: &str) -> Self {
        let words = words.to_lowercase();
        let says = |any: &[&str]| any.iter().any(|word| is_said(&words, word));
        if says(&["broke", "torn", "tore", "snapped", "ruptured"]) {
            Self::Broke
        } else if says(&["replaced", "rebuilt", "renewed"]) {
            Self::Replaced
        } else if says(&["installed", "new rope", "commissioned"]) {
            Self::Installed
        } else if says(&["retired", "removed", "decommissioned"]) {
            Self::Retired
        } else {
            Self::Seen
        }
    }
}

/// Whether a word begins with `beginning` and isn't denied: "broken" and "it broke", not "unbroken", "not broken" or
/// "almost broken"; "tore" is not in "restored".
fn is_said(words: &str, beginning: &str) -> bool {
    const DENIES: [&str; 8] = [
        "not", "no", "nothing", "never", "almost", "nearly", "isn't", "yet",
    ];
    words.match_indices(beginning).any(|(at, _)| {
        let before = &words[..at];
        let begins = !before.ends_with(char::is_alphanumeric);
        let mut last = before
            .trim_end()
            .rsplit(|c: char| !c.is_alphanumeric() && c != '\'');
        begins && !last.next().is_some_and(|word| DENIES.contains(&word))
    })
}

#[derive(Debug, Clone)]
struct Event {
    utc_s: f64,
    meaning: Meaning,
}

/// A place and what happened there.
#[derive(Debug, Default)]
struct Place {
    group: Option<String>,
    watched: Option<String>,
    events: Vec<Event>,
}

/// The lives of a table of events.
pub(super) fn lives_of_events(table: &Table, columns: &EventColumns) -> Result<Lives, RecordError> {
    let (mut places, mut notes) = (BTreeMap::<String, Place>::new(), Vec::new());
    let mut words = BTreeMap::<String, usize>::new();
    let mut broke = BTreeMap::<String, usize>::new();
    let mut unplaced = 0;
    for row in table.rows() {
        let text = |name: &str, why: &str| row.text(name).ok_or_else(|| no_column(&row, name, why));
        let date = text(
            &columns.date,
            "every event has a day; name its column with --date. A table with a row a rope has age_days, age_hours or age_cycles",
        )?;
        let utc_s = parse_utc_s(date).ok_or_else(|| {
            let problem = format!(
                "'{}' in '{}' is no date; write such as 2026-03-01",
                names::shorten(date, 40),
                columns.date
            );
            RecordError::from(row.here(Fault::NotAllowed, problem))
        })?;
        if let Some(until) = columns.until_utc_s.filter(|until| utc_s > *until) {
            let problem = format!(
                "an event on {}, after the end of the watch on {}",
                day_of(utc_s),
                day_of(until)
            );
            return Err(row.here(Fault::NotAllowed, problem).into());
        }
        let what = text(
            &columns.event,
            "it says what happened; name its column with --event",
        )?;
        let Some(unit) = columns.unit_of(&row) else {
            if columns.unit.iter().all(|c| table.column(c).is_none()) {
                let names = columns.unit.join(", ");
                return Err(no_column(
                    &row,
                    &names,
                    "name the columns of the place with --unit",
                ));
            }
            unplaced += 1;
            continue;
        };
        let meaning = Meaning::of(what);
        match meaning {
            Meaning::Seen => *words.entry(what.to_string()).or_default() += 1,
            Meaning::Broke if end_of(what).is_none() => {
                *broke.entry(what.to_string()).or_default() += 1;
            }
            _ => {}
        }
        let place = places.entry(unit).or_default();
        place.group = place.group.take().or(columns.group_of(&row));
        let watched = columns.watched.as_deref().and_then(|c| row.text(c));
        place.watched = place.watched.take().or(watched.map(str::to_string));
        place.events.push(Event { utc_s, meaning });
    }
    if unplaced > 0 {
        notes.push(SurvivalNote::WithoutPlace { events: unplaced });
    }
    let last = |of: &mut dyn Iterator<Item = &Place>| {
        let times = of.flat_map(|p| p.events.iter().map(|e| e.utc_s));
        times.fold(f64::NEG_INFINITY, f64::max)
    };
    let watch_ends = |place: &Place| {
        columns.until_utc_s.unwrap_or_else(|| match &place.watched {
            None => last(&mut places.values()),
            some => last(&mut places.values().filter(|p| p.watched == *some)),
        })
    };
    let (mut lives, mut first_breaks, mut same_day, mut without_rope) = (Vec::new(), 0, 0, 0);
    for (unit, place) in &places {
        let mut of_place = PlaceLives {
            place,
            unit,
            from_utc_s: None,
            supposed: false,
            seen_utc_s: None,
            lives: &mut lives,
            first_breaks: &mut first_breaks,
            same_day: &mut same_day,
            without_rope: &mut without_rope,
        };
        let mut events = place.events.clone();
        events.sort_by(|a, b| a.utc_s.total_cmp(&b.utc_s));
        for day in events.chunk_by_mut(|a, b| a.utc_s == b.utc_s) {
            // The rope that runs broke before the next was put in; where none runs, the order of the rows says which came first.
            if of_place.from_utc_s.is_some() {
                day.sort_by_key(|e| (e.meaning != Meaning::Broke, e.meaning));
            }
            day.iter().for_each(|event| of_place.take(event));
        }
        of_place.watch_ends(watch_ends(place), columns.repaired);
    }
    if first_breaks > 0 {
        notes.push(SurvivalNote::AgeUnknown {
            breaks: first_breaks,
        });
    }
    if without_rope > 0 {
        notes.push(SurvivalNote::NoNewRope {
            places: without_rope,
        });
    }
    if same_day > 0 {
        notes.push(SurvivalNote::SameDay { ropes: same_day });
    }
    if !broke.is_empty() {
        notes.push(SurvivalNote::TakenForBroken {
            events: broke.values().sum(),
            words: broke.into_keys().take(WORDS_TOLD).collect(),
        });
    }
    if !words.is_empty() {
        let events = words.values().sum();
        notes.push(SurvivalNote::NoEnd {
            events,
            words: words.into_keys().take(WORDS_TOLD).collect(),
        });
    }
    notes.push(SurvivalNote::WatchEnds {
        utc_s: columns
            .until_utc_s
            .unwrap_or_else(|| last(&mut places.values())),
        by: columns
            .watched
            .clone()
            .filter(|_| columns.until_utc_s.is_none()),
    });
    Ok(Lives {
        age_unit: AgeUnit::Seconds,
        lives,
        notes,
    })
}

/// The ropes of one place, one after another.
struct PlaceLives<'a> {
    place: &'a Place,
    unit: &'a str,
    /// When the rope that runs was put in; `None`: before the table begins, or none runs.
    from_utc_s: Option<f64>,
    /// Whether that is only supposed, because the one before broke then.
    supposed: bool,
    /// When it was last seen to run, of a rope that is supposed.
    seen_utc_s: Option<f64>,
    lives: &'a mut Vec<RopeLife>,
    first_breaks: &'a mut usize,
    same_day: &'a mut usize,
    without_rope: &'a mut usize,
}

impl PlaceLives<'_> {
    fn take(&mut self, event: &Event) {
        let at = event.utc_s;
        match event.meaning {
            Meaning::Seen => self.seen_utc_s = Some(at),
            // It stood without one since the break.
            Meaning::Installed if self.supposed => {
                (self.from_utc_s, self.supposed) = (Some(at), false);
            }
            Meaning::Installed | Meaning::Replaced => {
                self.ends(at, LifeEnd::Replaced);
                (self.from_utc_s, self.supposed) = (Some(at), false);
            }
            Meaning::Broke => {
                if self.from_utc_s.is_none() {
                    *self.first_breaks += 1;
                }
                self.ends(at, LifeEnd::Broke);
                (self.from_utc_s, self.supposed, self.seen_utc_s) = (Some(at), true, None);
            }
            Meaning::Retired => {
                self.ends(at, LifeEnd::Replaced);
                (self.from_utc_s, self.supposed) = (None, false);
            }
        }
    }

    /// Nobody watches any more. A place whose rope broke and of which nothing was heard since has no rope that anybody
    /// knows of: one that was seen since is whole as long as it was seen. Where every place was `repaired` it has one.
    fn watch_ends(&mut self, at_utc_s: f64, repaired: bool) {
        match (self.supposed && !repaired, self.seen_utc_s) {
            (false, _) => self.ends(at_utc_s, LifeEnd::Whole),
            (true, Some(seen)) => self.ends(seen, LifeEnd::Whole),
            (true, None) => *self.without_rope += 1,
        }
    }

    /// The rope that runs ends here, if one runs.
    fn ends(&mut self, at_utc_s: f64, end: LifeEnd) {
        let Some(from) = self.from_utc_s else { return };
        let mut age = at_utc_s - from;
        if age <= 0.0 {
            // Put in on the last day of the watch: nothing is known of it.
            if end != LifeEnd::Broke {
                return;
            }
            age = SAME_DAY_S;
            *self.same_day += 1;
        }
        self.lives.push(RopeLife {
            unit: self.unit.into(),
            group: self.place.group.clone(),
            age,
            end,
        });
    }
}
