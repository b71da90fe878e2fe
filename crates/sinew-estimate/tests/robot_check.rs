//! `sinew robot check`: each kind of finding from one slip in a shipped robot, none from a sound one.

use crate::support::{repository as root, shared};
use sinew_estimate::robot_check::{Finding, FindingKind as K, RobotCheck, Severity};
use sinew_estimate::robot_dir::draft;
use sinew_rope::Catalogue;
use std::path::Path;

fn check(robot_toml: &str, urdf_name: &str, urdf: &str) -> RobotCheck {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("robot.toml"), robot_toml).expect("written");
    std::fs::write(folder.path().join(urdf_name), urdf).expect("written");
    let (loaded, gaps) = draft(folder.path(), None).expect("a draft");
    let ropes = Catalogue::shipped().expect("shipped");
    RobotCheck::of(&loaded, &gaps, &ropes).expect("checked")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A text in which `from`, which stands there, is `to` at its first place after `after`.
fn slip(text: &str, after: &str, from: &str, to: &str) -> String {
    let start = text.find(after).expect(after);
    let at = start + text[start..].find(from).expect(from);
    format!("{}{to}{}", &text[..at], &text[at + from.len()..])
}

fn biorob() -> (String, String) {
    let folder = root().join("robots/biorob-like");
    (
        read(&folder.join("robot.toml")),
        read(&folder.join("biorob-like.urdf")),
    )
}

const URDF: &str = "biorob-like.urdf";

/// Faults of all cases, told at once.
#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    fn unless(&mut self, right: bool, told: impl FnOnce() -> String) {
        if !right {
            self.0.push(told());
        }
    }
}

impl Drop for Faults {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.0.is_empty(), "{:#?}", self.0);
        }
    }
}

/// The finding of this kind, with its line that of the slip.
fn found(check: &RobotCheck, kind: K, case: &str) -> Finding {
    let of_kind = check.findings.iter().find(|f| f.kind == kind);
    let finding = of_kind.unwrap_or_else(|| panic!("{case}: {:?}", check.findings));
    finding.clone()
}

