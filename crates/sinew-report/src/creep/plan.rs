//! Plan of creep tests as text, and as programme of the test bench.

use crate::data::Data;
use crate::format::counted;
use crate::text::{TerminalText, or_dash};
use sinew_creep::{BenchTest, Plan, PlannedTest};
use sinew_figure::{Columns, duration, rounded};
use sinew_log::Table;

/// Renders a plan: tests, and the interval of the elongation before and after them.
pub fn plan_table(plan: &Plan) -> String {
    let mut out = TerminalText::default();
    let now = within(plan.half_width_share);
    out.flat(format!(
        "{}: {}, elongation after pretensioning at {}",
        plan.rope,
        plan.duty,
        duration(plan.time_s)
    ));
    let beyond = within(plan.beyond_share);
    out.flat(format!(
        "present 95 % interval {now}, of which {beyond} from extrapolation beyond the data"
    ));
    if let Some(wider) = plan.prior_half_width_share.map(within) {
        let records = counted(plan.existing as u64, "specified record");
        out.flat(format!(
            "a fit of {records} alone gives {wider}; the catalogue entry is more accurate, keep it"
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
        "{} on the bench reduce the interval to {} (from {now}); standard deviation of a measurement {} % of the length",
        duration(plan.bench_s),
        within(after),
        rounded(100.0 * plan.reading_ratio, 2)
    ));
    if after >= plan.half_width_share {
        out.flat("no test reduces the interval: extrapolation beyond the loads, temperatures and times of the tests dominates; plan longer tests at loads closer to the duty");
    }
    let Some(check) = &plan.check else {
        return out.0;
    };
    let failed = match check.failed {
        0 => String::new(),
        n => format!("; {n} not fitted or not predicted"),
    };
    let without = match plan.existing {
        0 => "",
        _ => ", without the specified records",
    };
    let (ropes, inside, found) = (check.ropes, check.inside, within(check.half_width_share));
    out.flat(format!(
        "validated on {ropes} simulated ropes{without}: interval {found} (median), coverage {inside}/{ropes}{failed}"
    ));
    let actual_over_planned = check.half_width_share / after;
    if ropes == 0 || (plan.existing == 0 && !ACCEPTED_RATIO.contains(&actual_over_planned)) {
        out.flat("planned interval not confirmed: the fit is not linear in the free parameters for such short or few tests; use the interval of the validation");
    }
    out.0
}

/// Accepted range of the validated interval over the planned one.
const ACCEPTED_RATIO: std::ops::Range<f64> = 0.67..1.5;

/// Formats a relative half-width: ± % up to one half, else as a factor.
fn within(share: f64) -> String {
    if share < 0.5 {
        format!("± {} %", rounded(100.0 * share, 2))
    } else {
        format!("factor {}", rounded(1.0 + share, 2))
    }
}

/// Renders a planned test with the best candidates.
fn step(out: &mut TerminalText, number: usize, planned: &PlannedTest) {
    let t = &planned.test;
    let [preload, load, celsius] = [t.preload_n, t.load_n, t.temperature_c].map(|v| rounded(v, 3));
    let after = match t.recovery_s > 0.0 {
        true => format!(", then {preload} N for {}", duration(t.recovery_s)),
        false => String::new(),
    };
    out.flat(format!(
        "test {number}: {preload} N for {}, {load} N for {} at {celsius} °C{after}: interval {}",
        duration(t.preloaded_s),
        duration(t.loaded_s),
        within(planned.half_width_share)
    ));
    out.add("\ncandidates, best first:\n");
    let recovery = |s: f64| or_dash(Some(s).filter(|s| *s > 0.0), duration);
    out.table(
        Columns::of(&planned.candidates)
            .column("load\n(N)", |c| rounded(c.test.load_n, 3))
            .column("temperature\n(°C)", |c| rounded(c.test.temperature_c, 3))
            .column("duration\n", |c| duration(c.test.loaded_s))
            .column("recovery\n", |c| recovery(c.test.recovery_s))
            .column("bench\n", |c| duration(c.test.bench_s()))
            .column("95 % interval\n", |c| within(c.half_width_share))
            .table(),
    );
}

/// Tabulates load and temperature over time, one row per set point and measurement.
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
