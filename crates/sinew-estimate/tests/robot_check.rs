//! `sinew robot check`: each kind of finding from one error in a shipped robot, none from a valid one.

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

/// Replaces the first `from` after `after` by `to`.
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

/// Failures of all cases, reported together.
#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    fn unless(&mut self, right: bool, message: impl FnOnce() -> String) {
        if !right {
            self.0.push(message());
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

/// Finding of this kind, with the line of the error.
fn found(check: &RobotCheck, kind: K, case: &str) -> Finding {
    let of_kind = check.findings.iter().find(|f| f.kind == kind);
    let finding = of_kind.unwrap_or_else(|| panic!("{case}: {:?}", check.findings));
    finding.clone()
}

#[test]
fn robot_toml_unit_errors_report_line_and_unit() {
    use Severity::{Implausible, Impossible, Missing};
    let (toml, urdf) = biorob();
    let mut faults = Faults::default();
    // Joint, from, to, kind, severity, unit it looks like.
    let elbow = "[joints.elbow]";
    let tendon = "[joints.elbow.tendon]";
    #[rustfmt::skip]
    let cases = [
        (tendon, "length_mm = 700.0", "length_mm = 0.7", K::Range, Impossible, Some("m")),
        (tendon, "length_mm = 700.0", "length_mm = 0.52", K::Range, Impossible, Some("m")),
        (tendon, "length_mm = 700.0", "length_mm = 7.0", K::Range, Implausible, None),
        (tendon, "length_mm = 700.0", "length_mm = 700000", K::Range, Impossible, Some("µm")),
        (tendon, "_radius_mm = 25.0", "_radius_mm = 0.025", K::Range, Impossible, Some("m")),
        (tendon, "radius_mm = 8.0", "radius_mm = 0.008", K::Range, Impossible, Some("m")),
        (tendon, "radius_mm = 8.0", "radius_mm = 2.5", K::PulleyDiameter, Implausible, None),
        (tendon, "wrap_deg = 90.0", "wrap_deg = 9000.0", K::Range, Implausible, None),
        (tendon, "friction = 0.05", "friction = 5.0", K::Range, Implausible, None),
        (tendon, "retension_at_mm = 0.5", "retension_at_mm = 0.0005", K::Range, Implausible, Some("m")),
        (tendon, "retension_at_mm = 0.5", "retension_at_mm = 500", K::Range, Implausible, Some("µm")),
        (tendon, "_radius_mm = 25.0", "_radius_mm = 3.0", K::StifferThanRope, Implausible, None),
        (tendon, "pretension_n = 60.0", "pretension_n = 0.06", K::Range, Implausible, Some("kN")),
        (tendon, "pretension_n = 60.0", "pretension_n = 5000", K::Pretension, Impossible, Some("mN")),
        (tendon, "pretension_n = 60.0", "pretension_n = 1500", K::Pretension, Implausible, None),
        (tendon, "liros-dc000-0301", "liros-dc000-031", K::UnknownRope, Implausible, None),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 20000.0", K::StifferThanRope, Impossible, Some("N·mm/rad")),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 0.020", K::Sag, Impossible, Some("kN·m/rad")),
        (elbow, "stiffness_nm_per_rad = 20.0", "stiffness_nm_per_rad = 0.9", K::Sag, Implausible, None),
        (elbow, "motor_inertia_kg_m2 = 0.06", "motor_inertia_kg_m2 = 60.0", K::MotorInertia, Implausible, None),
        (elbow, "motor_inertia_kg_m2 = 0.06", "motor_inertia_kg_m2 = 0.000006", K::MotorInertia, Implausible, None),
        (elbow, "coulomb_nm = 0.05", "coulomb_nm = 50.0", K::Friction, Implausible, Some("N·mm")),
        (elbow, "coulomb_nm = 0.05", "coulomb_nm = 0.00005", K::Friction, Implausible, Some("kN·m")),
        (elbow, "stiffness_nm_per_rad = 20.0\n", "", K::Gap, Missing, None),
        (elbow, "[joints.elbow]", "[joints.elbo]\nrigid = true\n[joints.elbow]", K::UnknownJoint, Impossible, None),
        ("urdf", "[joints.", "gravity_m_s2 = [0, 0, -9810]\n[joints.", K::Gravity, Impossible, Some("mm/s²")),
        ("urdf", "[joints.", "gravity_m_s2 = [0, 0, 9.81]\n[joints.", K::GravityUp, Implausible, None),
        ("urdf", "[joints.", "base_rpy_rad = [180, 0, 0]\n[joints.", K::Range, Implausible, Some("°")),
        ("[tolerances]", "drift_mrad_per_k", "stiffness_percent = 1200\ndrift_mrad_per_k", K::Range, Implausible, None),
        ("[tolerances]", "drift_mrad_per_k", "payload_reach_mm = 0.05\ndrift_mrad_per_k", K::Range, Implausible, Some("m")),
        ("[tolerances]", "drift_mrad_per_k", "payload_kg = 5000\ndrift_mrad_per_k", K::Range, Implausible, Some("g")),
        ("[tolerances]", "drift_mrad_per_k", "zero_mrad = 0.01\ndrift_mrad_per_k", K::Range, Implausible, Some("rad")),
        ("[tolerances]", "drift_mrad_per_k", "temperature_k = 295\ndrift_mrad_per_k", K::Range, Implausible, None),
        ("[tolerances]", "drift_mrad_per_k", "external_force_n = 5000\ndrift_mrad_per_k", K::Range, Implausible, Some("mN")),
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
        // A finding that compares two keys may refer to either.
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
    let rope = found(&names, K::UnknownRope, "a typing error");
    assert_eq!(rope.text.as_deref(), Some("liros-dc000-031"));
    assert_eq!(rope.names[0], "liros-dc000-0301");
}

#[test]
fn urdf_unit_errors_report_line_and_unit() {
    use Severity::{Implausible, Impossible};
    let (toml, urdf) = biorob();
    let mut faults = Faults::default();
    let forearm = "<link name=\"forearm\">";
    let elbow = "<joint name=\"elbow\"";
    #[rustfmt::skip]
    let cases = [
        (forearm, "mass value=\"0.3\"", "mass value=\"800\"", K::HeavyLink, Impossible, Some("g")),
        (forearm, "mass value=\"0.3\"", "mass value=\"300\"", K::Density, Implausible, Some("g")),
        (forearm, "mass value=\"0.3\"", "mass value=\"0.0003\"", K::InertiaSize, Implausible, Some("t")),
        (forearm, "ixx=\"0.00225\" ixy=\"0\" ixz=\"0\" iyy=\"0.00225\" iyz=\"0\" izz=\"0.0000432\"", "ixx=\"2250\" ixy=\"0\" ixz=\"0\" iyy=\"2250\" iyz=\"0\" izz=\"43.2\"", K::InertiaSize, Implausible, Some("kg·mm²")),
        (forearm, "ixx=\"0.00225\" ixy=\"0\" ixz=\"0\" iyy=\"0.00225\" iyz=\"0\" izz=\"0.0000432\"", "ixx=\"2.25e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2.25e-6\" iyz=\"0\" izz=\"4.3e-8\"", K::Density, Implausible, None),
        (forearm, "izz=\"0.0000432\"", "izz=\"0.0432\"", K::InertiaTriangle, Implausible, None),
        (forearm, "ixy=\"0\"", "ixy=\"0.01\"", K::InertiaNotDefinite, Implausible, None),
        (forearm, "0 0 -0.13", "0 0 -130", K::Distance, Impossible, Some("mm")),
        (elbow, "0 0 -0.31", "0 0 -310", K::Distance, Impossible, Some("mm")),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"0\" upper=\"0\"", K::RangeWidth, Implausible, None),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"2.4\" upper=\"-0.3\"", K::RangeReversed, Implausible, None),
        (elbow, "lower=\"-0.3\" upper=\"2.4\"", "lower=\"-17\" upper=\"137\"", K::Range, Implausible, Some("°")),
        (elbow, "effort=\"10\"", "effort=\"0.01\"", K::EffortLimit, Implausible, Some("kN·m")),
        (elbow, "effort=\"10\"", "effort=\"-10\"", K::NegativeLimit, Impossible, None),
        (elbow, "effort=\"10\"", "effort=\"500\"", K::LargestPull, Implausible, None),
        (elbow, "velocity=\"6\"", "velocity=\"344\"", K::SpeedLimit, Implausible, Some("°/s")),
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
    // A whole arm in grams, including inertias: every link is denser than any matter.
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
fn masses_and_stiffness_are_checked_against_whole_arm() {
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

    // A spring without a rope that would bound it.
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
fn mapping_with_implausible_factors_is_reported() {
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

// Checks of published robots: nothing is reported as impossible, and values reported as
// implausible are so. The identified LWR has impossible inertias; the hand's inertias are those of
// links metres wide.
#[test]
fn placeholder_inertia_has_no_unit_hint() {
    let toml = "urdf = \"finger.urdf\"\n[joints.base]\nstiffness_nm_per_rad = 1.0\n[joints.tip]\nstiffness_nm_per_rad = 1.0\n";
    for (mass, inertia) in [
        ("0.001", ["0.001"; 3]),
        ("0.0123", ["0.01"; 3]),
        ("0.002", ["0.001", "0.002", "0.002"]),
        ("1", ["1e-9"; 3]),
    ] {
        let [ixx, iyy, izz] = inertia;
        let link = |name: &str| {
            format!(
                "<link name='{name}'><inertial><origin xyz='0.02 0 0'/><mass value='{mass}'/><inertia ixx='{ixx}' ixy='0' ixz='0' iyy='{iyy}' iyz='0' izz='{izz}'/></inertial></link>"
            )
        };
        let joint = |name: &str, parent: &str, child: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='0.04 0 0'/><axis xyz='0 0 1'/><limit lower='0' upper='1.6' effort='2' velocity='6'/></joint>"
            )
        };
        let urdf = format!(
            "<robot name='finger'><link name='palm'/>{}{}{}{}</robot>",
            link("near"),
            link("far"),
            joint("base", "palm", "near"),
            joint("tip", "near", "far"),
        );
        let checked = check(toml, "finger.urdf", &urdf);
        let kinds: Vec<K> = checked.findings.iter().map(|f| f.kind).collect();
        let placeholders = kinds
            .iter()
            .filter(|k| **k == K::InertiaPlaceholder)
            .count();
        assert_eq!(placeholders, 2, "{mass}: {kinds:?}");
        assert!(!kinds.contains(&K::InertiaSize) && !kinds.contains(&K::Density));
        let of_mass = |f: &Finding| f.unit.starts_with("kg") && f.slip.is_some();
        assert!(
            !checked.findings.iter().any(of_mass),
            "{:?}",
            checked.findings
        );
    }
}

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
            assert_eq!(
                finding.severity,
                Severity::Implausible,
                "{name}: {finding:?}"
            );
            assert!(odd.contains(&finding.kind), "{name}: {finding:?}");
        }
        println!("{name}: {} findings", checked.findings.len());
    }
}

