//! Where the linker finds the chip's memory, and which robot goes into the program.

use std::path::PathBuf;

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where this is");
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-env-changed=SINEW_ROBOT_IMAGE");
    let image = std::env::var("SINEW_ROBOT_IMAGE")
        .expect("SINEW_ROBOT_IMAGE names the file that `microcontroller prepare` wrote");
    let image = PathBuf::from(image)
        .canonicalize()
        .expect("SINEW_ROBOT_IMAGE names a file that is there");
    println!("cargo:rerun-if-changed={}", image.display());
    println!("cargo:rustc-env=SINEW_ROBOT_IMAGE={}", image.display());
}
