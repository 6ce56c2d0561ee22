# shellcheck shell=bash disable=SC2154 # scripts/package and facts.sh set the variables.
# Archives for Windows and macOS. Source it after facts.sh.

make_zip() {
    local name=mariana-$version-windows-x86_64 level=-9
    must_be "program for Windows" 4d5a
    if [[ $fast == yes ]]; then level=-1; fi
    find_page
    make_archive_folder "$name"
    cp "$binary" "$work/$name/mariana.exe"
    cp "$page" "$work/$name/page.html"
    rm -f "$out/$name.zip"
    if have zip; then
        (cd "$work" && zip -q -X -r "$level" "$out/$name.zip" "$name")
    elif have 7z; then
        (cd "$work" && 7z a -bso0 -tzip "$out/$name.zip" "$name")
    else
        fail "zip and 7z are missing. Install one of them."
    fi
    printf '%s\n' "$out/$name.zip"
}

# big_endian NUMBER prints the number as four bytes.
big_endian() {
    # shellcheck disable=SC2059 # The format is the escaped number.
    printf "$(printf '\\x%02x\\x%02x\\x%02x\\x%02x' $(($1 >> 24 & 255)) $(($1 >> 16 & 255)) $(($1 >> 8 & 255)) $(($1 & 255)))"
}

# Prints the icon in Apple's format: a header, and PNG files with their type and length.
# Types: https://en.wikipedia.org/wiki/Apple_Icon_Image_format. Two types of the same size are for displays of twice the
# resolution.
make_icns() {
    local row file length total=8 rows=(icp4:16 icp5:32 ic11:32 icp6:64 ic12:64 ic07:128 ic08:256 ic13:256 ic09:512 ic14:512)
    for row in "${rows[@]}"; do
        length=$(wc -c <"$(icon_file "${row#*:}")")
        total=$((total + length + 8))
    done
    printf icns && big_endian "$total"
    for row in "${rows[@]}"; do
        file=$(icon_file "${row#*:}")
        length=$(wc -c <"$file")
        printf '%s' "${row%:*}" && big_endian $((length + 8)) && cat "$file"
    done
}

icon_file() {
    printf '%s\n' "$root/assets/desktop/icons/$1x$1/apps/$id.png"
}

# fill_app FOLDER makes Mariana.app in FOLDER.
fill_app() {
    local contents=$1/Mariana.app/Contents
    must_be "program for macOS" cffaedfe cafebabe
    find_page
    rm -rf "$1/Mariana.app"
    mkdir -p "$contents/MacOS" "$contents/Resources"
    cp "$binary" "$contents/MacOS/mariana"
    chmod 755 "$contents/MacOS/mariana"
    cp "$page" "$contents/Resources/page.html"
    fill Info.plist >"$contents/Info.plist"
    printf 'APPL????' >"$contents/PkgInfo"
    make_icns >"$contents/Resources/mariana.icns"
    cp "$root/LICENSE-APACHE" "$root/LICENSE-MIT" "$contents/Resources"
    third_party_notices >"$contents/Resources/third-party-notices.txt"
}

make_app() {
    fill_app "$out"
    printf '%s\n' "$out/Mariana.app"
}

make_dmg() {
    local name=mariana-$version-macos-$machine.dmg
    have hdiutil || fail "hdiutil is missing: disk images can be made on macOS only. Make 'app' instead."
    mkdir -p "$work/dmg"
    fill_app "$work/dmg"
    cp "$root/CHANGELOG.md" "$work/dmg"
    ln -s /Applications "$work/dmg/Applications"
    # Apple's processors start only signed programs. This signature names nobody.
    codesign --force --sign - "$work/dmg/Mariana.app" >&2
    hdiutil create -quiet -ov -volname "Mariana $version" -fs HFS+ -format UDZO -srcfolder "$work/dmg" "$out/$name" >&2
    printf '%s\n' "$out/$name"
}
