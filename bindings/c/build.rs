//! The name under which programs look for the shared object: the version of the interface is part of it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/status.rs");
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    let status = std::fs::read_to_string("src/status.rs").unwrap_or_default();
    let version = status
        .lines()
        .find_map(|line| line.strip_prefix("pub const SINEW_ABI_VERSION: u32 = "))
        .map(|rest| rest.trim_end_matches(';'));
    match (system.as_str(), version) {
        ("linux", Some(version)) => {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libsinew.so.{version}");
        }
        ("macos", Some(version)) => {
            println!(
                "cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libsinew.{version}.dylib"
            );
        }
        _ => {}
    }
}
