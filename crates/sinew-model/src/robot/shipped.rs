//! Robot descriptions that ship with the program, as texts.

/// Name and texts of a robot that ships with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShippedRobot {
    /// Name of its folder in `robots/`.
    pub name: &'static str,
    /// Text of its `robot.toml`.
    pub robot_toml: &'static str,
    /// Text of its URDF.
    pub urdf: &'static str,
}

macro_rules! shipped {
    ($name:literal) => {
        ShippedRobot {
            name: $name,
            robot_toml: include_str!(concat!("../../robots/", $name, "/robot.toml")),
            urdf: include_str!(concat!("../../robots/", $name, "/", $name, ".urdf")),
        }
    };
}

/// The arm with four joints and one antagonistic rope per joint, similar to that of the paper.
pub const BIOROB_LIKE: ShippedRobot = shipped!("biorob-like");

/// All robots of `robots/`, by name.
pub const SHIPPED_ROBOTS: [ShippedRobot; 7] = [
    shipped!("antagonistic-elbow"),
    BIOROB_LIKE,
    shipped!("coupled-arm"),
    shipped!("differential-wrist"),
    shipped!("exosuit"),
    shipped!("finger"),
    shipped!("n-plus-1-finger"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::RobotFile;

    #[test]
    fn shipped_robots_are_listed_and_valid() {
        for robot in SHIPPED_ROBOTS {
            let file = RobotFile::parse(robot.robot_toml, "robot.toml");
            let built = file.and_then(|file| file.build(robot.urdf));
            assert!(built.is_ok(), "{}: {:?}", robot.name, built.err());
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/robots");
        let mut folders: alloc::vec::Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        folders.sort();
        assert_eq!(folders, SHIPPED_ROBOTS.map(|robot| robot.name));
    }
}
