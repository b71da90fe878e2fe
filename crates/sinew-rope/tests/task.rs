//! Unspecified values of a rope's task come from the tendon or are defaults.

use sinew_model::transmission::{Guide as TendonGuide, Tendon};
use sinew_rope::duty::Duty;
use sinew_rope::predict::{Guide, TIMES_DEFAULT_S};
use sinew_rope::task::{Drive, PretensionTask, RopeTask, TaskError};
use sinew_rope::{Catalogue, Draws};

fn tendon() -> Tendon {
    Tendon {
        rope: Some("liros-dc000-0301".into()),
        length_m: 0.65,
        joint_pulley_radius_m: 0.025,
        pretension_n: Some(40.0),
        antagonistic: true,
        guides: vec![TendonGuide {
            radius_m: 0.008,
            wrap_rad: 1.0,
            friction: 0.0,
        }],
        retension_at_m: None,
        replace_at_strain: None,
        frame_expansion_per_k: None,
    }
}

#[test]
fn task_takes_unspecified_values_from_tendon() {
    let nothing = RopeTask::default();
    assert!(matches!(nothing.request(None), Err(TaskError::NoDuty)));
    let tendon = tendon();
    let own = nothing.request(Some(&tendon)).unwrap();
    assert_eq!(own.duty, Duty::constant(40.0, 23.0));
    assert_eq!((own.route.length_m, own.route.pulleys.len()), (0.65, 1));
    // Friction 0 of a robot is not stated: the rope's counts.
    assert_eq!(own.route.pulleys[0].friction, None);
    assert_eq!(own.times_s, TIMES_DEFAULT_S);
    let stated = RopeTask {
        tension_n: Some(60.0),
        length_m: Some(1.2),
        guides: vec![
            Guide {
                wrap_rad: 1.5,
                radius_m: 0.01,
                friction: None,
                at_m: None,
            };
            2
        ],
        times_s: vec![3600.0, 60.0],
        ..RopeTask::default()
    };
    let asked = stated.request(Some(&tendon)).unwrap();
    assert_eq!(asked.duty, Duty::constant(60.0, 23.0));
    assert_eq!((asked.route.length_m, asked.route.pulleys.len()), (1.2, 2));
    // Times rise, in whatever order they were named.
    assert_eq!(asked.times_s, [60.0, 3600.0]);
    // Without a tendon: a metre, straight.
    let plain = RopeTask {
        guides: Vec::new(),
        length_m: None,
        ..stated
    };
    let plain = plain.request(None).unwrap();
    assert_eq!((plain.route.length_m, plain.route.pulleys.len()), (1.0, 0));
}

#[test]
fn plan_takes_series_compliance_from_joint_stiffness() {
    let catalogue = Catalogue::shipped().unwrap();
    let rope = catalogue.find("liros-dc000-0301").unwrap();
    let tendon = tendon();
    let task = PretensionTask::default();
    assert!(matches!(
        task.request(rope, None),
        Err(TaskError::NoTension)
    ));
    let stiffness = 60.0;
    let drive = Drive {
        stiffness_nm_per_rad: stiffness,
        tendon: tendon.clone(),
        slides: false,
    };
    let asked = task.request(rope, Some(&drive)).unwrap();
    assert_eq!((asked.tension_n, asked.lowest_n), (40.0, 32.0));
    let joint = asked.mount.joint.unwrap();
    assert_eq!((joint.radius_m, joint.torque_nm), (0.025, 0.0));
    // c = n r²/K − (dl/dT of the rope), two strands.
    let law = Draws::new(rope, 0, 0).unwrap().nominal;
    let load = sinew_rope::law::RopeLoad::celsius(40.0, 23.0);
    let own = 0.65 * 0.01 * law.compliance_percent_per_n(load).unwrap();
    let give = (2.0 * 0.025 * 0.025 / stiffness - own).max(0.0);
    assert!((asked.mount.series_compliance_m_per_n - give).abs() < 1e-18);
    let sliding = Drive {
        slides: true,
        ..drive
    };
    let slides = task.request(rope, Some(&sliding)).unwrap().mount.joint;
    assert!(slides.unwrap().slides && !joint.slides);
    // One rope holds no torque, and nothing is tensioned again before it is tensioned.
    let alone = PretensionTask {
        tension_n: Some(60.0),
        torque_nm: 2.0,
        ..PretensionTask::default()
    };
    assert!(matches!(
        alone.request(rope, None),
        Err(TaskError::TorqueAlone)
    ));
    let high = PretensionTask {
        tension_n: Some(60.0),
        lowest_n: Some(60.0),
        ..PretensionTask::default()
    };
    let refused = high.request(rope, None);
    assert!(
        matches!(refused, Err(TaskError::Lowest { .. })),
        "{refused:?}"
    );
}
