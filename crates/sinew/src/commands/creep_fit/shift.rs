//! `sinew creep fit --shift-c`: isotherms shifted along the logarithm of time.

use super::super::creep_files::{csv_line, short, write_csv};
use super::Fit;
use crate::terminal::{Failure, Finish, answer, complain};
use crate::text::{plain, table};
use sinew_creep::{Isotherm, Superposition};
use sinew_log::TestQuantity;

impl Fit {
    pub(super) fn shift(&self, reference: f64) -> Result<Finish, Failure> {
        let (sources, specimens) = self.files.specimens()?;
        let mut isotherms = Vec::new();
        let mut failures = Vec::new();
        for s in &specimens {
            let warm = s.column(TestQuantity::Temperature).map(|t| {
                let finite: Vec<f64> = t.iter().copied().filter(|t| t.is_finite()).collect();
                finite.iter().sum::<f64>() / finite.len() as f64
            });
            let value = s
                .column(TestQuantity::Modulus)
                .or_else(|| s.column(TestQuantity::Strain));
            match (warm, s.column(TestQuantity::Time), value) {
                (Some(temperature_c), Some(time), Some(value)) => {
                    let (time_s, value) = time
                        .iter()
                        .zip(value)
                        .filter(|(t, v)| **t > 0.0 && **v > 0.0)
                        .unzip();
                    isotherms.push(Isotherm {
                        temperature_c,
                        time_s,
                        value,
                    });
                }
                _ => failures.push(format!(
                    "{}: no temperature, or neither modulus nor strain",
                    s.name
                )),
            }
        }
        let found = sinew_creep::superpose(&isotherms, reference)?;
        if !self.files.quiet {
            for failure in &failures {
                complain("warning", &plain(failure));
            }
        }
        if let Some(path) = &self.files.csv {
            let mut text = csv_line(&["temperature_c", "log10_a_t", "std_error", "overlap"]);
            for s in &found.shifts {
                text.push_str(&csv_line(&[
                    s.temperature_c.to_string(),
                    s.log10_a_t.to_string(),
                    s.std_error.to_string(),
                    s.overlap.to_string(),
                ]));
            }
            write_csv(path, &text)?;
        }
        if self.files.json {
            let document = serde_json::json!({ "sources": sources, "superposition": found, "failures": failures });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            answer(&shifts_told(&found))?;
        }
        Ok(Finish::lossy(!failures.is_empty()))
    }
}

fn shifts_told(found: &Superposition) -> String {
    let rows = found
        .shifts
        .iter()
        .map(|s| {
            vec![
                format!("{:.1}", s.temperature_c),
                format!("{:.3}", s.log10_a_t),
                format!("{:.3}", s.std_error),
                format!("{:.0} %", 100.0 * s.overlap),
            ]
        })
        .collect();
    let mut out = table(&["°C", "log10 a_T", "std. error", "overlap"], rows, 0);
    if let Some((energy, rms)) = found.arrhenius {
        out.push_str(&format!(
            "\nArrhenius: {} kJ/mol, misfit {rms:.2} decades\n",
            short(energy)
        ));
    }
    if let Some((c1, c2, rms)) = found.wlf {
        out.push_str(&format!(
            "WLF from {:.1} °C up: C1 {}, C2 {} K, misfit {rms:.2} decades\n",
            found.reference_c,
            short(c1),
            short(c2)
        ));
    }
    out
}
