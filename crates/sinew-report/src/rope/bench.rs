//! Simulation of the bending bench as terminal table, machine-readable table and figure.

use crate::data::Data;
use crate::text::TerminalText;
use sinew_figure::plot::{Band, Figure, Line, Panel};
use sinew_figure::{Columns, rounded};
use sinew_log::Table;
use sinew_rope::bench::{BenchReading, BenchRun};

/// Renders about a dozen rows, the last one, and both sides of every change of force.
pub fn bench_table(run: &BenchRun) -> String {
    let mut out = TerminalText::default();
    let [strand, stroke] = [run.strand_m, run.stroke_m].map(|m| rounded(1e3 * m, 3));
    let (bench, rope) = (&run.bench, &run.rope);
    out.paragraph(format!(
        "bench {bench}, {rope}: strands of {strand} mm, stroke {stroke} mm"
    ));
    out.add("\n");
    let readings = &run.readings;
    let step = (readings.len() / 12).max(1);
    let changes = |i: usize| {
        let differs =
            |r: Option<&BenchReading>| r.is_some_and(|r| r.force_n != readings[i].force_n);
        differs(readings.get(i + 1)) || (i > 0 && differs(readings.get(i - 1)))
    };
    let shown = |i: &usize| i.is_multiple_of(step) || i + 1 == readings.len() || changes(*i);
    let shown = (0..readings.len()).filter(shown).map(|i| &readings[i]);
    out.table(
        Columns::of(shown)
            .column("time\n(min)", |r| rounded(r.time_s / 60.0, 3))
            .column("force\n(N)", |r| rounded(r.force_n, 3))
            .column("elongation\n(mm)", |r| rounded(1e3 * r.elongation_m, 3))
            .column("strain\n(%)", |r| {
                let s = r.strain_ratio.scaled(100.0);
                let [low, high] = [s.low, s.high].map(|v| rounded(v, 2));
                format!("{} ({low} to {high})", rounded(s.value, 3))
            })
            .column("permanent\n(%)", |r| {
                rounded(100.0 * r.irreversible_strain_ratio, 3)
            })
            .table(),
    );
    out.paragraph("elongation: displacement of the carriage, averaged through the cycle; 95 % intervals in brackets, from draws of the rope parameters");
    let power = run.friction_power_w;
    if power.high > 0.0 {
        let [value, low, high] = [power.value, power.low, power.high].map(|w| rounded(w, 2));
        out.paragraph(format!(
            "friction at the guides: {value} W ({low} to {high} W)"
        ));
    }
    if run.may_be_warm() {
        let limit = rounded(run.warm_above_w, 2);
        out.paragraph(format!(
            "warning[friction-heat]: above {limit} W the rope may exceed 35 °C at the guides (assumed heat loss 0.05 W/K) and retract; the simulation keeps the temperature of the phase: measure the temperature of the rope at the guides"
        ));
    }
    out.0
}

/// Tabulates the simulation, one row per time.
pub fn bench_csv(run: &BenchRun) -> Table {
    let strain = [
        "strain_percent",
        "strain_low_percent",
        "strain_high_percent",
    ];
    Data::of(&run.readings)
        .number("time_s", |r| r.time_s)
        // Two strands share the force of the carriage.
        .number("tension_n", |r| 0.5 * r.force_n)
        .number("carriage_force_n", |r| r.force_n)
        .number("elongation_mm", |r| 1e3 * r.elongation_m)
        .bounded(strain, |r| Some(r.strain_ratio.scaled(100.0)))
        .table()
}

/// Plots the strain over time with its 95 % band.
pub fn bench_figure(run: &BenchRun) -> Figure {
    let of = |f: &dyn Fn(&BenchReading) -> f64| run.readings.iter().map(f).collect::<Vec<f64>>();
    let minutes = of(&|r| r.time_s / 60.0);
    let low = of(&|r| 100.0 * r.strain_ratio.low);
    let high = of(&|r| 100.0 * r.strain_ratio.high);
    let middle = of(&|r| 100.0 * r.strain_ratio.value);
    let panel = Panel::new("", "time (min)", "strain (%)")
        .y_right("carriage (mm)", 10.0 * run.strand_m)
        .band(Band::new("", minutes.clone(), low, high))
        .line(Line::new("", minutes, middle));
    Figure::new(format!("Bench {}, simulated", run.bench))
        .subtitle(format!("{}; band: 95 % interval", run.rope))
        .size(900.0, 420.0)
        .panel(panel)
}
