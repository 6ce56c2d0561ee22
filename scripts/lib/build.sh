# shellcheck shell=bash
# Builds Mariana for the other scripts. Source it after setup.sh.

# Prints the absolute path of cargo's target folder.
cargo_target() {
    # A relative path starts at the root, where cargo runs.
    local target=${CARGO_TARGET_DIR:-${CARGO_BUILD_TARGET_DIR:-target}}
    # shellcheck disable=SC2154 # Set by setup.sh.
    [[ $target == /* ]] || target=$root/$target
    printf '%s\n' "$target"
}

# Clippy is a compiler, so one build checks the workspace's own code and makes its programs.
use_clippy() {
    RUSTC_WORKSPACE_WRAPPER=$(command -v clippy-driver)
    export RUSTC_WORKSPACE_WRAPPER CLIPPY_ARGS=-Dwarnings__CLIPPY_HACKERY__
}

# prepare_build PROGRAM MINUTES: if the folder for the build cannot be written, ends the script. If PROGRAM does not exist
# yet, prints the estimated duration of the first build. MINUTES is the duration with two processors.
prepare_build() {
    local target processors
    target=$(cargo_target)
    if ! mkdir -p "$target" 2>/dev/null || [[ ! -w $target ]]; then
        fail "The folder $target cannot be written. Set CARGO_TARGET_DIR to a folder for the build, then run this again."
    fi
    if [[ ! -x $1 ]]; then
        processors=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
        say "The first build takes about $(($2 * 2 / processors + 1)) minutes with $processors processors."
    fi
}

# Runs cargo in the root. A terminal shows cargo's own progress; elsewhere each tenth of a build gets a line.
cargo_with_progress() {
    if [[ -t 2 ]]; then
        (cd "$root" && cargo "$@") </dev/null
    else
        { (cd "$root" && CARGO_TERM_PROGRESS_WHEN=always CARGO_TERM_PROGRESS_WIDTH=80 cargo "$@") </dev/null 2>&1 >&3 |
            print_tenths >&2; } 3>&1
    fi
}

# Reads cargo's messages. Replaces its bar by a line for each tenth of the work, and leaves the lines about crates out.
print_tenths() {
    tr '\r' '\n' | awk '
        /^ *Building \[/ {
            split($0, bar, "] "); split(bar[2], count, "[/:]")
            tenth = int(10 * count[1] / count[2])
            if (tenth > last) { printf "%3d %%  %d of %d crates\n", 10 * tenth, count[1], count[2]; fflush(); last = tenth }
            next
        }
        /^ *(Building|Compiling|Downloading|Downloaded|Blocking|Executable|Fresh) / || /^ *$/ { next }
        { print; fflush() }'
}

# build_release PROFILE makes an optimized build and sets $binary to its path. All output goes to stderr.
build_release() {
    local profile=$1
    # shellcheck disable=SC2034 # For the scripts that source this one.
    binary=$(cargo_target)/$profile/mariana
    prepare_build "$binary" 7
    # Separately, because a missing network and a failed build need different advice.
    (cd "$root" && cargo fetch --quiet --target "$(rustc -vV | sed -n 's/^host: //p')") </dev/null >&2 ||
        fail "Cargo could not get Mariana's libraries; its message is above. Check the network, or set HTTPS_PROXY if yours has a proxy, then run this again."
    cargo_with_progress build --profile "$profile" --bin mariana >&2 ||
        fail "Mariana could not be built; the reason is above. If it stopped for want of memory or disk, free some, then run this again: the build continues."
}
