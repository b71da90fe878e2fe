//! A plan of creep tests in words, and as the bench's programme.

use crate::text::{paragraph, table};
use sinew_creep::{BenchTest, Plan, PlannedTest};
use sinew_figure::{duration, rounded};
use sinew_log::{Cell, CellKind, Table};

/// What to test next, and what it is worth.
pub fn plan_table(plan: &Plan) -> String {
    let mut out = paragraph(
        &format!(
            "{}: {}, stretch since tensioned after {}",
            plan.rope,
            plan.duty,
            duration(plan.time_s)
        ),
        0,
    );
    out.push_str(&paragraph(
        &format!(
            "now within {}; of that {} is what the law may miss beyond its data",
            within(plan.half_width_share),
            within(plan.beyond_share)
        ),
        0,
    ));
    if let Some(wider) = plan.known_half_width_share {
        out.push_str(&paragraph(
            &format!(
                "a fit of the {} given alone is within {}: the catalogue's entry knows more, keep it",
                match plan.known {
                    1 => "record".to_string(),
                    n => format!("{n} records"),
                },
                within(wider)
            ),
            0,
        ));
    }
    for (i, planned) in plan.tests.iter().enumerate() {
        out.push('\n');
        out.push_str(&step(i + 1, planned));
    }
    out.push('\n');
    let after = plan
        .tests
        .last()
        .map_or(plan.half_width_share, |t| t.half_width_share);
    out.push_str(&paragraph(
        &format!(
            "{} on the bench, then within {} instead of {}; readings scatter by {} % of the length",
            duration(plan.bench_s),
            within(after),
            within(plan.half_width_share),
            rounded(100.0 * plan.reading_ratio, 2)
        ),
        0,
    ));
    if after >= plan.half_width_share {
        out.push_str(&paragraph(
            "none of these tests makes it surer: what a law may miss beyond their loads, temperatures and times counts for more than what they tell. Hold loads longer, nearer to the duty's",
            0,
        ));
    }
    if let Some(check) = &plan.check {
        let failed = match check.failed {
            0 => String::new(),
            n => format!("; {n} could not be fitted or predicted"),
        };
        let without = match plan.known {
            0 => "",
            _ => ", without the records given",
        };
        out.push_str(&paragraph(
            &format!(
                "carried out on {} virtual ropes{without}: within {} (median), and {} of them lay inside{failed}",
                check.ropes,
                within(check.half_width_share),
                check.inside
            ),
            0,
        ));
        let came_true = check.half_width_share / after;
        if check.ropes == 0 || (plan.known == 0 && !TRUE.contains(&came_true)) {
            out.push_str(&paragraph(
                "the promise doesn't come true: tests so short or so few are not linear in what is open. Go by the figure of the check",
                0,
            ));
        }
    }
    out
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

fn step(number: usize, planned: &PlannedTest) -> String {
    let t = &planned.test;
    let after = if t.recovery_s > 0.0 {
        format!(
            ", then {} N for {}",
            rounded(t.preload_n, 3),
            duration(t.recovery_s)
        )
    } else {
        String::new()
    };
    let mut out = paragraph(
        &format!(
            "test {number}: {} N for {}, {} N for {} at {} °C{after}: within {}",
            rounded(t.preload_n, 3),
            duration(t.preloaded_s),
            rounded(t.load_n, 3),
            duration(t.loaded_s),
            rounded(t.temperature_c, 3),
            within(planned.half_width_share)
        ),
        0,
    );
    out.push_str("\nlooked at for it, the best first:\n");
    let rows = planned
        .candidates
        .iter()
        .map(|c| {
            vec![
                rounded(c.test.load_n, 3),
                rounded(c.test.temperature_c, 3),
                duration(c.test.loaded_s),
                if c.test.recovery_s > 0.0 {
                    duration(c.test.recovery_s)
                } else {
                    "–".into()
                },
                duration(c.test.bench_s()),
                within(c.half_width_share),
            ]
        })
        .collect();
    out.push_str(&table(
        &[
            "load\nN",
            "at\n°C",
            "held\n",
            "watched\nafter",
            "bench\n",
            "then within\n",
        ],
        rows,
        0,
    ));
    out
}

/// Load and temperature over time: a row where something is set, and one for every reading.
pub fn plan_programme(plan: &Plan) -> Table {
    let columns = ["test", "time_s", "force_n", "temperature_c", "reading"];
    let mut out = Table::new(&columns.map(|name| (name, CellKind::Number)));
    for (i, planned) in plan.tests.iter().enumerate() {
        for (time_s, force_n, reading) in rows(&planned.test) {
            let row = [
                (i + 1) as f64,
                time_s,
                force_n,
                planned.test.temperature_c,
                f64::from(u8::from(reading)),
            ];
            out.push(row.map(Cell::Number).to_vec());
        }
    }
    out
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
