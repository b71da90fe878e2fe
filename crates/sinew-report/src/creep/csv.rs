//! Tables for other programs: %, h and °C as laboratories write them, units in the column names.

use super::words::{fault, group, interval_kind, open, scatter_source};
use sinew_creep::{
    AnalyzeReport, CompareReport, FitReport, PERCENT_PER_H, ShiftReport, WithheldReport,
};
use sinew_files::csv_cell;
use sinew_model::Bounded;

/// One line, cells quoted where needed.
fn line<S: AsRef<str>>(cells: &[S]) -> String {
    let quoted = cells.iter().map(|cell| csv_cell(cell.as_ref()));
    quoted.collect::<Vec<_>>().join(",") + "\n"
}

fn number(v: Option<f64>) -> String {
    v.map_or(String::new(), |v| v.to_string())
}

/// Value and bounds of a slope, %/h.
fn slope_cells(slope: Option<Bounded>) -> [String; 3] {
    let per_h = slope.map(|s| s.scaled(PERCENT_PER_H));
    [
        number(per_h.map(|s| s.value)),
        number(per_h.map(|s| s.low)),
        number(per_h.map(|s| s.high)),
    ]
}

/// One line per specimen.
pub fn analyze_csv(report: &AnalyzeReport) -> String {
    let mut out = String::from(
        "specimen,group,force_n,stress_mpa,temperature_c,humidity_percent,duration_s,end_percent,\
         creep_percent,slope_percent_per_h,slope_low,slope_high,saturation_s,saturated,faults\n",
    );
    for a in &report.specimens {
        let [slope, low, high] = slope_cells(a.slope_per_s);
        let faults: Vec<String> = a.faults.iter().map(fault).collect();
        out.push_str(&line(&[
            a.name.clone(),
            group(&a.group).to_owned(),
            number(a.force_n),
            number(a.stress_pa.map(|s| s * 1e-6)),
            number(a.temperature_c.map(|t| t.mean)),
            number(a.humidity_percent.map(|h| h.mean)),
            a.duration_s.to_string(),
            (100.0 * a.end_strain_ratio).to_string(),
            (100.0 * a.creep_strain_ratio).to_string(),
            slope,
            low,
            high,
            number(a.saturation_s),
            a.saturated.map_or(String::new(), |s| s.to_string()),
            faults.join("; "),
        ]));
    }
    out
}

/// One line per rope.
pub fn compare_csv(report: &CompareReport) -> String {
    let mut out = String::from(
        "rank,rope,specimens,strain_percent,strain_low,strain_high,slope_percent_per_h,slope_low,\
         slope_high,scatter_share,scatter_source\n",
    );
    for r in &report.ranks {
        let [slope, low, high] = slope_cells(r.slope_per_s);
        let strain = r.strain_ratio.scaled(100.0);
        out.push_str(&line(&[
            r.rank.to_string(),
            r.name.clone(),
            r.specimens.to_string(),
            strain.value.to_string(),
            strain.low.to_string(),
            strain.high.to_string(),
            slope,
            low,
            high,
            r.scatter_share.to_string(),
            scatter_source(r.scatter_source).to_owned(),
        ]));
    }
    out
}

/// One line per parameter of every law.
pub fn fit_csv(report: &FitReport) -> String {
    let mut out = String::from(
        "name,law,aicc,bic,parameter,specimen,unit,value,std_error,low,high,interval,\
         not_identifiable\n",
    );
    for set in &report.fits {
        for f in &set.laws {
            for p in &f.parameters {
                out.push_str(&line(&[
                    set.name.clone(),
                    f.law.name().to_owned(),
                    f.aicc.to_string(),
                    f.bic.to_string(),
                    p.name.clone(),
                    p.specimen.clone().unwrap_or_default(),
                    p.unit.clone(),
                    p.value.to_string(),
                    p.std_error.to_string(),
                    p.low.to_string(),
                    p.high.to_string(),
                    interval_kind(p.interval).to_owned(),
                    p.not_identifiable
                        .map_or(String::new(), |what| open(what, &p.unit)),
                ]));
            }
        }
    }
    out
}

/// One line per law.
pub fn withhold_csv(report: &WithheldReport) -> String {
    let mut out = String::from(
        "law,tests,failed,readings_percent,end_percent,end_error_percent,end_half_width_percent\n",
    );
    for c in &report.withheld {
        out.push_str(&line(&[
            c.forecaster.name().to_owned(),
            c.tests.to_string(),
            c.failed.to_string(),
            number(c.readings_share().map(|s| 100.0 * s)),
            number(c.ends_share().map(|s| 100.0 * s)),
            number(c.ends_share().map(|_| 100.0 * c.end_error_ratio)),
            number(c.ends_share().map(|_| 100.0 * c.end_half_width_ratio)),
        ]));
    }
    out
}

/// One line per temperature.
pub fn shift_csv(report: &ShiftReport) -> String {
    let mut out = String::from("temperature_c,log10_a_t,std_error,overlap\n");
    for s in &report.superposition.shifts {
        out.push_str(&line(&[
            s.temperature_c.to_string(),
            s.log10_a_t.mean.to_string(),
            s.log10_a_t.deviation.to_string(),
            s.overlap_share.to_string(),
        ]));
    }
    out
}
