# shellcheck shell=bash
# Builds Mariana for the other scripts. Source it after setup.sh.

# build_release [PROFILE] makes an optimized build, by default with the profile release, and sets $binary to its path.
# All output goes to stderr.
build_release() {
    # Cargo's target folder. A relative path starts at the root, where cargo runs.
    local profile=${1:-release} target=${CARGO_TARGET_DIR:-${CARGO_BUILD_TARGET_DIR:-target}} quiet=(--quiet)
    # shellcheck disable=SC2154 # Set by setup.sh.
    [[ $target == /* ]] || target=$root/$target
    binary=$target/$profile/mariana
    # A terminal shows cargo's progress. Elsewhere, print one line.
    if [[ -t 2 ]]; then
        quiet=()
    elif [[ ! -x $binary ]]; then
        say "Building Mariana. The first build takes a few minutes."
    fi
    (cd "$root" && cargo build --profile "$profile" ${quiet[@]+"${quiet[@]}"} --bin mariana) </dev/null >&2
}
