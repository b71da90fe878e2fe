//! Build script: linker search path for the memory layout of the chip, and the image of the robot.

use std::path::PathBuf;

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-env-changed=SINEW_ROBOT_IMAGE");
    let image = std::env::var("SINEW_ROBOT_IMAGE")
        .expect("SINEW_ROBOT_IMAGE must be set to a file written by `microcontroller prepare`");
    let image = PathBuf::from(image)
        .canonicalize()
        .expect("SINEW_ROBOT_IMAGE must be the path of an existing file");
    println!("cargo:rerun-if-changed={}", image.display());
    println!("cargo:rustc-env=SINEW_ROBOT_IMAGE={}", image.display());
}
