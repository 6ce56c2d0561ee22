# shellcheck shell=bash
# What Mariana needs from the system, and how to get it. To be sourced; everything it says goes to stderr.
#
#   mariana_setup build run [test]    makes sure that these groups of needs are met, or ends the script with 1
#
# MARIANA_SETUP=dry-run says what would be installed and ends the script; MARIANA_SETUP=skip looks for nothing.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)

# One row per need: group, how to see that it is met, and the package of each manager (- where there is none to install).
#   cmd:NAME a command · header:NAME a C header · pc:NAME a pkg-config file · lib:NAME a shared library · dri:NAME a Mesa driver
#   libexec:NAME a program that only other programs start · browser:NAME a browser under any of its commands' names
needs() {
    cat <<'TABLE'
# group check                     apt                dnf                  pacman            zypper               brew
build   cmd:cc                    gcc                gcc                  gcc               gcc                  -
build   header:stdio.h            libc6-dev          glibc-devel          glibc             glibc-devel          -
build   cmd:make                  make               make                 make              make                 -
build   cmd:cmake                 cmake              cmake                cmake             cmake                cmake
build   cmd:pkg-config            pkg-config         pkgconf-pkg-config   pkgconf           pkgconf-pkg-config   pkgconf
build   pc:alsa                   libasound2-dev     alsa-lib-devel       alsa-lib          alsa-devel           -
run     lib:libEGL.so.1           libegl1            libglvnd-egl         libglvnd          Mesa-libEGL1         -
run     lib:libGL.so.1            libgl1             libglvnd-glx         libglvnd          Mesa-libGL1          -
run     dri:swrast                libgl1-mesa-dri    mesa-dri-drivers     mesa              Mesa-dri             -
run     lib:libX11.so.6           libx11-6           libX11               libx11            libX11-6             -
run     lib:libX11-xcb.so.1       libx11-xcb1        libX11-xcb           libx11            libX11-xcb1          -
run     lib:libXcursor.so.1       libxcursor1        libXcursor           libxcursor        libXcursor1          -
run     lib:libXi.so.6            libxi6             libXi                libxi             libXi6               -
run     lib:libxkbcommon-x11.so.0 libxkbcommon-x11-0 libxkbcommon-x11     libxkbcommon-x11  libxkbcommon-x11-0   -
test    cmd:Xvfb                  xvfb               xorg-x11-server-Xvfb xorg-server-xvfb  xorg-x11-server-Xvfb -
test    cmd:xdotool               xdotool            xdotool              xdotool           xdotool              -
test    cmd:openbox               openbox            openbox              openbox           openbox              -
test    cmd:wmctrl                wmctrl             wmctrl               wmctrl            wmctrl               -
test    cmd:weston                weston             weston               weston            weston               -
test    cmd:sway                  sway               sway                 sway              sway                 -
test    cmd:grim                  grim               grim                 grim              grim                 -
test    cmd:xwd                   x11-apps           xwd                  xorg-xwd          xwd                  -
test    cmd:import                imagemagick        ImageMagick          imagemagick       ImageMagick          imagemagick
test    cmd:pulseaudio            pulseaudio         pulseaudio           pulseaudio        pulseaudio           -
test    cmd:parec                 pulseaudio-utils   pulseaudio-utils     libpulse          pulseaudio-utils     -
test    cmd:dbus-daemon           dbus               dbus-daemon          dbus              dbus-1               dbus
test    cmd:dbus-send             dbus               dbus-tools           dbus              dbus-1               dbus
test    libexec:at-spi-bus-launcher at-spi2-core    at-spi2-core         at-spi2-core      at-spi2-core         -
test    cmd:ffmpeg                ffmpeg             ffmpeg-free          ffmpeg            ffmpeg               ffmpeg
test    cmd:desktop-file-validate desktop-file-utils desktop-file-utils   desktop-file-utils desktop-file-utils  desktop-file-utils
test    cmd:appstreamcli          appstream          appstream            appstream         AppStream            appstream
test    cmd:update-mime-database  shared-mime-info   shared-mime-info     shared-mime-info  shared-mime-info     shared-mime-info
test    browser:chromium          chromium-headless-shell chromium        chromium          chromium             chromium
test    cmd:zbarimg               zbar-tools         zbar                 zbar              zbar                 zbar
test    cmd:glslangValidator      glslang-tools      glslang              glslang           glslang-devel        glslang
TABLE
}
# The run-time library of ALSA comes with its development package; Opus is built into the program (by cmake).

say() { printf '%s\n' "$*" >&2; }
fail() {
    say "$*"
    exit 1
}
have() { command -v "$1" >/dev/null 2>&1; }

package_manager() {
    local name
    if [[ $(uname -s) == Darwin ]]; then
        echo brew
        return
    fi
    for name in apt:apt-get dnf pacman zypper; do
        if have "${name#*:}"; then
            echo "${name%:*}"
            return
        fi
    done
    echo none
}

