mod messages;

use super::*;
use sinew_estimate::feeder::Injection;
use sinew_estimate::replay::*;
use sinew_estimate::{EstimateDocument, Method, RecordingWarning};
use sinew_figure::{Block, Page, Sentence};
use sinew_model::Gaussian;
use sinew_model::offset::{Comparison, TorqueSource};

/// Uncorrected estimate of two joints, and one without estimate.
pub(super) fn made_up() -> Estimate {
    let n = 400;
    let time_s: Vec<f64> = (0..n).map(|i| 0.1 * (f64::from(i) + 0.5)).collect();
    let gap = |t: f64| t < 1.5 || (20.0..22.0).contains(&t);
    let joint = |name: &str, offset: f64, stiffness: f64| {
        let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { time_s.iter().map(|&t| f(t)).collect() };
        let delta = |t: f64| {
            if gap(t) {
                f64::NAN
            } else {
                offset + 0.3 * (1.7 * t).sin()
            }
        };
        let tau = |t: f64| {
            if gap(t) {
                f64::NAN
            } else {
                -2.4 * (0.4 * t).sin() - 1.0
            }
        };
        JointEstimate {
            slides: false,
            name: name.into(),
            reason: None,
            offset_rad: Some(1e-3 * offset),
            scatter_rad: Some(0.41e-3),
            standard_error_rad: Some(0.052e-3),
            elongation_m: Some(0.025e-3 * offset),
            elongation_standard_error_m: Some(0.025e-3 * 0.052),
            strain_ratio: Some(0.025 * offset / 700.0),
            usable_frames: 36_500,
            usable_share: 0.9125,
            losses: vec![Loss {
                reason: LossReason::Settling,
                frames: 3_500,
                share: 0.0875,
            }],
            stiffness_nm_per_rad: Some(stiffness),
            tau_el_nm: Some(TorqueStatistics {
                min: -3.4,
                mean: -1.0,
                max: 1.4,
            }),
            offset_per_stiffness_error_rad: Some(-1.0 / stiffness),
            difference: None,
            series: Series {
                offset_rad: of(&|t| 1e-3 * delta(t)),
                offset_min_rad: of(&|t| 1e-3 * (delta(t) - 0.8)),
                offset_max_rad: of(&|t| {
                    1e-3 * (delta(t) + if (t - 31.05).abs() < 0.06 { 60.0 } else { 0.9 })
                }),
                tau_el_nm: of(&tau),
                tau_spring_nm: of(&|t| tau(t) + 1e-3 * offset * stiffness),
                q_rad: of(&|t| (0.4 * t).sin()),
                usable_share: of(&|t| if gap(t) { 0.0 } else { 1.0 }),
                time_s: time_s.clone(),
            },
        }
    };
    let mut joints = vec![
        joint("shoulder_pitch", 0.02, 40.0),
        joint("elbow", 10.4, 20.0),
        joint("wrist", 0.0, 8.0),
    ];
    let wrist = &mut joints[2];
    wrist.reason = Some(JointError::NoMotorPosition);
    wrist.series = Series::default();
    (wrist.offset_rad, wrist.scatter_rad) = (None, None);
    (
        wrist.standard_error_rad,
        wrist.offset_per_stiffness_error_rad,
    ) = (None, None);
    (wrist.elongation_m, wrist.strain_ratio) = (None, None);
    wrist.elongation_standard_error_m = None;
    (wrist.usable_frames, wrist.usable_share) = (0, 0.0);
    Estimate {
        sinew_version: "0.1.0".into(),
        recording: RecordingInfo {
            path: "monday.mcap".into(),
            format: sinew_log::Format::Mcap,
            sources: vec![sinew_log::SignalSource {
                topic: None,
                quantity: sinew_log::Quantity::Q,
                source: "/joint_states position".into(),
            }],
            start_time_ns: 1_709_210_096_000_000_000,
            duration_s: 40.0,
            frames: 40_000,
            rate_hz: Some(1000.0),
            segments: 2,
        },
        robot: RobotInfo {
            name: "biorob_like".into(),
            file: "robots/biorob-like/robot.toml".into(),
            urdf: "robots/biorob-like/biorob-like.urdf".into(),
            joints: Vec::new(),
        },
        settings: Settings {
            source: TorqueSource::Observer,
            comparison: Comparison::Matched,
            gain_per_s: 20.0,
            velocity_filter_rad_per_s: Some(60.0),
            tau_ext: false,
            injected: vec![Injection {
                joint: "elbow".into(),
                offset_rad: 0.01,
                from_s: Some(12.0),
            }],
            reference: None,
        },
        joints,
        losses: vec![Loss {
            reason: LossReason::Duplicate,
            frames: 12,
            share: 0.0003,
        }],
        damaged: true,
        warnings: vec![RecordingWarning::Gaps {
            count: 1,
            longest_s: 2.0,
        }],
        basis: vec![Basis {
            quantity: Quantity::Transmission,
            based_on: Origin::Stated,
        }],
    }
}

