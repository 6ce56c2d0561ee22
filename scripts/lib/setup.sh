# shellcheck shell=bash
# Installs the system packages and the Rust toolchain that Mariana needs. Source it. All output goes to stderr.
#
#   mariana_setup build [run] [package] [test] [targets] [page] [check-page]
#       installs missing packages of these groups; exits with 1 if it cannot
#
# MARIANA_SETUP=dry-run prints the packages without installing them, and exits; MARIANA_SETUP=skip checks nothing;
# MARIANA_SETUP=yes runs rustup's installer without a question.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)

# One requirement per row: its group, its check, and its package for each package manager (- if no package is needed).
#   cmd:NAME a command · header:NAME a C header · pc:NAME a pkg-config file · lib:NAME a shared library
#   dri:NAME a Mesa driver · libexec:NAME a helper program in libexec · browser:NAME a browser, by any command name
#   window-browser:NAME the same, with windows
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
run     lib:libwayland-egl.so.1   libwayland-egl1    libwayland-egl       wayland           libwayland-egl1      -
package cmd:objdump               binutils           binutils             binutils          binutils             -
package cmd:rpmbuild              rpm                rpm-build            rpm-tools         rpm-build            -
package cmd:zip                   zip                zip                  zip               zip                  -
test    cmd:dpkg-deb              dpkg               dpkg                 dpkg              dpkg                 dpkg
test    cmd:lintian               lintian            -                    -                 -                    -
test    cmd:ruby                  ruby               ruby                 ruby              ruby                 ruby
test    cmd:Xvfb                  xvfb               xorg-x11-server-Xvfb xorg-server-xvfb  xorg-x11-server-Xvfb -
test    cmd:xdotool               xdotool            xdotool              xdotool           xdotool              -
test    cmd:openbox               openbox            openbox              openbox           openbox              -
test    cmd:wmctrl                wmctrl             wmctrl               wmctrl            wmctrl               -
test    cmd:weston                weston             weston               weston            weston               -
test    cmd:sway                  sway               sway                 sway              sway                 -
test    cmd:swayidle              swayidle           swayidle             swayidle          swayidle             -
test    cmd:grim                  grim               grim                 grim              grim                 -
test    cmd:xwd                   x11-apps           xwd                  xorg-xwd          xwd                  -
test    cmd:import                imagemagick        ImageMagick          imagemagick       ImageMagick          imagemagick
test    cmd:pulseaudio            pulseaudio         pulseaudio           pulseaudio        pulseaudio           -
test    cmd:parec                 pulseaudio-utils   pulseaudio-utils     libpulse          pulseaudio-utils     -
test    cmd:dbus-daemon           dbus               dbus-daemon          dbus              dbus-1               dbus
test    cmd:dbus-send             dbus               dbus-tools           dbus              dbus-1               dbus
test    libexec:at-spi-bus-launcher at-spi2-core    at-spi2-core         at-spi2-core      at-spi2-core         -
test    cmd:ffmpeg                ffmpeg             ffmpeg-free          ffmpeg            ffmpeg               ffmpeg
test    cmd:parallel              parallel           parallel             parallel          gnu_parallel         parallel
test    cmd:desktop-file-validate desktop-file-utils desktop-file-utils   desktop-file-utils desktop-file-utils  desktop-file-utils
test    cmd:appstreamcli          appstream          appstream            appstream         AppStream            appstream
test    cmd:update-mime-database  shared-mime-info   shared-mime-info     shared-mime-info  shared-mime-info     shared-mime-info
test    browser:chromium          chromium-headless-shell chromium        chromium          chromium             chromium
test    cmd:zbarimg               zbar-tools         zbar                 zbar              zbar                 zbar
test    cmd:glslangValidator      glslang-tools      glslang              glslang           glslang-devel        glslang
targets cmd:x86_64-w64-mingw32-dlltool binutils-mingw-w64-x86-64 mingw64-binutils mingw-w64-binutils - mingw-w64
page    cmd:node                  nodejs             nodejs               nodejs            nodejs               node
check-page window-browser:chromium chromium          chromium             chromium          chromium             chromium
check-page cmd:xvfb-run           xvfb               xorg-x11-server-Xvfb xorg-server-xvfb  xorg-x11-server-Xvfb -
check-page cmd:xauth              xauth              xorg-x11-xauth       xorg-xauth        xauth                -
TABLE
}
# ALSA's development package includes its run-time library. Opus is linked statically and built with cmake.

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