#[test]
fn each_slip_in_robot_toml_is_named_with_its_line_and_the_unit_it_looks_like() {
    use Severity::{Impossible, Missing, Odd};
    let (toml, urdf) = biorob();
    let mut faults = Faults::default();
    // Joint, from, to, kind, severity, unit it looks like.
    let elbow = "[joints.elbow]";
    let tendon = "[joints.elbow.tendon]";
    #[rustfmt::skip]
    let cases = [
        (tendon, "length_mm = 700.0", "length_mm = 0.7", K::Range, Impossible, Some("m")),
        (tendon, "length_mm = 700.0", "length_mm = 0.52", K::Range, Impossible, Some("m")),
        (tendon, "length_mm = 700.0", "length_mm = 7.0", K::Range, Odd, None),
        (tendon, "length_mm = 700.0", "length_mm = 700000", K::Range, Impossible, Some("µm")),
        (tendon, "_radius_mm = 25.0", "_radius_mm = 0.025", K::Range, Impossible, Some("m")),
        (tendon, "radius_mm = 8.0", "radius_mm = 0.008", K::Range, Impossible, Some("m")),
        (tendon, "radius_mm = 8.0", "radius_mm = 2.5", K::PulleyDiameter, Odd, None),
        (tendon, "wrap_deg = 90.0", "wrap_deg = 9000.0", K::Range, Odd, None),
        (tendon, "friction = 0.05", "friction = 5.0", K::Range, Odd, None),
        (tendon, "retension_at_mm = 0.5", "retension_at_mm = 0.0005", K::Range, Odd, Some("m")),
        (tendon, "retension_at_mm = 0.5", "retension_at_mm = 500", K::Range, Odd, Some("µm")),
        (tendon, "_radius_mm = 25.0", "_radius_mm = 3.0", K::StifferThanRope, Odd, None),
        (tendon, "pretension_n = 60.0", "pretension_n = 0.06", K::Range, Odd, Some("kN")),
        (tendon, "pretension_n = 60.0", "pretension_n = 5000", K::Pretension, Impossible, Some("mN")),
        (tendon, "pretension_n = 60.0", "pretension_n = 1500", K::Pretension, Odd, None),
        (tendon, "liros-dc000-0301", "liros-dc000-031", K::UnknownRope, Odd, None),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 20000.0", K::StifferThanRope, Impossible, Some("N·mm/rad")),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 0.020", K::Sag, Impossible, Some("kN·m/rad")),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 0.9", K::Sag, Odd, None),
        (elbow, "motor_inertia_kg_m2 = 0.06", "motor_inertia_kg_m2 = 60.0", K::MotorInertia, Odd, None),
        (elbow, "motor_inertia_kg_m2 = 0.06", "motor_inertia_kg_m2 = 0.000006", K::MotorInertia, Odd, None),
        (elbow, "coulomb_nm = 0.05", "coulomb_nm = 50.0", K::Friction, Odd, Some("N·mm")),
        (elbow, "coulomb_nm = 0.05", "coulomb_nm = 0.00005", K::Friction, Odd, Some("kN·m")),
        (elbow, "stiffness_nm_per_rad = 20.0\n", "", K::Gap, Missing, None),
        (elbow, "[joints.elbow]", "[joints.elbo]\nrigid = true\n[joints.elbow]", K::UnknownJoint, Impossible, None),
        ("urdf", "[joints.", "gravity_m_s2 = [0, 0, -9810]\n[joints.", K::Gravity, Impossible, Some("mm/s²")),
        ("urdf", "[joints.", "gravity_m_s2 = [0, 0, 9.81]\n[joints.", K::GravityUp, Odd, None),
        ("urdf", "[joints.", "base_rpy_rad = [180, 0, 0]\n[joints.", K::Range, Odd, Some("°")),
        ("[tolerances]", "drift_mrad_per_k", "stiffness_percent = 1200\ndrift_mrad_per_k", K::Range, Odd, None),
        ("[tolerances]", "drift_mrad_per_k", "payload_reach_mm = 0.05\ndrift_mrad_per_k", K::Range, Odd, Some("m")),
        ("[tolerances]", "drift_mrad_per_k", "payload_kg = 5000\ndrift_mrad_per_k", K::Range, Odd, Some("g")),
        ("[tolerances]", "drift_mrad_per_k", "zero_mrad = 0.01\ndrift_mrad_per_k", K::Range, Odd, Some("rad")),
        ("[tolerances]", "drift_mrad_per_k", "temperature_k = 295\ndrift_mrad_per_k", K::Range, Odd, None),
        ("[tolerances]", "drift_mrad_per_k", "external_force_n = 5000\ndrift_mrad_per_k", K::Range, Odd, Some("mN")),
    ];
    for (after, from, to, kind, severity, unit) in cases {
        let text = slip(&toml, after, from, to);
        let checked = check(&text, URDF, &urdf);
        let case = format!("{from} → {to}");
        let Some(finding) = checked.findings.iter().find(|f| f.kind == kind) else {
            faults.unless(false, || format!("{case}: {:?}", checked.findings));
            continue;
        };
        let is = (finding.severity, finding.slip.map(|s| s.unit));
        faults.unless(is == (severity, unit), || format!("{case}: {finding:?}"));
        let worst = checked.worst() == Some(severity);
        faults.unless(worst, || format!("{case}: {:?}", checked.findings));
        // What is judged against another key stands at either.
        let changed = text.lines().zip(toml.lines()).position(|(a, b)| a != b);
        let line = changed.map(|n| n as u64 + 1);
        if !matches!(kind, K::Gap | K::StifferThanRope | K::UnknownJoint) {
            faults.unless(finding.at.line == line, || format!("{case}: {finding:?}"));
        }
        assert!(
            finding.at.file.ends_with("robot.toml"),
            "{case}: {finding:?}"
        );
    }
    let names = check(&slip(&toml, tendon, "0301", "031"), URDF, &urdf);
    let rope = found(&names, K::UnknownRope, "a slip of the pen");
    assert_eq!(rope.text.as_deref(), Some("liros-dc000-031"));
    assert_eq!(rope.names[0], "liros-dc000-0301");
}

