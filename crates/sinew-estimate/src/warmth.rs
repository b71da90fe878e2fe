//! What warmth does to a robot's offsets, looked up in the catalogue of ropes.

use sinew_model::robot::Robot;
use sinew_rope::warmth::warmth;
use sinew_rope::{Catalogue, CatalogueError};
use std::path::Path;

/// Looks up, for every tendon whose rope the catalogue has, what warmth does to its offset. The catalogue
/// is the shipped one, `./ropes` and the folder `ropes` beside robot.toml; it is read only where a
/// tendon names a rope.
///
/// # Errors
/// [`CatalogueError`] for a rope's file that can't be read. A rope that isn't there is no error: the
/// drift is then 0 ± the tolerance.
pub fn look_up(robot: &mut Robot, robot_file: &Path) -> Result<(), CatalogueError> {
    let tendons = robot.transmissions.iter().flatten();
    let named = |t: &sinew_model::transmission::Transmission| {
        t.tendon.as_ref().is_some_and(|t| t.rope.is_some())
    };
    if tendons.filter(|t| named(t)).count() == 0 {
        return Ok(());
    }
    let beside = robot_file.parent().unwrap_or(Path::new("")).join("ropes");
    let mut folders = vec![Path::new("ropes"), &beside];
    folders.retain(|f| f.is_dir());
    folders.dedup();
    let catalogue = Catalogue::with_folders(&folders)?;
    expect(robot, &catalogue);
    Ok(())
}

/// [`look_up`] in a catalogue that is at hand.
pub fn expect(robot: &mut Robot, catalogue: &Catalogue) {
    let tolerances = robot.tolerances;
    for transmission in robot.transmissions.iter_mut().flatten() {
        let Some(tendon) = &transmission.tendon else {
            continue;
        };
        let rope = tendon.rope.as_deref().map(|name| catalogue.find(name));
        if let Some(Ok(rope)) = rope {
            transmission.warmth = warmth(rope, tendon, &tolerances);
        }
    }
}