# Succeeds if a requirement is met, even if the package manager did not install it.
is_met() {
    local name=${1#*:}
    case $1 in
        cmd:*) have "$name" ;;
        window-browser:*) have "$name" || have "$name-browser" || have google-chrome ;;
        browser:*) have "$name-headless-shell" || have "$name" || have "$name-browser" || have google-chrome ;;
        header:*) [[ -e /usr/include/$name ]] ;;
        pc:*) have pkg-config && pkg-config --exists "$name" ;;
        libexec:*) [[ -x /usr/libexec/$name || -x /usr/lib/$name || -x /usr/lib/at-spi2-core/$name ]] ;;
        lib:*) [[ $shared_libraries == *"$name"* ]] ;;
        dri:*) compgen -G "/usr/lib*/dri/${name}_dri.so" >/dev/null || compgen -G "/usr/lib/*/dri/${name}_dri.so" >/dev/null ;;
    esac
}

# Succeeds if the package manager has the package installed. Used when is_met finds nothing.
is_installed() {
    case $1 in
        apt) [[ $(dpkg-query -W -f='${db:Status-Status}' "$2" 2>/dev/null) == installed ]] ;;
        dnf | zypper) rpm -q --whatprovides "$2" ;;
        pacman) pacman -Qq "$2" ;;
        brew) brew list --versions "$2" ;;
    esac >/dev/null 2>&1
}

# Prints the package manager's install command. It never removes packages.
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
    if [[ $manager == none ]]; then
        fail "Mariana needs the packages $*. Install them, then run this again."
    elif [[ $manager == brew ]]; then
        have brew || fail "Mariana needs the packages $*. Install Homebrew or these packages, then run this again."
    elif [[ $EUID -ne 0 ]]; then
        have sudo || fail "Mariana needs the packages $*. Ask an administrator to install them, then run this again."
        as_root=(sudo)
        # sudo clears the variables that name a proxy.
        if [[ -n ${http_proxy:-}${https_proxy:-}${HTTP_PROXY:-}${HTTPS_PROXY:-} ]]; then
            as_root+=("--preserve-env=http_proxy,https_proxy,HTTP_PROXY,HTTPS_PROXY,no_proxy,NO_PROXY")
        fi
    fi
    say "Installing with $manager${as_root[*]+ and sudo}: $*"
    case $manager in
        apt) renew=(apt-get -qq -o DPkg::Lock::Timeout=300 update) ;;
        pacman) compgen -G "/var/lib/pacman/sync/*.db" >/dev/null || renew=(pacman -Sy) ;;
    esac
    if [[ ${#renew[@]} -gt 0 ]]; then
        ${as_root[@]+"${as_root[@]}"} "${renew[@]}" </dev/null >&2 ||
            say "Cannot update the package lists; using the current ones."
    fi
    ${as_root[@]+"${as_root[@]}"} "${command[@]}" "$@" </dev/null >&2 ||
        fail "$manager could not install these packages: $*. See its message above, or install them yourself and set MARIANA_SETUP=skip."
}

install_packages() {
    local manager=$1 group check apt dnf pacman zypper brew package missing=() unmet=()
    local groups=" ${*:2} " shared_libraries=""
    # On Windows no package manager can be assumed. A build needs cmake and a C compiler there.
    case $(uname -s) in MINGW* | MSYS*) return ;; esac
    if [[ $(uname -s) == Linux ]]; then
        shared_libraries=$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null) || true
    fi
    # Each column has its manager's name, so ${!manager} is the package.
    # shellcheck disable=SC2034
    while read -r group check apt dnf pacman zypper brew; do
        [[ $groups == *" $group "* ]] || continue
        package=${!manager-}
        if [[ $package == - ]] || is_met "$check"; then continue; fi
        unmet+=("${check#*:}")
        [[ " ${missing[*]-} " == *" $package "* ]] || is_installed "$manager" "$package" || missing+=("$package")
    done < <(needs)
    if [[ $manager == none && ${#unmet[@]} -gt 0 ]]; then
        fail "Mariana needs ${unmet[*]}, but this script found no package manager that it supports (apt, dnf, pacman, zypper, brew). Install them yourself, or set MARIANA_SETUP=skip if they are installed where this script does not look."
    fi
    if [[ ${#missing[@]} -gt 0 ]]; then install_with "$manager" "${missing[@]}"; fi
}

# version_at_least FOUND WANTED compares dotted numbers: 1.100 is greater than 1.95.
version_at_least() {
    local found wanted i
    IFS=. read -ra found <<<"${1%%[!0-9.]*}"
    IFS=. read -ra wanted <<<"$2"
    for ((i = 0; i < ${#wanted[@]}; i++)); do
        ((10#${found[i]:-0} == 10#${wanted[i]})) || return $((10#${found[i]:-0} < 10#${wanted[i]}))
    done
}

# Prints the packages of the Rust toolchain. The first one has Rust's version.
rust_packages() {
    case $1 in
        apt) echo rustc cargo rustfmt rust-clippy ;;
        dnf) echo rust cargo rustfmt clippy ;;
        pacman | brew) echo rust ;;
        zypper) echo rust cargo ;;
    esac
}

# offered_version MANAGER PACKAGE prints the package manager's version of a package, if it has one.
offered_version() {
    case $1 in
        apt) apt-cache policy "$2" | awk '$1 == "Candidate:" && $2 != "(none)" { print $2 }' ;;
        dnf) dnf -q repoquery --latest-limit=1 --qf '%{version}\n' "$2" ;;
        pacman) pacman -Si "$2" | awk '$1 == "Version" { sub(/^[0-9]+:/, "", $3); print $3 }' ;;
        zypper) zypper --non-interactive info "$2" | awk '$1 == "Version" { print $3 }' ;;
        brew) brew info --formula "$2" | awk 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^[0-9]+\./) { print $i; exit } }' ;;
    esac 2>/dev/null
}