#[test]
fn each_slip_in_a_urdf_is_named_with_its_line_and_the_unit_it_looks_like() {
    use Severity::{Impossible, Odd};
    let (toml, urdf) = biorob();
    let mut faults = Faults::default();
    let forearm = "<link name=\"forearm\">";
    let elbow = "<joint name=\"elbow\"";
    #[rustfmt::skip]
    let cases = [
        (forearm, "mass value=\"0.3\"", "mass value=\"800\"", K::HeavyLink, Impossible, Some("g")),
        (forearm, "mass value=\"0.3\"", "mass value=\"300\"", K::Density, Odd, Some("g")),
        (forearm, "mass value=\"0.3\"", "mass value=\"0.0003\"", K::InertiaSize, Odd, Some("t")),
        (forearm, "ixx=\"0.00225\" ixy=\"0\" ixz=\"0\" iyy=\"0.00225\" iyz=\"0\" izz=\"0.0000432\"", "ixx=\"2250\" ixy=\"0\" ixz=\"0\" iyy=\"2250\" iyz=\"0\" izz=\"43.2\"", K::InertiaSize, Odd, Some("kg·mm²")),
        (forearm, "ixx=\"0.00225\" ixy=\"0\" ixz=\"0\" iyy=\"0.00225\" iyz=\"0\" izz=\"0.0000432\"", "ixx=\"2.25e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2.25e-6\" iyz=\"0\" izz=\"4.3e-8\"", K::Density, Odd, None),
        (forearm, "izz=\"0.0000432\"", "izz=\"0.0432\"", K::InertiaTriangle, Odd, None),
        (forearm, "ixy=\"0\"", "ixy=\"0.01\"", K::InertiaNotDefinite, Odd, None),
        (forearm, "0 0 -0.13", "0 0 -130", K::Distance, Impossible, Some("mm")),
        (elbow, "0 0 -0.31", "0 0 -310", K::Distance, Impossible, Some("mm")),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"0\" upper=\"0\"", K::RangeWidth, Odd, None),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"2.4\" upper=\"-0.3\"", K::RangeReversed, Odd, None),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"-17\" upper=\"137\"", K::Range, Odd, Some("°")),
        (elbow, "effort=\"10\"", "effort=\"0.01\"", K::EffortLimit, Odd, Some("kN·m")),
        (elbow, "effort=\"10\"", "effort=\"-10\"", K::NegativeLimit, Impossible, None),
        (elbow, "effort=\"10\"", "effort=\"500\"", K::LargestPull, Odd, None),
        (elbow, "velocity=\"6\"", "velocity=\"344\"", K::SpeedLimit, Odd, Some("°/s")),
    ];
    for (after, from, to, kind, severity, unit) in cases {
        let text = slip(&urdf, after, from, to);
        let checked = check(&toml, URDF, &text);
        let case = format!("{from} → {to}");
        let Some(finding) = checked.findings.iter().find(|f| f.kind == kind) else {
            faults.unless(false, || format!("{case}: {:?}", checked.findings));
            continue;
        };
        let is = (finding.severity, finding.slip.map(|s| s.unit));
        faults.unless(is == (severity, unit), || format!("{case}: {finding:?}"));
        let worst = checked.worst() == Some(severity);
        faults.unless(worst, || format!("{case}: {:?}", checked.findings));
        assert!(finding.at.line.is_some(), "{case}: {finding:?}");
    }
    // A whole arm in grams, inertias too: denser than any matter, link by link.
    let grams = urdf
        .replace("mass value=\"0.3\"", "mass value=\"300\"")
        .replace("0.00225", "2.25")
        .replace("0.0000432", "0.0432");
    let heavy = check(&toml, URDF, &grams);
    let kinds: Vec<K> = heavy.findings.iter().map(|f| f.kind).collect();
    assert!(
        kinds.contains(&K::HeavyLink) || kinds.contains(&K::Density),
        "{kinds:?}"
    );
}

