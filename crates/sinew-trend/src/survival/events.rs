//! Lifetimes from dated events at locations of robots.

use super::lives::{LifeEnd, Lifetimes, RopeLife, end_of, no_column};
use super::result::{AgeUnit, SurvivalNote};
use crate::RecordError;
use sinew_files::csv::{Row, Table};
use sinew_files::date::{DAY_S, day_of, parse_utc_s};
use sinew_files::{Fault, names};
use std::collections::BTreeMap;

/// Lifetime of a rope that broke on the day of its installation, s: half a day, because dates have
/// a resolution of a day.
const SAME_DAY_S: f64 = 0.5 * DAY_S;

/// Maximum number of event texts that a note repeats.
const MAX_REPORTED_TEXTS: usize = 5;

/// Column mapping of a table of events.
#[derive(Debug, Clone, PartialEq)]
pub struct EventColumns {
    /// Column with the day of an event.
    pub date: String,
    /// Column with the description of the event.
    pub event: String,
    /// Columns that together identify the location.
    pub unit: Vec<String>,
    /// Column of the group, for an additional curve per group.
    pub group: Option<String>,
    /// Column of locations observed together, until the last event of any of them. `None` if all
    /// locations of the table were observed together.
    pub monitored: Option<String>,
    /// End of observation, s since 1970; `None` for the last event of the locations observed
    /// together.
    pub until_utc_s: Option<f64>,
    /// Whether a broken rope was replaced on the same day even if no row records it.
    pub repaired: bool,
}

impl Default for EventColumns {
    fn default() -> Self {
        Self {
            date: "date".into(),
            event: "event".into(),
            unit: vec!["unit".into()],
            group: None,
            monitored: None,
            until_utc_s: None,
            repaired: false,
        }
    }
}

impl EventColumns {
    /// Location of a row: the texts of its columns; `None` if all are empty.
    pub(super) fn unit_of(&self, row: &Row<'_>) -> Option<String> {
        let words: Vec<&str> = self.unit.iter().filter_map(|c| row.text(c)).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// Group of a row.
    pub(super) fn group_of(&self, row: &Row<'_>) -> Option<String> {
        let column = self.group.as_deref()?;
        row.text(column).map(str::to_string)
    }
}

/// Meaning of an event for the rope of its location.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Meaning {
    /// Rope observed, and still in use.
    Seen,
    /// New rope installed.
    Installed,
    /// Rope replaced before it broke.
    Replaced,
    /// Rope broken. A new installation shows by later events.
    Broke,
    /// Rope removed without replacement.
    Retired,
}

impl Meaning {
    /// Meaning from the text of a ticket: "broken (crimp let go)", "loose; retensioned".
    fn of(words: &str) -> Self {
        let words = words.to_lowercase();
        let mentions_any = |any: &[&str]| any.iter().any(|word| mentions(&words, word));
        if mentions_any(&["broke", "torn", "tore", "snapped", "ruptured"]) {
            Self::Broke
        } else if mentions_any(&["replaced", "rebuilt", "renewed"]) {
            Self::Replaced
        } else if mentions_any(&["installed", "new rope", "commissioned"]) {
            Self::Installed
        } else if mentions_any(&["retired", "removed", "decommissioned"]) {
            Self::Retired
        } else {
            Self::Seen
        }
    }
}

