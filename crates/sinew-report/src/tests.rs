use super::*;
use sinew_estimate::feeder::Injection;
use sinew_estimate::replay::*;
use sinew_estimate::{EstimateDocument, Method, RecordingWarning};
use sinew_figure::{Block, Page, Sentence};
use sinew_model::offset::{Comparison, TorqueSource};

/// An estimate of two joints and a refused one, made up.
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
            refused: None,
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
    wrist.refused = Some(JointRefusal::NoMotorPosition);
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
            rests_on: Origin::Stated,
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

/// The page of a paper's estimate.
fn page(reading: Estimate) -> String {
    html(&EstimateDocument {
        method: Method::Paper,
        session: None,
        reading,
    })
}

#[test]
fn each_joint_has_a_sentence_that_says_no_more_than_the_numbers() {
    let estimate = made_up();
    let say = |e: &Estimate, i: usize| headline(e, &e.joints[i]);
    assert_eq!(
        say(&estimate, 1),
        "elbow: the equation reads 10.40 ± 0.10 mrad (95 %, scatter alone); what a tendon 0.26 mm longer would show"
    );
    // A reading is no verdict.
    for verdict in ["no stretch seen", "longer than", "shorter than"] {
        assert!(
            !say(&estimate, 0).contains(verdict),
            "{}",
            say(&estimate, 0)
        );
    }
    assert_eq!(
        say(&estimate, 2),
        "wrist: no estimate; its motor position is not recorded"
    );
    let shrunk = with_difference(made_up(), -4.0);
    assert_eq!(
        say(&shrunk, 1),
        "elbow: the tendon is 0.10 mm shorter than in sunday.mcap (change −4.00 ± 0.14 mrad, 95 %)"
    );
    let mut bare = made_up();
    bare.joints[1].elongation_m = None;
    bare.joints[1].standard_error_rad = None;
    let sentence = say(&bare, 1);
    assert!(
        sentence.contains("10.4 mrad") && sentence.contains("too short"),
        "{sentence}"
    );
}

#[test]
fn the_page_stands_alone() {
    let page = page(with_difference(made_up(), 4.0));
    for needed in [
        "elbow: the tendon is 0.10 mm longer than in sunday.mcap",
        "right in differences",
        "rests on the stiffness",
        "settling after the start, a gap or missing samples",
        "2024-02-29 12:34:56 UTC",
        "as stated in robots/biorob-like/robot.toml",
        "Made by Sinew 0.1.0",
        "was damaged",
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
        2,
        "one figure per estimated joint"
    );
}

#[test]
fn the_page_is_well_formed() {
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
fn words_from_files_are_never_markup() {
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
fn an_estimate_of_nothing_is_still_a_page() {
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
fn sentences_show_their_verdict_and_criterion() {
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
    assert!(page.contains("<span class=\"verdict\">open</span>"));
    assert!(page.contains("Criterion: mean within 0.1 mrad of 5 mrad. Found: 4.99 mrad"));
}

#[test]
fn the_page_is_left_for_a_look() {
    // Beside the test binary, in target: open it in a browser after a change of style.
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
