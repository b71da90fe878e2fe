//! Temperature effect on a robot's offsets, from the rope catalogue.

use sinew_model::robot::Robot;
use sinew_rope::thermal::thermal_effect;
use sinew_rope::{Catalogue, CatalogueError};
use std::path::Path;

/// Sets the temperature effect on the offset of every tendon whose rope is in the catalogue. The catalogue
/// consists of the shipped ropes, `./ropes` and the folder `ropes` next to robot.toml; it is read only if a
/// tendon names a rope.
///
/// # Errors
/// Returns [`CatalogueError`] if a folder or the file of a tendon's rope cannot be read. A rope that is not in the catalogue is no error:
/// its drift is then 0 ± the tolerance.
pub fn look_up(robot: &mut Robot, robot_file: &Path) -> Result<(), CatalogueError> {
    let tendons = robot.transmissions.iter().flatten();
    let named = |t: &sinew_model::transmission::Transmission| {
        t.tendon.as_ref().is_some_and(|t| t.rope.is_some())
    };
    if tendons.filter(|t| named(t)).count() == 0 {
        return Ok(());
    }
    let of_robot = robot_file.parent().unwrap_or(Path::new("")).join("ropes");
    let mut folders = vec![Path::new("ropes"), &of_robot];
    folders.retain(|f| f.is_dir());
    folders.dedup();
    let catalogue = Catalogue::with_implied_folders(&folders, &[])?;
    let tendons = robot.transmissions.iter().flatten();
    for name in tendons.filter_map(|t| t.tendon.as_ref()?.rope.as_deref()) {
        match catalogue.find(name) {
            Ok(_) | Err(CatalogueError::Unknown { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    expect(robot, &catalogue);
    Ok(())
}

/// Sets the temperature effects from a loaded catalogue, see [`look_up`].
pub fn expect(robot: &mut Robot, catalogue: &Catalogue) {
    let tolerances = robot.tolerances;
    for transmission in robot.transmissions.iter_mut().flatten() {
        let Some(tendon) = &transmission.tendon else {
            continue;
        };
        let rope = tendon.rope.as_deref().map(|name| catalogue.find(name));
        if let Some(Ok(rope)) = rope {
            transmission.temperature_effect = thermal_effect(rope, tendon, &tolerances);
        }
    }
}