fn with_difference(mut estimate: Estimate, difference_mrad: f64) -> Estimate {
    estimate.settings.reference = Some("sunday.mcap".into());
    estimate.joints[1].difference = Some(Difference {
        reference_rad: 1e-3 * (10.4 - difference_mrad),
        difference_rad: 1e-3 * difference_mrad,
        standard_error_rad: Some(0.07e-3),
        elongation_m: Some(0.025e-3 * difference_mrad),
        offset_per_stiffness_error_rad: 0.001,
    });
    estimate
}

/// Document of an uncorrected estimate.
fn paper_document(reading: Estimate) -> EstimateDocument {
    EstimateDocument {
        method: Method::Paper,
        session: None,
        reading,
    }
}

/// Page of an uncorrected estimate.
fn page(reading: Estimate) -> String {
    html(&paper_document(reading))
}

#[test]
fn headline_uncorrected_states_no_verdict() {
    let estimate = made_up();
    let sentence = |e: &Estimate, i: usize| headline(e, &e.joints[i]);
    assert_eq!(
        sentence(&estimate, 1),
        "elbow: uncorrected offset 10.40 ± 0.10 mrad (95 %, scatter only); equivalent to an elongation of 0.26 mm"
    );
    // An uncorrected estimate is no verdict.
    for verdict in ["no change detected", "elongated", "shortened"] {
        assert!(
            !sentence(&estimate, 0).contains(verdict),
            "{}",
            sentence(&estimate, 0)
        );
    }
    assert_eq!(
        sentence(&estimate, 2),
        "wrist: no estimate; motor position not recorded"
    );
    let shrunk = with_difference(made_up(), -4.0);
    assert_eq!(
        sentence(&shrunk, 1),
        "elbow: shortened by 0.10 mm relative to sunday.mcap (change −4.00 ± 0.14 mrad, 95 %)"
    );
    let mut bare = made_up();
    bare.joints[1].elongation_m = None;
    bare.joints[1].standard_error_rad = None;
    let text = sentence(&bare, 1);
    assert!(
        text.contains("10.4 mrad") && text.contains("too short"),
        "{text}"
    );
}

#[test]
fn page_has_no_external_resources() {
    let page = page(with_difference(made_up(), 4.0));
    for needed in [
        "elbow: elongated by 0.10 mm relative to sunday.mcap",
        "accurate for differences",
        "depends on the stiffness",
        "filter settling after the start, a gap or missing samples",
        "2024-02-29 12:34:56 UTC",
        "as specified in robots/biorob-like/robot.toml",
        "Sinew 0.1.0",
        "is partly damaged",
        "10 mrad at elbow from 12 s on",
        "10 mrad injected",
    ] {
        assert!(page.contains(needed), "'{needed}' is missing");
    }
    // The SVG name space is a name, not an address that is opened.
    let loads = page.replace("http://www.w3.org/2000/svg", "");
    for never in ["http:", "https:", "src=", "@import", "url(", "<link", "NaN"] {
        assert!(!loads.contains(never), "'{never}' is in the page");
    }
    assert_eq!(page.matches("<script").count(), 1, "the page's own");
    assert_eq!(
        page.matches("<svg xmlns").count(),
        4,
        "one figure per estimated joint, each with a narrow layout"
    );
}