const ELBOW_URDF: &str = r#"<robot name="elbow">
<link name="base"/>
<link name="forearm"><inertial><origin xyz="0 0 -0.15"/><mass value="0.6"/>
<inertia ixx="0.006" iyy="0.006" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow" type="revolute"><parent link="base"/><child link="forearm"/><axis xyz="0 1 0"/>
<limit lower="-1.5" upper="1.3" effort="20" velocity="5"/></joint>
</robot>"#;

/// Elbow with two strands, each wound by the motor of the given line.
fn antagonist([flexor, extensor]: [&str; 2]) -> String {
    format!(
        r#"urdf = "elbow.urdf"
[joints.elbow]
joint_friction = {{ coulomb_nm = 0.04 }}
[motors.flexor]
inertia_kg_m2 = 0.002
[motors.extensor]
inertia_kg_m2 = 0.002
[[tendons]]
name = "flexor"
kind = "strand"
drums_mm = {{ {flexor} }}
moment_arms_mm = {{ elbow = 20.0 }}
stiffness_n_per_mm = 20.0
pretension_n = 60.0
length_mm = 400.0
[[tendons]]
name = "extensor"
kind = "strand"
drums_mm = {{ {extensor} }}
moment_arms_mm = {{ elbow = -20.0 }}
stiffness_n_per_mm = 20.0
pretension_n = 60.0
length_mm = 500.0
"#
    )
}

