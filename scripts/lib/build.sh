# shellcheck shell=bash
# How the scripts build Mariana. To be sourced after setup.sh.

# Makes a release build; $binary is the program then. Everything it says goes to stderr.
build_release() {
    # Where cargo puts things: a relative folder counts from the root, where cargo is started.
    local target=${CARGO_TARGET_DIR:-${CARGO_BUILD_TARGET_DIR:-target}} quiet=(--quiet)
    # shellcheck disable=SC2154 # setup.sh sets it.
    [[ $target == /* ]] || target=$root/$target
    binary=$target/release/mariana
    # On a terminal cargo's own progress tells that it takes long. Elsewhere one line has to.
    if [[ -t 2 ]]; then
        quiet=()
    elif [[ ! -x $binary ]]; then
        say "Building Mariana; the first time this takes a few minutes."
    fi
    (cd "$root" && cargo build --release ${quiet[@]+"${quiet[@]}"} --bin mariana) </dev/null >&2
}
