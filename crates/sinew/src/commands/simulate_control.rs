//! Joint position and contacts without and with correction, as text.

use sinew_report::text::{indented, plain, table};
use sinew_sim::control::{Comparison, Score};

/// Two tables of at most 80 columns.
pub(super) fn render(comparison: &Comparison) -> String {
    let head = [
        "joint",
        "stretch",
        "at rest\nmrad",
        "overall\nmrad",
        "peak\nmrad",
        "false torque\nN·m",
        "threshold\nN·m",
    ];
    let both = [
        ("unknown", &comparison.without),
        ("known", &comparison.with),
    ];
    let number = |v: f64| sinew_figure::rounded(v, 2);
    let mut rows = Vec::new();
    for (i, joint) in comparison.with.joints.iter().enumerate() {
        for (k, (known, score)) in both.iter().enumerate() {
            let Some(j) = score.joints.get(i) else {
                continue;
            };
            rows.push(vec![
                if k == 0 {
                    plain(&joint.name)
                } else {
                    String::new()
                },
                (*known).into(),
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
        "stretch",
        "contacts",
        "missed",
        "delay\nms",
        "false\nalarms",
        "false alarm\n% of free time",
    ];
    let contacts = |known: &str, s: &Score| {
        let c = &s.contacts;
        vec![
            known.into(),
            c.contacts.to_string(),
            c.missed.to_string(),
            number(1e3 * c.delay_median_s()),
            c.false_alarms.to_string(),
            number(100.0 * c.false_share()),
        ]
    };
    let rows = both.iter().map(|(known, s)| contacts(known, s)).collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out.push_str(&indented(
        "RMS of q − q_d without contacts; at rest: asked to stand for 0.7 s. Missed: no alarm began during the contact. Median delay.",
        2,
        2,
    ));
    out
}