fn unwrapped(check: &RobotCheck) -> String {
    let text = sinew_report::robot::render(check);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn report_lists_strands_per_tendon_and_limits_per_joint() {
    let own = ["flexor = 10.0", "extensor = 10.0"];
    let checked = check(&antagonist(own), "elbow.urdf", ELBOW_URDF);
    let [elbow] = &checked.joints[..] else {
        panic!("{:?}", checked.joints);
    };
    assert_eq!(elbow.crossed_by, ["flexor", "extensor"]);
    assert_eq!((elbow.lower_rad, elbow.upper_rad), (Some(-1.5), Some(1.3)));
    assert_eq!((elbow.stiffness_nm_per_rad, &elbow.tendon), (None, &None));
    assert_eq!(elbow.friction_specified, Some(true));
    for (drive, (name, length_m)) in
        (checked.drives.iter()).zip([("flexor", 0.4), ("extensor", 0.5)])
    {
        assert_eq!((drive.name.as_str(), drive.joint.as_str()), (name, "elbow"));
        assert!((drive.stiffness_nm_per_rad - 8.0).abs() < 1e-9);
        assert!((drive.motor_inertia_kg_m2.unwrap() - 0.008).abs() < 1e-9);
        let rope = drive.tendon.as_ref().unwrap();
        assert_eq!((rope.length_m, rope.taut_up_to_nm), (length_m, None));
    }
    assert_eq!(checked.drives.len(), 2);
    let text = unwrapped(&checked);
    for needed in [
        "elbow flexor, extensor −1.50 1.30",
        "flexor elbow 8.00 0.0080 400.0 20.0 0.0200",
        "flexor, extensor: one equation per joint (elbow); not every elongation is observable from motion",
        "not observable from joint motion: the common tension of flexor and extensor (1 : 1); record the torque of every motor or their tensions to determine it",
    ] {
        assert!(text.contains(needed), "'{needed}' is missing:\n{text}");
    }
    for never in ["rigid", "2 r f0", "does not have yet"] {
        assert!(!text.contains(never), "'{never}':\n{text}");
    }
    assert!(checked.routing.unwrap().unobservable[0].shown_by_motor_torque);
}

// With springs one strand is observable in both joints, and a varying moment arm makes the common tension observable.
#[test]
fn springs_or_varying_moment_arms_make_groups_observable() {
    let Some(robots) = shared("tendons/robots") else {
        return;
    };
    let ropes = Catalogue::shipped().expect("shipped");
    for (name, unobservable) in [
        ("antagonistic-elbow", 1),
        ("n-plus-1-finger", 1),
        ("moment-arm-of-q", 0),
        ("coupled-two-joints", 0),
        ("coupled-arm", 0),
        ("wam-like-differential", 0),
    ] {
        let (loaded, gaps) = draft(&robots.join(name), None).expect(name);
        let checked = RobotCheck::of(&loaded, &gaps, &ropes).expect(name);
        let routing = checked.routing.as_ref().expect(name);
        assert_eq!(routing.unobservable.len(), unobservable, "{name}");
        let text = unwrapped(&checked);
        assert!(
            !text.contains("rigid") && !text.contains("2 r f0"),
            "{text}"
        );
        let shows = text.contains("; every elongation is observable from motion");
        let is_strung = checked.drives.iter().any(|d| d.name.contains("flexor"));
        assert_eq!(shows, is_strung && unobservable == 0, "{text}");
    }
}

#[test]
fn pose_search_with_joint_equations_returns_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = ["flexor = 10.0", "extensor = 10.0"];
    std::fs::write(folder.path().join("robot.toml"), antagonist(own)).expect("written");
    std::fs::write(folder.path().join("elbow.urdf"), ELBOW_URDF).expect("written");
    let (loaded, _) = draft(folder.path(), None).expect("a draft");
    let options = sinew_estimate::excitation::Options::default();
    let refused =
        sinew_estimate::excitation::propose(&loaded.robot, None, &options, &mut |_, _| {});
    let error = refused.unwrap_err().to_string();
    for needed in [
        "does not support",
        "(flexor, extensor)",
        "co-contraction",
        "torque of every motor",
    ] {
        assert!(error.contains(needed), "{error}");
    }
}
