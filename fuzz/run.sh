#!/bin/sh
# Runs one fuzz target: ./run.sh TARGET [SECONDS]. Stable Rust, no cargo-fuzz needed:
# the coverage instrumentation is switched on by hand, without a sanitizer.
set -eu
cd "$(dirname "$0")"
target=$1
seconds=${2:-180}
flags="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
 -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1 --cfg fuzzing"
host=$(rustc -vV | sed -n 's/^host: //p')
features=
case $target in
    camera_frame) features="--features camera" ;;
    watch_*) features="--features watch" ;;
esac
# With an explicit target the flags stay away from build scripts.
RUSTC_BOOTSTRAP=1 RUSTFLAGS="$flags" cargo build --release --target "$host" --bin "$target" $features
mkdir -p "corpus/$target" "artifacts/$target"
exec "${CARGO_TARGET_DIR:-target}/$host/release/$target" "corpus/$target" seeds/"$target" \
    -artifact_prefix="artifacts/$target/" -max_total_time="$seconds" -rss_limit_mb=2048 \
    -timeout=10 -max_len=65536