# Whether a need is met, told from what is there, whoever put it there.
is_met() {
    local name=${1#*:}
    case $1 in
        cmd:*) have "$name" ;;
        browser:*) have "$name-headless-shell" || have "$name" || have "$name-browser" || have google-chrome ;;
        header:*) [[ -e /usr/include/$name ]] ;;
        pc:*) have pkg-config && pkg-config --exists "$name" ;;
        libexec:*) [[ -x /usr/libexec/$name || -x /usr/lib/$name || -x /usr/lib/at-spi2-core/$name ]] ;;
        lib:*) [[ $shared_libraries == *"$name"* ]] ;;
        dri:*) compgen -G "/usr/lib*/dri/${name}_dri.so" >/dev/null || compgen -G "/usr/lib/*/dri/${name}_dri.so" >/dev/null ;;
    esac
}

# Whether the package manager has the package already: the last word on what is_met could not find.
is_installed() {
    case $1 in
        apt) [[ $(dpkg-query -W -f='${db:Status-Status}' "$2" 2>/dev/null) == installed ]] ;;
        dnf | zypper) rpm -q --whatprovides "$2" ;;
        pacman) pacman -Qq "$2" ;;
        brew) brew list --versions "$2" ;;
    esac >/dev/null 2>&1
}

# The command that installs the packages; nothing that is there is ever removed for it.
install_command() {
    case $1 in
        apt) echo "env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 install -y --no-install-recommends --no-remove" ;;
        dnf) echo "dnf install -y --setopt=install_weak_deps=False" ;;
        pacman) echo "pacman -S --needed --noconfirm" ;;
        zypper) echo "zypper --non-interactive install --no-recommends" ;;
        brew) echo "brew install" ;;
    esac
}

