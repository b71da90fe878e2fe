//! Writes `include/sinew.h` from the Rust sources; with `--check` it only compares.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = here.join("../include/sinew.h");
    let written = match written_header(here) {
        Ok(written) => written,
        Err(error) => {
            eprintln!("bindings/c/header: {error}");
            return ExitCode::FAILURE;
        }
    };
    if std::fs::read_to_string(&header).is_ok_and(|committed| committed == written) {
        return ExitCode::SUCCESS;
    }
    if std::env::args().any(|argument| argument == "--check") {
        eprintln!("include/sinew.h does not match the sources; run bindings/c/header/write");
        return ExitCode::FAILURE;
    }
    match std::fs::write(&header, written) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", header.display());
            ExitCode::FAILURE
        }
    }
}

fn written_header(here: &Path) -> Result<String, String> {
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml"))?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for module in ["status", "robot", "offsets", "observer", "momentum"] {
        builder = builder.with_src(here.join("../src").join(module).with_extension("rs"));
    }
    let bindings = builder.generate().map_err(|error| error.to_string())?;
    let mut written = Vec::new();
    bindings.write(&mut written);
    let written = String::from_utf8(written).map_err(|error| error.to_string())?;
    // A heading of Rust's pages, worded for C.
    Ok(written.replace("// # Safety\n// ", "// Preconditions: "))
}
