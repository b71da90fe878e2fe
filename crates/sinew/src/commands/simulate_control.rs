//! Position errors and contacts without and with correction, as text.

use sinew_report::text::{indented, plain, table};
use sinew_sim::control::{Comparison, Score};

/// Renders the comparison as two tables of at most 80 columns.
pub(super) fn render(comparison: &Comparison) -> String {
    let head = [
        "joint",
        "elongation",
        "at rest\n(mrad)",
        "overall\n(mrad)",
        "peak\n(mrad)",
        "torque error\n(N·m)",
        "threshold\n(N·m)",
    ];
    let both = [
        ("uncorrected", &comparison.without),
        ("corrected", &comparison.with),
    ];
    let number = |v: f64| sinew_figure::rounded(v, 2);
    let mut rows = Vec::new();
    for (i, joint) in comparison.with.joints.iter().enumerate() {
        for (k, (correction, score)) in both.iter().enumerate() {
            let Some(j) = score.joints.get(i) else {
                continue;
            };
            rows.push(vec![
                if k == 0 {
                    plain(&joint.name)
                } else {
                    String::new()
                },
                (*correction).into(),
                number(1e3 * j.rest_rms_rad),
                number(1e3 * j.rms_rad),
                number(1e3 * j.peak_rad),
                number(j.false_torque_nm),
                number(j.threshold_nm),
            ]);
        }
    }
    let mut out = table(&head, rows, 2);
    out.push('\n');
    let head = [
        "elongation",
        "contacts",
        "missed",
        "delay\n(ms)",
        "false\nalarms",
        "false alarm time\n(% of contact-free time)",
    ];
    let contacts = |correction: &str, s: &Score| {
        let c = &s.contacts;
        vec![
            correction.into(),
            c.contacts.to_string(),
            c.missed.to_string(),
            number(1e3 * c.delay_median_s()),
            c.false_alarms.to_string(),
            number(100.0 * c.false_share()),
        ]
    };
    let rows = both
        .iter()
        .map(|(correction, s)| contacts(correction, s))
        .collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out.push_str(&indented(
        "Position error: RMS of q − q_d without contacts; at rest: commanded rest of at least 0.7 s. Missed: no alarm started during the contact. Delay: median.",
        2,
        2,
    ));
    out
}
