# shellcheck shell=bash
# Builds Mariana for the other scripts. Source it after setup.sh.

# Makes a release build and sets $binary to its path. All output goes to stderr.
build_release() {
    # Cargo's target folder. A relative path starts at the root, where cargo runs.
    local target=${CARGO_TARGET_DIR:-${CARGO_BUILD_TARGET_DIR:-target}} quiet=(--quiet)
    # shellcheck disable=SC2154 # Set by setup.sh.
    [[ $target == /* ]] || target=$root/$target
    binary=$target/release/mariana
    # A terminal shows cargo's progress. Elsewhere, print one line.
    if [[ -t 2 ]]; then
        quiet=()
    elif [[ ! -x $binary ]]; then
        say "Building Mariana. The first build takes a few minutes."
    fi
    (cd "$root" && cargo build --release ${quiet[@]+"${quiet[@]}"} --bin mariana) </dev/null >&2
}