# install_with MANAGER PACKAGE...
install_with() {
    local manager=$1 command as_root=() renew=()
    shift
    read -ra command <<<"$(install_command "$manager")"
    if [[ ${MARIANA_SETUP:-} == dry-run ]]; then
        say "Would install with $manager: $*"
        return
    fi
    if [[ $manager == brew ]]; then
        have brew || fail "Mariana needs the packages $*: install Homebrew, or install them by other means, then start this again."
    elif [[ $EUID -ne 0 ]]; then
        have sudo || fail "Mariana needs the packages $*: ask someone with administrator rights to install them, then start this again."
        as_root=(sudo)
    fi
    say "Installing with $manager${as_root[*]+ and sudo}: $*"
    case $manager in
        apt) renew=(apt-get -qq -o DPkg::Lock::Timeout=300 update) ;;
        pacman) compgen -G "/var/lib/pacman/sync/*.db" >/dev/null || renew=(pacman -Sy) ;;
    esac
    if [[ ${#renew[@]} -gt 0 ]]; then
        ${as_root[@]+"${as_root[@]}"} "${renew[@]}" </dev/null >&2 ||
            say "The package lists could not be updated; trying with the present ones."
    fi
    ${as_root[@]+"${as_root[@]}"} "${command[@]}" "$@" </dev/null >&2 ||
        fail "$manager could not install these packages: $*. See its message above, or install them by hand and set MARIANA_SETUP=skip."
}

install_packages() {
    local manager=$1 group check apt dnf pacman zypper brew package missing=() unmet=()
    local groups=" ${*:2} " shared_libraries=""
    if [[ $(uname -s) == Linux ]]; then
        shared_libraries=$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null) || true
    fi
    # The columns bear the managers' names, by which ${!manager} picks one.
    # shellcheck disable=SC2034
    while read -r group check apt dnf pacman zypper brew; do
        [[ $groups == *" $group "* ]] || continue
        package=${!manager-}
        if [[ $package == - ]] || is_met "$check"; then continue; fi
        unmet+=("${check#*:}")
        [[ " ${missing[*]-} " == *" $package "* ]] || is_installed "$manager" "$package" || missing+=("$package")
    done < <(needs)
    if [[ $manager == none && ${#unmet[@]} -gt 0 ]]; then
        fail "Mariana needs ${unmet[*]}, and there is no package manager that this script knows (apt, dnf, pacman, zypper, brew): install them, or set MARIANA_SETUP=skip if they are somewhere this script does not look."
    fi
    if [[ ${#missing[@]} -gt 0 ]]; then install_with "$manager" "${missing[@]}"; fi
}

# version_at_least FOUND WANTED, of dotted numbers: 1.100 is more than 1.95.
version_at_least() {
    local found wanted i
    IFS=. read -ra found <<<"${1%%[!0-9.]*}"
    IFS=. read -ra wanted <<<"$2"
    for ((i = 0; i < ${#wanted[@]}; i++)); do
        ((10#${found[i]:-0} == 10#${wanted[i]})) || return $((10#${found[i]:-0} < 10#${wanted[i]}))
    done
}

# The packages of a whole Rust toolchain; the first one's version is Rust's.
rust_packages() {
    case $1 in
        apt) echo rustc cargo rustfmt rust-clippy ;;
        dnf) echo rust cargo rustfmt clippy ;;
        pacman | brew) echo rust ;;
        zypper) echo rust cargo ;;
    esac
}

# The version of Rust that the package manager offers; empty where it has none.
offered_rust() {
    case $1 in
        apt) apt-cache policy rustc | awk '$1 == "Candidate:" { print $2 }' ;;
        dnf) dnf -q repoquery --latest-limit=1 --qf '%{version}\n' rust ;;
        pacman) pacman -Si rust | awk '$1 == "Version" { sub(/^[0-9]+:/, "", $3); print $3 }' ;;
        zypper) zypper --non-interactive info rust | awk '$1 == "Version" { print $3 }' ;;
        brew) brew info --formula rust | awk 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^[0-9]+\./) { print $i; exit } }' ;;
    esac 2>/dev/null
}

# ensure_rust MANAGER GROUP...: cargo of the age that Cargo.toml asks for, for tests with rustfmt and clippy.
ensure_rust() {
    local manager=$1 wanted found offered packages
    wanted=$(sed -n 's/^rust-version *= *"\([0-9.]*\)".*/\1/p' "$root/Cargo.toml")
    if ! have cargo && [[ -x ${CARGO_HOME:-${HOME:-}/.cargo}/bin/cargo ]]; then
        PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
    fi
    found=$(cd "$root" && cargo --version 2>/dev/null | awk '{ print $2 }') || found=""
    if ! version_at_least "${found:-0}" "$wanted"; then
        if have rustup; then
            fail "Mariana needs Rust $wanted or newer, but rustup has ${found:-none selected}: run 'rustup default stable && rustup update stable', then start this again."
        fi
        offered=$(offered_rust "$manager") || offered=""
        if [[ -n $found ]] || ! version_at_least "${offered:-0}" "$wanted"; then
            fail "Mariana needs Rust $wanted or newer, but this computer has ${found:-none}: install it with rustup, the Rust project's installer, then start this again."
        fi
        read -ra packages <<<"$(rust_packages "$manager")"
        install_with "$manager" "${packages[@]}"
    fi
    if [[ " $* " == *" test "* && ${MARIANA_SETUP:-} != dry-run ]]; then
        (cd "$root" && cargo fmt --version && cargo clippy --version) >/dev/null 2>&1 ||
            fail "The tests need rustfmt and clippy: run 'rustup component add rustfmt clippy', or install your system's packages of the same names, then start this again."
    fi
}

# Unpacks mesa-drm-shim from the backports of this Debian into target/, without touching the system's lists.
unpack_gpu_shim() {
    local folder=$root/target/mesa-drm-shim options codename uri
    codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
    uri=$(apt-get indextargets --format '$(REPO_URI)' "Codename: $codename" 'Created-By: Packages' | head -n 1)
    [[ -n $codename && -n $uri ]] || return 1
    rm -rf "$folder" && mkdir -p "$folder"/{lists,cache/archives}/partial || return 1
    echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $uri $codename-backports main" >"$folder/sources.list"
    options=(-qq -o APT::Sandbox::User=root -o Dir::Etc::SourceList="$folder/sources.list" -o Dir::Etc::SourceParts=/dev/null
        -o Dir::State::Lists="$folder/lists" -o Dir::Cache="$folder/cache")
    apt-get "${options[@]}" update && (cd "$folder" && apt-get "${options[@]}" download mesa-drm-shim) &&
        dpkg -x "$folder"/mesa-drm-shim_*.deb "$folder"
}

# What lets Mesa compile for GPUs that are not there, for `cargo xtask gpu`. Where it cannot be had, the tests say so and
# compare nothing.
get_gpu_shim() {
    if [[ $1 != apt || $(uname -m) != x86_64 || ${MARIANA_SETUP:-} == dry-run ]] || is_installed apt mesa-drm-shim ||
        compgen -G "$root/target/mesa-drm-shim/usr/lib/*/libamdgpu_noop_drm_shim.so" >/dev/null; then
        return
    fi
    if apt-cache show mesa-drm-shim >/dev/null 2>&1; then
        install_with apt mesa-drm-shim
    else
        unpack_gpu_shim </dev/null >&2 || say "mesa-drm-shim cannot be had: programs for GPUs are not compared."
    fi
}

mariana_setup() {
    local manager
    case ${MARIANA_SETUP:-} in
        "" | dry-run) ;;
        skip) return ;;
        *) fail "MARIANA_SETUP is '$MARIANA_SETUP': use dry-run or skip, or leave it unset." ;;
    esac
    manager=$(package_manager)
    install_packages "$manager" "$@"
    ensure_rust "$manager" "$@"
    if [[ " $* " == *" test "* ]]; then get_gpu_shim "$manager"; fi
    if [[ ${MARIANA_SETUP:-} == dry-run ]]; then
        say "That is all: nothing was installed."
        exit 0
    fi
}