/// Whether a word starts with `beginning` and is not negated: "broken" and "it broke", not
/// "unbroken", "not broken" or "almost broken"; "tore" is not in "restored".
fn mentions(words: &str, beginning: &str) -> bool {
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

/// Location and its events.
#[derive(Debug, Default)]
struct Place {
    group: Option<String>,
    monitored: Option<String>,
    events: Vec<Event>,
}

/// Lifetimes of a table of events.
pub(super) fn lives_of_events(
    table: &Table,
    columns: &EventColumns,
) -> Result<Lifetimes, RecordError> {
    let (mut places, mut notes) = (BTreeMap::<String, Place>::new(), Vec::new());
    let mut words = BTreeMap::<String, usize>::new();
    let mut broke = BTreeMap::<String, usize>::new();
    let mut unplaced = 0;
    for row in table.rows() {
        let text =
            |name: &str, reason: &str| row.text(name).ok_or_else(|| no_column(&row, name, reason));
        let date = text(
            &columns.date,
            "every event needs a date; name its column with --date. A table with one row per rope needs age_days, age_hours or age_cycles",
        )?;
        let utc_s = parse_utc_s(date).ok_or_else(|| {
            let problem = format!(
                "'{}' in '{}' is not a date; write, for example, 2026-03-01",
                names::shorten(date, 40),
                columns.date
            );
            RecordError::from(row.here(Fault::NotAllowed, problem))
        })?;
        if let Some(until) = columns.until_utc_s.filter(|until| utc_s > *until) {
            let problem = format!(
                "an event on {}, after the end of observation on {}",
                day_of(utc_s),
                day_of(until)
            );
            return Err(row.here(Fault::NotAllowed, problem).into());
        }
        let what = text(
            &columns.event,
            "describes the event; name its column with --event",
        )?;
        let Some(unit) = columns.unit_of(&row) else {
            if columns.unit.iter().all(|c| table.column(c).is_none()) {
                let names = columns.unit.join(", ");
                return Err(no_column(
                    &row,
                    &names,
                    "name the columns of the location with --unit",
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
        let monitored = columns.monitored.as_deref().and_then(|c| row.text(c));
        place.monitored = place.monitored.take().or(monitored.map(str::to_string));
        place.events.push(Event { utc_s, meaning });
    }
    if unplaced > 0 {
        notes.push(SurvivalNote::WithoutPlace { events: unplaced });
    }
    let last = |of: &mut dyn Iterator<Item = &Place>| {
        let times = of.flat_map(|p| p.events.iter().map(|e| e.utc_s));
        times.fold(f64::NEG_INFINITY, f64::max)
    };
    let observation_end = |place: &Place| {
        columns
            .until_utc_s
            .unwrap_or_else(|| match &place.monitored {
                None => last(&mut places.values()),
                some => last(&mut places.values().filter(|p| p.monitored == *some)),
            })
    };
    let (mut lives, mut first_breaks, mut same_day, mut without_rope) = (Vec::new(), 0, 0, 0);
    for (unit, place) in &places {
        let mut of_place = PlaceLifetimes {
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
            // A rope in use broke before the next was installed; without one in use, the order of
            // the rows decides.
            if of_place.from_utc_s.is_some() {
                day.sort_by_key(|e| (e.meaning != Meaning::Broke, e.meaning));
            }
            day.iter().for_each(|event| of_place.take(event));
        }
        of_place.end_observation(observation_end(place), columns.repaired);
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
            words: broke.into_keys().take(MAX_REPORTED_TEXTS).collect(),
        });
    }
    if !words.is_empty() {
        let events = words.values().sum();
        notes.push(SurvivalNote::NoEnd {
            events,
            words: words.into_keys().take(MAX_REPORTED_TEXTS).collect(),
        });
    }
    notes.push(SurvivalNote::ObservationEnd {
        utc_s: columns
            .until_utc_s
            .unwrap_or_else(|| last(&mut places.values())),
        by: columns
            .monitored
            .clone()
            .filter(|_| columns.until_utc_s.is_none()),
    });
    Ok(Lifetimes {
        age_unit: AgeUnit::Seconds,
        lives,
        notes,
    })
}

/// Consecutive ropes of one location.
struct PlaceLifetimes<'a> {
    place: &'a Place,
    unit: &'a str,
    /// Installation time of the rope in use; `None` before the table starts, or without a rope.
    from_utc_s: Option<f64>,
    /// Whether the installation is only inferred from the break of the previous rope.
    supposed: bool,
    /// Last observation of an inferred rope.
    seen_utc_s: Option<f64>,
    lives: &'a mut Vec<RopeLife>,
    first_breaks: &'a mut usize,
    same_day: &'a mut usize,
    without_rope: &'a mut usize,
}

impl PlaceLifetimes<'_> {
    fn take(&mut self, event: &Event) {
        let at = event.utc_s;
        match event.meaning {
            Meaning::Seen => self.seen_utc_s = Some(at),
            // The location had no rope since the break.
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

    /// Ends the observation. A location without any event after a break has no known rope; a rope
    /// observed since then is intact until that observation. If every location was `repaired` it
    /// has one.
    fn end_observation(&mut self, at_utc_s: f64, repaired: bool) {
        match (self.supposed && !repaired, self.seen_utc_s) {
            (false, _) => self.ends(at_utc_s, LifeEnd::Whole),
            (true, Some(seen)) => self.ends(seen, LifeEnd::Whole),
            (true, None) => *self.without_rope += 1,
        }
    }

    /// Ends the lifetime of the rope in use, if there is one.
    fn ends(&mut self, at_utc_s: f64, end: LifeEnd) {
        let Some(from) = self.from_utc_s else { return };
        let mut age = at_utc_s - from;
        if age <= 0.0 {
            // Installed on the last day of observation: no information.
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
