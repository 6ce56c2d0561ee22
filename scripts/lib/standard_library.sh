# shellcheck shell=bash
# Rust's standard library for systems that this Rust has none for. Source it after setup.sh.

# The cache: the library's sources, and the results of the compiler.
# shellcheck disable=SC2154 # Set by setup.sh.
other_systems=${CARGO_TARGET_DIR:-$root/target}/other-systems
# Arguments for cargo that compile the library too; empty if this Rust has it.
# shellcheck disable=SC2034 # For the scripts that source this one.
standard_library=()

# Prints the folder with the sources of the standard library of this Rust.
standard_library_sources() {
    local version own unpacked
    version=$(rustc --version | awk '{ print $2 }')
    own=$(rustc --print sysroot)/lib/rustlib/src/rust/library
    unpacked=$other_systems/rust-src-$version
    if [[ -e $own/Cargo.lock ]]; then
        echo "$own"
        return
    fi
    if ! compgen -G "$unpacked/usr/src/rustc-*/library/Cargo.lock" >/dev/null; then
        say "Downloading the sources of Rust $version's standard library."
        unpack_package "$unpacked" "rust-src=$version" trixie-backports trixie sid </dev/null >&2 || return 1
        # The compiler's own sources are large and not needed.
        find "$unpacked"/usr/src/rustc-* -mindepth 1 -maxdepth 1 ! -name library -exec rm -rf {} +
    fi
    echo "$unpacked"/usr/src/rustc-*/library
}

# use_standard_library TARGET makes the library of TARGET available to cargo, with the arguments in standard_library.
use_standard_library() {
    local sources
    if have rustup && rustup target list --installed 2>/dev/null | grep -qx "$1"; then return; fi
    sources=$(standard_library_sources) || return 1
    # Cargo reads the second variable for its own tests. Without it, the whole toolchain would have to be copied.
    export RUSTC_BOOTSTRAP=1 __CARGO_TESTS_ONLY_SRC_ROOT=$sources
    standard_library=("-Zbuild-std=std,panic_abort")
}