# Asks on the terminal, because the scripts do not read standard input. Succeeds after a yes.
confirm() {
    local answer
    { printf '%s [y/N] ' "$1" >/dev/tty && read -r answer </dev/tty; } 2>/dev/null && [[ $answer == [yY]* ]]
}

# announce INSTALLER THING: fails in a dry run.
announce() {
    if [[ ${MARIANA_SETUP:-} == dry-run ]]; then
        say "Would install with $1: $2"
        return 1
    fi
    say "Installing with $1: $2"
}

# install_rustup MANAGER installs rustup for this user, without a toolchain. It does not change the PATH.
install_rustup() {
    local installer=https://sh.rustup.rs script="" command=(sh -s --)
    if have rustup-init; then installer=rustup-init command=(rustup-init); fi
    announce "$installer" rustup || return 0
    if [[ $installer != rustup-init ]]; then
        have curl || install_with "$1" ca-certificates curl
        script=$(curl --proto '=https' --tlsv1.2 -sSf --retry 3 "$installer" </dev/null) ||
            fail "Cannot download $installer. Check the network, or set HTTPS_PROXY if yours has a proxy, then run this again."
    fi
    "${command[@]}" -y --quiet --profile minimal --default-toolchain none --no-modify-path <<<"$script" >&2 ||
        fail "$installer could not install rustup; the reason is above. Check the network and the space in your home folder, then run this again."
}

# install_toolchain TOOLCHAIN installs or updates it with rustup. The tests need rustfmt and clippy.
install_toolchain() {
    announce rustup "Rust $1" || return 0
    rustup toolchain install "$1" --profile minimal --component rustfmt --component clippy --no-self-update </dev/null >&2 ||
        fail "rustup could not install Rust $1; the reason is above. Check the network, or set HTTPS_PROXY if yours has a proxy, then run this again."
}

# use_rustup MANAGER OLDEST [PRESENT] selects rustup's stable Rust for this run, and installs what is missing. OLDEST is
# the oldest Rust that works; PRESENT is older.
use_rustup() {
    local manager=$1 oldest=$2 present=${3:-} stable
    local problem="Mariana needs Rust $oldest or newer, but this computer has ${present:-none}."
    if ! have rustup; then
        # The packages of rustup and of Rust conflict.
        if [[ -z $present && -n $(offered_version "$manager" rustup) ]]; then
            install_with "$manager" rustup ca-certificates
            # Fedora's package has only rustup's installer.
            if have rustup-init && ! have rustup; then install_rustup "$manager"; fi
        elif [[ ${MARIANA_SETUP:-} == yes || ${MARIANA_SETUP:-} == dry-run ]] ||
            confirm "$problem Download and run https://sh.rustup.rs? It installs rustup and Rust stable into ~/.cargo and ~/.rustup, and changes no other file."; then
            install_rustup "$manager"
        else
            fail "$problem Run scripts/run or scripts/test with --yes to install it with https://sh.rustup.rs, or install it yourself from https://rustup.rs."
        fi
    fi
    stable=$(rustup run stable cargo --version 2>/dev/null | awk '{ print $2 }') || stable=""
    version_at_least "${stable:-0}" "$oldest" || install_toolchain stable
    if [[ ${MARIANA_SETUP:-} == dry-run ]]; then return; fi
    # The programs of an older Rust may be on the PATH too.
    stable=$(rustup run stable rustc --print sysroot)
    PATH=$(cd "$stable/bin" && pwd):$PATH
    export RUSTUP_TOOLCHAIN=stable
}

