//! Time-temperature superposition: shift factors of isotherms.

use crate::data::Data;
use crate::text::{TerminalText, short};
use sinew_creep::ShiftReport;
use sinew_figure::Columns;
use sinew_log::Table;

/// Renders shift factors, and their Arrhenius and WLF fits.
pub fn shift_table(report: &ShiftReport) -> String {
    let found = &report.superposition;
    let mut out = TerminalText::default();
    out.table(
        Columns::of(&found.shifts)
            .column("temperature (°C)", |s| format!("{:.1}", s.temperature_c))
            .column("log10 a_T", |s| format!("{:.3}", s.log10_a_t.mean))
            .column("std. error", |s| format!("{:.3}", s.log10_a_t.std))
            .column("overlap", |s| format!("{:.0} %", 100.0 * s.overlap_share))
            .table(),
    );
    if let Some(line) = found.arrhenius {
        let (energy, rms) = (
            short(1e-3 * line.energy_j_per_mol),
            line.residual_rms_decades,
        );
        out.add(format!(
            "\nArrhenius: {energy} kJ/mol, RMS residual {rms:.2} decades\n"
        ));
    }
    if let Some(wlf) = found.wlf {
        let (from, rms) = (found.reference_c, wlf.residual_rms_decades);
        let [c1, c2] = [wlf.c1, wlf.c2_k].map(short);
        out.add(format!(
            "WLF from {from:.1} °C: C1 {c1}, C2 {c2} K, RMS residual {rms:.2} decades\n"
        ));
    }
    out.0
}

/// Tabulates the shift factors, one row per temperature.
pub fn shift_csv(report: &ShiftReport) -> Table {
    Data::of(&report.superposition.shifts)
        .number("temperature_c", |s| s.temperature_c)
        .number("log10_a_t", |s| s.log10_a_t.mean)
        .number("std_error", |s| s.log10_a_t.std)
        .number("overlap", |s| s.overlap_share)
        .table()
}
