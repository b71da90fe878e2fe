//! A run of the bending bench as table, CSV and figure.

use crate::text::{paragraph, plain, table};
use sinew_figure::plot::{Band, Figure, Line, Panel};
use sinew_figure::rounded;
use sinew_log::{Cell, CellKind, Table};
use sinew_rope::bench::{BenchReading, BenchRun};

/// A dozen rows, the last one, and both sides of every change of force.
pub fn bench_table(run: &BenchRun) -> String {
    let mut out = paragraph(
        &plain(&format!(
            "bench {}, {}: strands of {} mm, stroke {} mm",
            run.bench,
            run.rope,
            rounded(1e3 * run.strand_m, 3),
            rounded(1e3 * run.stroke_m, 3)
        )),
        2,
    );
    out.push('\n');
    let head = ["min", "force\nN", "elongation\nmm", "strain\n%", "stays\n%"];
    let readings = &run.readings;
    let step = (readings.len() / 12).max(1);
    let changes = |i: usize| {
        let differs =
            |r: Option<&BenchReading>| r.is_some_and(|r| r.force_n != readings[i].force_n);
        differs(readings.get(i + 1)) || (i > 0 && differs(readings.get(i - 1)))
    };
    let rows = (0..readings.len())
        .filter(|&i| i % step == 0 || i + 1 == readings.len() || changes(i))
        .map(|i| {
            let r = &readings[i];
            let s = r.strain_ratio.scaled(100.0);
            vec![
                rounded(r.time_s / 60.0, 3),
                rounded(r.force_n, 3),
                rounded(1e3 * r.elongation_m, 3),
                format!(
                    "{} ({} to {})",
                    rounded(s.value, 3),
                    rounded(s.low, 2),
                    rounded(s.high, 2)
                ),
                rounded(100.0 * r.irreversible_strain_ratio, 3),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 0));
    out.push_str(&paragraph(
        "elongation: how far the carriage has moved; brackets: 95 % of the draws of the \
         rope's parameters",
        2,
    ));
    out
}

/// One row per reading.
pub fn bench_csv(run: &BenchRun) -> Table {
    let columns = [
        "time_s",
        "tension_n",
        "carriage_force_n",
        "elongation_mm",
        "strain_percent",
        "strain_low_percent",
        "strain_high_percent",
    ];
    let mut out = Table::new(&columns.map(|name| (name, CellKind::Number)));
    for r in &run.readings {
        let s = r.strain_ratio.scaled(100.0);
        let row = [
            r.time_s,
            // Two strands carry the carriage.
            0.5 * r.force_n,
            r.force_n,
            1e3 * r.elongation_m,
            s.value,
            s.low,
            s.high,
        ];
        out.push(row.map(Cell::Number).to_vec());
    }
    out
}

/// Strain over time with the band of the draws.
pub fn bench_figure(run: &BenchRun) -> Figure {
    let of = |f: &dyn Fn(&BenchReading) -> f64| run.readings.iter().map(f).collect::<Vec<f64>>();
    let minutes = of(&|r| r.time_s / 60.0);
    Figure::new(format!("Bench {}, simulated", run.bench))
        .subtitle(format!("{}; band: 95 % of the draws", run.rope))
        .size(900.0, 420.0)
        .panel(
            Panel::new("", "time (min)", "strain (%)")
                .y_right("carriage (mm)", 10.0 * run.strand_m)
                .band(Band::new(
                    "",
                    minutes.clone(),
                    of(&|r| 100.0 * r.strain_ratio.low),
                    of(&|r| 100.0 * r.strain_ratio.high),
                ))
                .line(Line::new(
                    "",
                    minutes,
                    of(&|r| 100.0 * r.strain_ratio.value),
                )),
        )
}