#[test]
fn page_tags_are_balanced() {
    // usvg is no HTML parser; balanced tags are what our own writer can get wrong.
    let page = page(made_up());
    for tag in [
        "table", "tr", "td", "th", "ul", "li", "section", "figure", "p", "svg", "g", "text", "h2",
    ] {
        let open =
            page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(open, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn text_from_files_is_escaped() {
    let evil = "</td></svg><script>alert(1)</script><img src=x onerror=\"a\">\u{0}'&";
    let mut e = with_difference(made_up(), 4.0);
    e.recording.path = evil.into();
    e.robot.name = evil.into();
    e.robot.file = evil.into();
    e.robot.urdf = evil.into();
    e.settings.reference = Some(evil.into());
    e.warnings = vec![RecordingWarning::Robot { text: evil.into() }];
    for joint in &mut e.joints {
        joint.name = evil.into();
    }
    e.settings.injected[0].joint = evil.into();
    let page = page(e);
    assert_eq!(page.matches("<script").count(), 1, "the page's own");
    assert!(!page.contains("<img") && !page.contains('\u{0}'));
    assert!(page.contains("&lt;script&gt;"));
}

#[test]
fn page_without_estimate_contains_no_nan() {
    let mut e = made_up();
    e.joints.truncate(2);
    e.recording.duration_s = 0.0;
    e.recording.rate_hz = None;
    for joint in &mut e.joints {
        joint.series = Series::default();
        joint.offset_rad = None;
        joint.elongation_m = Some(f64::NAN);
        joint.tau_el_nm = None;
    }
    let page = page(e);
    assert!(page.contains("no estimate") && !page.contains("NaN"));
}

#[test]
fn sentence_shows_verdict_and_criterion() {
    let sentence = |holds| Sentence {
        text: "the difference is 0.005 rad".into(),
        criterion: "mean within 0.1 mrad of 5 mrad".into(),
        value: 4.987,
        unit: "mrad".into(),
        holds,
    };
    let page = Page::new("Figure 6")
        .section(
            "Difference",
            vec![Block::Sentences(vec![
                sentence(Some(true)),
                sentence(Some(false)),
                sentence(None),
            ])],
        )
        .html();
    assert!(page.contains("<span class=\"verdict\">holds</span>"));
    assert!(page.contains("<span class=\"verdict\">does not hold</span>"));
    assert!(page.contains("<span class=\"verdict\">inconclusive</span>"));
    assert!(page.contains("Criterion: mean within 0.1 mrad of 5 mrad. Found: 4.99 mrad"));
}

#[test]
fn page_is_written_for_inspection() {
    // Written to the target folder, for inspection in a browser after a change of style.
    let exe = std::env::current_exe().expect("the test has a path");
    let dir = exe
        .parent()
        .expect("it lies in a folder")
        .join("report-look");
    std::fs::create_dir_all(&dir).expect("target is writable");
    let page = page(with_difference(made_up(), 4.0));
    std::fs::write(dir.join("report.html"), &page).expect("target is writable");
    assert!(page.len() < 400_000, "{} bytes", page.len());
}

/// Session of two antagonistic strands: their common tension is not observable, and the first was slack.
fn of_strands() -> EstimateDocument {
    use sinew_estimate::session::*;
    let tendon = |name: &str, lower_bound_m| TendonEstimate {
        slides: false,
        slack_share: Option::map(lower_bound_m, |_: f64| 0.934),
        lower_bound_rad: Option::map(lower_bound_m, |m: f64| m / 0.02),
        lower_bound_m,
        anchored: None,
        name: name.into(),
        offset_rad: Gaussian::new(4e-3, 20e-3),
        systematic_error: None,
        elongation_m: Some(Gaussian::new(0.08e-3, 0.4e-3)),
        strain_ratio: Some(Gaussian::new(0.2e-3, 1e-3)),
        verdict: Verdict::Inconclusive,
        retension: None,
        changes: Vec::new(),
        stiffness_change_ratio: Gaussian::new(0.0, 0.1),
        stiffness_change: None,
        creep: None,
        slack_rad: None,
        torque_nm: TorqueRange { min: 0.0, max: 2.0 },
        noise_rad: 1e-4,
        excess_residual_rad: 0.0,
    };
    let weights = [("flexor", 0.912), ("extensor", 1.0)];
    let session = SessionEstimate {
        robot: "elbow".into(),
        recording: "a.parquet".into(),
        baseline: Some("b.parquet".into()),
        baseline_time_utc_s: None,
        zero_std_rad: None,
        start_time_utc_s: None,
        duration_s: 60.0,
        temperature_c: Some(20.0),
        temperature_source: TemperatureSource::Stated,
        reference_temperature_c: None,
        joints: vec![tendon("flexor", Some(0.553e-3)), tendon("extensor", None)],
        joint_offsets: vec![JointOffset {
            name: "elbow".into(),
            offset_rad: Gaussian::new(4.99e-3, 0.39e-3),
        }],
        unobservable: vec![UnobservableCombination {
            tendons: Vec::from(weights.map(|(name, weight)| TendonWeight {
                name: name.into(),
                weight,
            })),
            std_rad: 21e-3,
            std_m: Some(0.4245e-3),
            remedies: vec![Remedy::MotorTorque, Remedy::TensionSensors],
            changes: vec![UnattributedChange {
                time_s: 30.0,
                interval_s: None,
                probability: Some(0.97),
            }],
        }],
        segments: Vec::new(),
        blocks: Vec::new(),
        payload_kg: Gaussian::default(),
        payload_changes: Vec::new(),
        external_force: None,
        motor_torque: MotorTorque::Unused,
        tension_used: false,
        rejected_share: 0.0,
        rejected_intervals: Vec::new(),
        poses: 9,
        online: None,
        nuisance: Vec::new(),
        damaged: false,
        warnings: Vec::new(),
    };
    let mut reading = made_up();
    reading.robot.joints = vec!["elbow".into()];
    EstimateDocument {
        method: Method::Absolute,
        session: Some(session),
        reading,
    }
}

#[test]
fn strands_report_joint_offsets_combinations_and_bounds() {
    let mut document = of_strands();
    let unwrapped = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = tables::document(&document, false);
    let words = unwrapped(&text);
    for needed in [
        "tendon offset 95 % CI elongation",
        "joint joint offset 95 % CI",
        "elbow 4.99 0.76",
        "not determined: the common tension of flexor and extensor (0.91 : 1), ± 0.83 mm; record the torque of every motor or their tensions to determine it",
        "flexor: strand slack for 93 % of the recording; elongation at least 0.55 mm",
        "change of one of flexor, extensor at 30.0 s",
        "tendon not identifiable from this recording",
    ] {
        assert!(words.contains(needed), "'{needed}' is missing:\n{text}");
    }
    assert!(!words.contains("extensor: strand slack"), "{text}");
    let page = html(&document);
    for needed in [
        ">tendon</th>",
        "Tendon flexor: offset over time",
        "joint offset",
        "the common tension of flexor and extensor (0.91 : 1)",
        "strand slack, elongation at least 0.55 mm",
        "The offsets of all tendons are estimated jointly",
    ] {
        assert!(page.contains(needed), "'{needed}' is missing");
    }
    let session = document.session.as_mut().unwrap();
    // Opposite signs are no common tension; a pair of one motor requires tension sensors.
    session.unobservable[0].tendons[1].weight = -0.5;
    session.unobservable[0].std_m = None;
    session.unobservable[0].remedies = vec![sinew_estimate::session::Remedy::TensionSensors];
    session.joints[0].lower_bound_m = Some(-0.1e-3);
    session.joint_offsets.clear();
    document.reading.robot.joints.clear();
    let words = unwrapped(&tables::document(&document, false));
    for needed in [
        "joint offset 95 % CI elongation",
        "not determined: a combination of flexor and extensor (1 : −0.55), ± 41 mrad; record their tensions to determine it",
        "flexor: strand slack for 93 % of the recording; elongation not determinable",
    ] {
        assert!(words.contains(needed), "'{needed}' is missing:\n{words}");
    }
    assert!(!words.contains("joint joint offset"), "{words}");
}
