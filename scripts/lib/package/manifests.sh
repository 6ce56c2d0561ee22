# shellcheck shell=bash disable=SC2154 # scripts/package and facts.sh set the variables.
# Files for Flatpak, winget and Homebrew, filled with the checksums in SHA256SUMS. Source it after facts.sh.

# checksum FILE prints the checksum of a download.
checksum() {
    local sum
    sum=$(awk -v file="$1" '$2 == file { print $1 }' "$out/SHA256SUMS" 2>/dev/null) || sum=""
    [[ -n $sum ]] || fail "$out/SHA256SUMS has no $1. Put all downloads there, and run 'scripts/package sums'."
    printf '%s\n' "$sum"
}

# Prints the crates of Cargo.lock as sources of a Flatpak, which builds without a network.
flatpak_sources() {
    awk '
        function value() { gsub(/^[a-z]+ = "|"$/, ""); return $0 }
        /^name = / { name = value() }
        /^version = / { version = value() }
        /^checksum = / {
            sum = value(); crate = name "-" version
            printf "%s  {\"type\": \"archive\", \"archive-type\": \"tar-gzip\", \"url\": \"https://static.crates.io/crates/%s/%s.crate\", \"sha256\": \"%s\", \"dest\": \"cargo/vendor/%s\"},\n", between, name, crate, sum, crate
            printf "  {\"type\": \"inline\", \"contents\": \"{\\\"package\\\": \\\"%s\\\", \\\"files\\\": {}}\", \"dest\": \"cargo/vendor/%s\", \"dest-filename\": \".cargo-checksum.json\"}", sum, crate
            between = ",\n"
        }
        BEGIN { print "[" }
        END {
            print between "  {\"type\": \"inline\", \"contents\": \"[source.vendored-sources]\\ndirectory = \\\"cargo/vendor\\\"\\n\\n[source.crates-io]\\nreplace-with = \\\"vendored-sources\\\"\\n\", \"dest\": \"cargo\", \"dest-filename\": \"config.toml\"}"
            print "]"
        }' "$root/Cargo.lock"
}

make_manifests() {
    local folder=$work/manifests name=mariana-$version-manifests downloads=$repository/releases/download/v$version
    local source=mariana-$version-source.tar.gz zip=mariana-$version-windows-x86_64.zip dmg=mariana-$version-macos-aarch64.dmg
    local template to
    local winget_id=Mariana.Mariana
    local sums=(SUMMARY="${summary^}" DOWNLOADS="$downloads" WINGET_ID="$winget_id" SOURCE="$source" ZIP="$zip" DMG="$dmg")
    sums+=(SOURCE_SUM="$(checksum "$source")" ZIP_SUM="$(checksum "$zip")" DMG_SUM="$(checksum "$dmg")")
    while read -r template to; do
        mkdir -p "$folder/${to%/*}"
        fill "$template" "${sums[@]}" >"$folder/$to"
    done <<EOF
flatpak.json flatpak/$id.json
homebrew.rb homebrew/mariana.rb
winget/version.yaml winget/$winget_id.yaml
winget/installer.yaml winget/$winget_id.installer.yaml
winget/locale.yaml winget/$winget_id.locale.en-US.yaml
EOF
    flatpak_sources >"$folder/flatpak/cargo-sources.json"
    mv "$folder" "$work/$name"
    tar -C "$work" --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -czf "$out/$name.tar.gz" "$name"
    printf '%s\n' "$out/$name.tar.gz"
}