# ensure_rust MANAGER GROUP...: installs or requires the Rust version in Cargo.toml, for tests with rustfmt and clippy.
ensure_rust() {
    local manager=$1 wanted found offered="" packages
    wanted=$(sed -n 's/^rust-version *= *"\([0-9.]*\)".*/\1/p' "$root/Cargo.toml")
    # The PATH may lack the folder of rustup.
    PATH=$PATH:${CARGO_HOME:-${HOME:-}/.cargo}/bin
    found=$(cd "$root" && RUSTUP_AUTO_INSTALL=0 cargo --version 2>/dev/null | awk '{ print $2 }') || found=""
    if ! version_at_least "${found:-0}" "$wanted"; then
        read -ra packages <<<"$(rust_packages "$manager")"
        if [[ -z $found ]] && ! have rustup; then
            offered=$(offered_version "$manager" "${packages[0]-}") || offered=""
        fi
        if version_at_least "${offered:-0}" "$wanted"; then
            install_with "$manager" "${packages[@]}"
        else
            use_rustup "$manager" "$wanted" "$found"
        fi
    fi
    if [[ " $* " == *" test "* && ${MARIANA_SETUP:-} != dry-run ]]; then
        (cd "$root" && cargo fmt --version && cargo clippy --version) >/dev/null 2>&1 ||
            (have rustup && cd "$root" && rustup component add rustfmt clippy) >&2 ||
            fail "The tests need rustfmt and clippy. Install them with rustup or your system's package manager, then run this again."
    fi
}

# unpack_package FOLDER PACKAGE[=VERSION] SUITE... downloads a package from suites of Debian and unpacks it into FOLDER.
# VERSION is the beginning of the wanted one. The system's package lists stay unchanged.
unpack_package() {
    local folder=$1 name=${2%%=*} version=${2#"${2%%=*}"} suite options uri found
    have apt-get && have dpkg || return 1
    uri=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' | head -n 1)
    [[ -n $uri ]] || return 1
    rm -rf "$folder" && mkdir -p "$folder"/apt/{lists,cache/archives}/partial || return 1
    for suite in "${@:3}"; do
        echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $uri $suite main"
    done >"$folder/apt/sources.list"
    options=(-qq -o APT::Sandbox::User=root -o Dir::Etc::SourceList="$folder/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
        -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache")
    apt-get "${options[@]}" update || return 1
    found=$(apt-cache "${options[@]}" madison "$name" | awk -v wanted="${version#=}" 'index($3, wanted) == 1 { print $3; exit }')
    [[ -n $found ]] || return 1
    (cd "$folder" && apt-get "${options[@]}" download "$name=$found") && dpkg -x "$folder/${name}"_*.deb "$folder" &&
        rm -rf "$folder/apt" "$folder/${name}"_*.deb
}

# Gets mesa-drm-shim, which lets Mesa compile for GPUs that are not installed (`cargo xtask gpu`). Without it, the tests
# print a note and compare nothing.
get_gpu_shim() {
    local codename
    if [[ $1 != apt || $(uname -m) != x86_64 || ${MARIANA_SETUP:-} == dry-run ]] || is_installed apt mesa-drm-shim ||
        compgen -G "$root/target/mesa-drm-shim/usr/lib/*/libamdgpu_noop_drm_shim.so" >/dev/null; then
        return
    fi
    if apt-cache show mesa-drm-shim >/dev/null 2>&1; then
        install_with apt mesa-drm-shim
    else
        codename=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
        unpack_package "$root/target/mesa-drm-shim" mesa-drm-shim "$codename-backports" </dev/null >&2 ||
            say "mesa-drm-shim is not available: GPU programs are not compared."
    fi
}

mariana_setup() {
    local manager
    case ${MARIANA_SETUP:-} in
        "" | dry-run | yes) ;;
        skip) return ;;
        *) fail "MARIANA_SETUP is '$MARIANA_SETUP'. Use dry-run, skip or yes, or unset it." ;;
    esac
    manager=$(package_manager)
    install_packages "$manager" "$@"
    ensure_rust "$manager" "$@"
    if [[ " $* " == *" test "* ]]; then get_gpu_shim "$manager"; fi
    if [[ ${MARIANA_SETUP:-} == dry-run ]]; then
        say "Dry run: nothing was installed."
        exit 0
    fi
}
