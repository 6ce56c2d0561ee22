# shellcheck shell=bash
# Builds Mariana for the other scripts. Source it after setup.sh.

# build_release PROFILE makes an optimized build and sets $binary to its path. All output goes to stderr.
build_release() {
    # Cargo's target folder. A relative path starts at the root, where cargo runs.
    local profile=$1 target=${CARGO_TARGET_DIR:-${CARGO_BUILD_TARGET_DIR:-target}} quiet=(--quiet)
    # shellcheck disable=SC2154 # Set by setup.sh.
    [[ $target == /* ]] || target=$root/$target
    binary=$target/$profile/mariana
    # A terminal shows cargo's progress. Elsewhere, print one line.
    if [[ -t 2 ]]; then
        quiet=()
    elif [[ ! -x $binary ]]; then
        say "Building Mariana. The first build takes a few minutes."
    fi
    if ! mkdir -p "$target" 2>/dev/null || [[ ! -w $target ]]; then
        fail "The folder $target cannot be written. Set CARGO_TARGET_DIR to a folder for the build, then run this again."
    fi
    # Separately, because a missing network and a failed build need different advice.
    (cd "$root" && cargo fetch --quiet --target "$(rustc -vV | sed -n 's/^host: //p')") </dev/null >&2 ||
        fail "Cargo could not get Mariana's libraries; its message is above. Check the network, or set HTTPS_PROXY if yours has a proxy, then run this again."
    (cd "$root" && cargo build --profile "$profile" ${quiet[@]+"${quiet[@]}"} --bin mariana) </dev/null >&2 ||
        fail "Mariana could not be built; the reason is above. If it stopped for want of memory or disk, free some, then run this again: the build continues."
}