#[test]
fn masses_and_stiffness_are_judged_by_the_whole_arm() {
    let (toml, urdf) = biorob();
    let scaled = |link: &str, factor: f64| {
        let (start, mut out) = (urdf.find(link).expect(link), urdf.clone());
        let end = start + urdf[start..].find("</link>").expect("an end");
        let mut part = urdf[start..end].to_owned();
        for name in ["value", "ixx", "iyy", "izz"] {
            let at = part.find(&format!("{name}=\"")).expect(name) + name.len() + 2;
            let to = at + part[at..].find('"').expect("a quote");
            let number: f64 = part[at..to].parse().expect("a number");
            part.replace_range(at..to, &(factor * number).to_string());
        }
        out.replace_range(start..end, &part);
        out
    };
    let light = check(&toml, URDF, &scaled("<link name=\"forearm\">", 1e-3));
    found(&light, K::LightLink, "a forearm of 0.3 g");
    let heavy = check(&toml, URDF, &scaled("<link name=\"hand\">", 400.0));
    found(&heavy, K::HeavyLink, "a hand of 100 kg");
    let mut all = urdf.clone();
    for link in ["upper_arm", "forearm", "hand", "column"] {
        let name = format!("<link name=\"{link}\">");
        let start = all.find(&name).expect("a link");
        let end = start + all[start..].find("</link>").expect("an end");
        let of_one = scaled(&name, 1e-3);
        let from = of_one.find(&name).expect("a link");
        let to = from + of_one[from..].find("</link>").expect("an end");
        all.replace_range(start..end, &of_one[from..to]);
    }
    let feathers = check(&toml, URDF, &all);
    let whole = found(&feathers, K::ArmMass, "all masses in t");
    assert_eq!(whole.slip.map(|s| s.unit), Some("t"));

    // A spring of its own, without a rope that would bound it.
    let folder = root().join("examples/05-your-own-robot");
    let (toml, urdf) = (
        read(&folder.join("robot.toml")),
        read(&folder.join("pan-tilt.urdf")),
    );
    let with = |k: &str| slip(&toml, "[joints.tilt]", "stiffness_nm_per_rad = 15.0", k);
    let stiff = check(
        &with("stiffness_nm_per_rad = 15000000.0"),
        "pan-tilt.urdf",
        &urdf,
    );
    found(&stiff, K::Frequency, "K times a million");
}

#[test]
fn a_mapping_with_odd_factors_is_named() {
    let (toml, urdf) = biorob();
    let mut checked = check(&toml, URDF, &urdf);
    let odd = "[joints.elbow]\n\
               tau_m = { column = \"i\", unit = \"A\", torque_constant_nm_per_a = 50, gear_ratio = 50 }\n\
               theta = { column = \"m\", unit = \"count\", counts_per_turn = 4096, gear_ratio = 50000 }\n\
               q = { column = \"p\", scale = 1e9 }\n";
    checked.add_mapping(odd, "mapping.toml").expect("TOML");
    let at: Vec<_> = checked
        .findings
        .iter()
        .map(|f| (f.at.line, f.slip.map(|s| s.unit)))
        .collect();
    assert_eq!(
        at,
        [(Some(2), Some("mN·m/A")), (Some(3), None), (Some(4), None)]
    );
    let sound = root().join("examples/mappings/hebi.toml");
    let mut checked = check(&toml, URDF, &urdf);
    checked
        .add_mapping(&read(&sound), "hebi.toml")
        .expect("TOML");
    assert_eq!(checked.findings, []);
}

#[test]
fn shipped_robots_raise_no_finding() {
    let ropes = Catalogue::shipped().expect("shipped");
    for folder in [
        "robots/biorob-like",
        "examples/04-series-elastic-actuator",
        "examples/05-your-own-robot",
    ] {
        let (loaded, gaps) = draft(&root().join(folder), None).expect(folder);
        let check = RobotCheck::of(&loaded, &gaps, &ropes).expect(folder);
        assert_eq!(check.findings, [], "{folder}");
    }
}

/// What the checks say of robots others have published: nothing is called impossible, and what is
/// called odd is so. The identified LWR has inertias no body has; the hand's inertias are those of
/// links metres wide.
#[test]
fn published_robots_are_possible() {
    let Some(models) = shared("models") else {
        return;
    };
    for (name, odd) in [
        ("arm4", &[][..]),
        ("biorob_like", &[]),
        ("panda", &[]),
        ("so101", &[]),
        ("ur5", &[]),
        ("kuka_lwr4_identified", &[K::InertiaTriangle]),
        ("orcahand_v2_right", &[K::InertiaSize]),
    ] {
        let urdf = read(&models.join(format!("{name}.urdf")));
        let outline = sinew_model::arm::urdf::outline(&urdf).expect(name);
        let mut toml = format!("urdf = \"{name}.urdf\"\n");
        for joint in &outline.joints {
            if joint.joint_type.name() != "fixed" {
                toml += &format!("[joints.\"{}\"]\nrigid = true\n", joint.name);
            }
        }
        let checked = check(&toml, &format!("{name}.urdf"), &urdf);
        for finding in &checked.findings {
            assert_eq!(finding.severity, Severity::Odd, "{name}: {finding:?}");
            assert!(odd.contains(&finding.kind), "{name}: {finding:?}");
        }
        println!("{name}: {} findings", checked.findings.len());
    }
}
