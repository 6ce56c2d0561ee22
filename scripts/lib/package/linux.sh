# shellcheck shell=bash disable=SC2154 # scripts/package and facts.sh set the variables.
# Archives and packages for Linux, all made of the files that scripts/install installs. Source it after facts.sh.

# Sets $glibc to the newest version of glibc that the program needs, and fails if it is newer than $newest_glibc.
find_glibc() {
    have objdump || fail "objdump is missing. Install binutils."
    glibc=$(objdump -T "$binary" | grep -o 'GLIBC_[0-9.]*' | cut -d _ -f 2 | sort -uV | tail -n 1) || true
    [[ -n $glibc ]] || fail "$binary is not linked to glibc. Build it for Linux with glibc."
    version_at_least "$newest_glibc" "$glibc" ||
        fail "$binary needs glibc $glibc, but downloads may need at most $newest_glibc. Build it on an older system, such as Debian 12."
}

# Installs into $stage once, and adds what every package has: compressed manual pages, the changelog and notices.
stage_files() {
    stage=$work/stage
    if [[ -d $stage ]]; then return; fi
    must_be "program for Linux" 7f454c46
    find_glibc
    find_page
    DESTDIR=$stage "$root/scripts/install" --prefix /usr --binary "$binary" --page "$page"
    # Package managers have their own lists of installed files.
    rm "$stage/usr/share/mariana/installed.txt"
    strip --strip-all "$stage/usr/bin/mariana" ||
        fail "strip cannot read $binary. Package a program on a computer of its own kind."
    gzip -9n "$stage"/usr/share/man/man1/*.1
    gzip -9nc "$root/CHANGELOG.md" >"$stage/usr/share/doc/mariana/changelog.gz"
    third_party_notices | gzip -9n >"$stage/usr/share/doc/mariana/third-party-notices.gz"
}

# Prints the package of a column in setup.sh's table for each library that the program loads while it runs.
loaded_libraries() {
    needs | awk -v column="$1" '$1 == "run" { print $column }' | LC_ALL=C sort -u
}

make_tar() {
    local name=mariana-$version-linux-$machine level=-9
    stage_files
    if [[ $fast == yes ]]; then level=-1; fi
    cp -a "$stage/usr" "$work/$name"
    tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -cf - "$name" |
        gzip -n "$level" >"$out/$name.tar.gz"
    rm -r "${work:?}/$name"
    printf '%s\n' "$out/$name.tar.gz"
}

# Prints the packages with the libraries that the program is linked to.
linked_packages() {
    local library
    objdump -p "$binary" | awk '$1 == "NEEDED" { print $2 }' | while read -r library; do
        case $library in
            libasound.so.2) echo "libasound2t64 | libasound2" ;;
            libgcc_s.so.1) echo libgcc-s1 ;;
            libc.so.6 | libm.so.6 | ld-linux-*) echo "libc6 (>= $glibc)" ;;
            *) fail "The program is linked to $library. Add its package to linked_packages in scripts/lib/package/linux.sh." ;;
        esac
    done | LC_ALL=C sort -u
}

# comma_separated: joins the lines of the input.
comma_separated() {
    awk 'NR > 1 { printf ", " } { printf "%s", $0 } END { print "" }'
}

make_deb() {
    local folder=$work/deb architecture=$machine size depends recommends compression=(-Zxz)
    have dpkg-deb || fail "dpkg-deb is missing. Install dpkg, or make the packages on Debian or Ubuntu."
    stage_files
    case $machine in
        x86_64) architecture=amd64 ;;
        aarch64) architecture=arm64 ;;
    esac
    if [[ $fast == yes ]]; then compression=(-Zgzip -z1); fi
    cp -a "$stage" "$folder"
    # Debian has its own file for licences, another folder for zsh, and a changelog of the package.
    local doc=$folder/usr/share/doc/mariana
    rm "$doc"/LICENSE-*
    fill debian/copyright >"$doc/copyright"
    fill debian/changelog DATE="$(date -u -R -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$doc/changelog.Debian.gz"
    mv "$folder/usr/share/zsh/site-functions" "$folder/usr/share/zsh/vendor-completions"
    mkdir -p "$folder/usr/share/lintian/overrides" "$folder/DEBIAN"
    fill debian/lintian-overrides >"$folder/usr/share/lintian/overrides/mariana"
    # The program cannot draw without libegl1. The other libraries are for X11 and for a renderer in software.
    depends=$({ linked_packages && echo libegl1; } | LC_ALL=C sort -u | comma_separated)
    recommends=$({ loaded_libraries 3 | grep -vx libegl1 && echo ffmpeg; } | comma_separated)
    size=$(du -k --apparent-size -s "$folder/usr" | cut -f 1)
    fill debian/control ARCHITECTURE="$architecture" SIZE="$size" DEPENDS="$depends" RECOMMENDS="$recommends" \
        DESCRIPTION="$(description | sed 's/^$/./; s/^/ /')" >"$folder/DEBIAN/control"
    (cd "$folder" && find usr -type f -print0 | LC_ALL=C sort -z | xargs -0 md5sum) >"$folder/DEBIAN/md5sums"
    dpkg-deb --root-owner-group "${compression[@]}" --build "$folder" "$out/mariana_${version}-1_$architecture.deb" >/dev/null
    printf '%s\n' "$out/mariana_${version}-1_$architecture.deb"
}

make_rpm() {
    local folder=$work/rpm payload=w6.xzdio recommends made
    have rpmbuild || fail "rpmbuild is missing. Install rpm (Debian) or rpm-build (Fedora)."
    # rpmbuild cuts its folder at a space, and deletes what it takes for its own.
    [[ $work != *[!A-Za-z0-9/._-]* ]] ||
        fail "rpmbuild cannot work in $work. Set TMPDIR to a folder whose path has only letters, digits and ._-."
    stage_files
    if [[ $fast == yes ]]; then payload=w1.gzdio; fi
    mkdir -p "$folder"
    # Names of libraries instead of packages, because those differ between distributions.
    recommends=$(needs | sed -n 's/^run *lib:\([^ ]*\) .*/Recommends: \1()(64bit)/p')
    {
        fill mariana.spec SUMMARY="${summary^}" STAGE="$stage" RECOMMENDS="$recommends" DESCRIPTION="$(description)"
        # Files of texts are marked as such by their folder.
        (cd "$stage" && find . -type f | sed 's|^\.||; s|^.*/LICENSE-.*|%license &|' | LC_ALL=C sort)
    } >"$folder/mariana.spec"
    rpmbuild -bb --quiet --target "$machine" --define "_topdir $folder" --define "_binary_payload $payload" \
        --define "_buildhost mariana" --define "use_source_date_epoch_as_buildtime 1" \
        --define "clamp_mtime_to_source_date_epoch 1" "$folder/mariana.spec" >"$folder/log" 2>&1 || {
        cat "$folder/log" >&2
        fail "rpmbuild failed. See its message above."
    }
    made=$(find "$folder/RPMS" -name '*.rpm')
    cp "$made" "$out"
    printf '%s\n' "$out/${made##*/}"
}
