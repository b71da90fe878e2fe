//! A plan of creep tests in words, and as the bench's programme.

use crate::data::Data;
use crate::text::{Told, or_dash};
use sinew_creep::{BenchTest, Plan, PlannedTest};
use sinew_figure::{Columns, duration, rounded};
use sinew_log::Table;

/// What to test next, and what it is worth.
pub fn plan_table(plan: &Plan) -> String {
    let mut out = Told::default();
    let now = within(plan.half_width_share);
    out.flat(format!(
        "{}: {}, stretch since tensioned after {}",
        plan.rope,
        plan.duty,
        duration(plan.time_s)
    ));
    let beyond = within(plan.beyond_share);
    out.flat(format!(
        "now within {now}; of that {beyond} is what the law may miss beyond its data"
    ));
    if let Some(wider) = plan.known_half_width_share.map(within) {
        let records = match plan.known {
            1 => "record".to_string(),
            n => format!("{n} records"),
        };
        out.flat(format!(
            "a fit of the {records} given alone is within {wider}: the catalogue's entry knows more, keep it"
        ));
    }
    for (i, planned) in plan.tests.iter().enumerate() {
        out.add("\n");
        step(&mut out, i + 1, planned);
    }
    out.add("\n");
    let last = plan.tests.last();
    let after = last.map_or(plan.half_width_share, |t| t.half_width_share);
    out.flat(format!(
        "{} on the bench, then within {} instead of {now}; readings scatter by {} % of the length",
        duration(plan.bench_s),
        within(after),
        rounded(100.0 * plan.reading_ratio, 2)
    ));
    if after >= plan.half_width_share {
        out.flat("none of these tests makes it surer: what a law may miss beyond their loads, temperatures and times counts for more than what they tell. Hold loads longer, nearer to the duty's");
    }
    let Some(check) = &plan.check else {
        return out.0;
    };
    let failed = match check.failed {
        0 => String::new(),
        n => format!("; {n} could not be fitted or predicted"),
    };
    let without = match plan.known {
        0 => "",
        _ => ", without the records given",
    };
    let (ropes, inside, found) = (check.ropes, check.inside, within(check.half_width_share));
    out.flat(format!(
        "carried out on {ropes} virtual ropes{without}: within {found} (median), and {inside} of them lay inside{failed}"
    ));
    let came_true = check.half_width_share / after;
    if ropes == 0 || (plan.known == 0 && !TRUE.contains(&came_true)) {
        out.flat("the promise doesn't come true: tests so short or so few are not linear in what is open. Go by the figure of the check");
    }
    out.0
}

/// A promise that came true: the interval found over the one promised.
const TRUE: std::ops::Range<f64> = 0.67..1.5;

/// Half an interval for people: ± up to a half, else times or over.
fn within(share: f64) -> String {
    if share < 0.5 {
        format!("± {} %", rounded(100.0 * share, 2))
    } else {
        format!("a factor {}", rounded(1.0 + share, 2))
    }
}

fn step(out: &mut Told, number: usize, planned: &PlannedTest) {
    let t = &planned.test;
    let [preload, load, celsius] = [t.preload_n, t.load_n, t.temperature_c].map(|v| rounded(v, 3));
    let after = match t.recovery_s > 0.0 {
        true => format!(", then {preload} N for {}", duration(t.recovery_s)),
        false => String::new(),
    };
    out.flat(format!(
        "test {number}: {preload} N for {}, {load} N for {} at {celsius} °C{after}: within {}",
        duration(t.preloaded_s),
        duration(t.loaded_s),
        within(planned.half_width_share)
    ));
    out.add("\nlooked at for it, the best first:\n");
    let watched = |s: f64| or_dash(Some(s).filter(|s| *s > 0.0), duration);
    out.table(
        Columns::of(&planned.candidates)
            .column("load\nN", |c| rounded(c.test.load_n, 3))
            .column("at\n°C", |c| rounded(c.test.temperature_c, 3))
            .column("held\n", |c| duration(c.test.loaded_s))
            .column("watched\nafter", |c| watched(c.test.recovery_s))
            .column("bench\n", |c| duration(c.test.bench_s()))
            .column("then within\n", |c| within(c.half_width_share))
            .table(),
    );
}

/// Load and temperature over time: a row where something is set, and one for every reading.
pub fn plan_programme(plan: &Plan) -> Table {
    let tests = (1_u32..).zip(&plan.tests);
    let rows = tests.flat_map(|(i, t)| rows(&t.test).into_iter().map(move |row| (i, t, row)));
    Data::of(rows)
        .number("test", |(i, ..)| f64::from(*i))
        .number("time_s", |(_, _, row)| row.0)
        .number("force_n", |(_, _, row)| row.1)
        .number("temperature_c", |(_, t, _)| t.test.temperature_c)
        .number("reading", |(_, _, row)| f64::from(u8::from(row.2)))
        .table()
}

fn rows(test: &BenchTest) -> Vec<(f64, f64, bool)> {
    let start_s = test.preloaded_s;
    let mut rows = vec![(0.0, test.preload_n, true), (start_s, test.load_n, false)];
    if test.recovery_s > 0.0 {
        rows.push((start_s + test.loaded_s, test.preload_n, false));
    }
    for t in test.readings_s() {
        let force_n = if t < test.loaded_s {
            test.load_n
        } else {
            test.preload_n
        };
        rows.push((start_s + t, force_n, true));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows
}
