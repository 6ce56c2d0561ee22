# shellcheck shell=bash disable=SC2154,SC2034 # setup.sh sets root; scripts/package uses the facts.
# The facts of a release, read from the files that define them. Source it after setup.sh.

id=org.mariana.Mariana
metainfo=$root/assets/desktop/$id.metainfo.xml
# The newest glibc that a download may need: Debian 12's. docs/start.md names it.
newest_glibc=2.36

# fact KEY prints a value of Cargo.toml, from [package] or [workspace.package].
fact() {
    local value
    value=$(sed -n "s/^$1 *= *\"\(.*\)\"\$/\1/p" "$root/Cargo.toml" | head -n 1)
    [[ -n $value ]] || fail "Cargo.toml has no $1. Add it to [workspace.package]."
    printf '%s\n' "$value"
}

# Sets the facts as variables. Files in packages have the time of the last commit, so that packages can be reproduced.
read_facts() {
    version=$(fact version)
    licence=$(fact license)
    copyright=$(sed -n 's/^Copyright (c) //p' "$root/LICENSE-MIT")
    repository=$(fact repository)
    homepage=$(fact homepage)
    documentation=$(fact documentation)
    summary=$(fact description)
    # "A music visualizer whose ...: ..." to "music visualizer whose ...".
    summary=${summary#A }
    summary=${summary%%:*}
    # No address for mail exists, but packages need one.
    local owner=${repository#*://*/}
    maintainer="$(sed -n '/<developer /,/<\/developer>/s/.*<name>\(.*\)<\/name>.*/\1/p' "$metainfo") <${owner%%/*}@users.noreply.github.com>"
    machine=$(uname -m)
    if [[ $machine == arm64 ]]; then machine=aarch64; fi
    if [[ -z ${SOURCE_DATE_EPOCH:-} ]]; then
        SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct 2>/dev/null) || SOURCE_DATE_EPOCH=$(date +%s)
    fi
    export SOURCE_DATE_EPOCH
}

# Prints the description in metainfo.xml: paragraphs of at most 76 columns, and items that start with "  * ".
description() {
    sed -n '/^  <description>/,/^  <\/description>/p' "$metainfo" | awk '
        { gsub(/^ +| +$/, "") }
        /^<li>/ { gsub(/<[^>]*>/, ""); print "  * " $0; next }
        /^<(p|ul)>/ { if (NR > 2) print ""; next }
        !/^</ { print }' | fold -s -w 74 | awk '
        /^  \* / { item = 1 }
        /^$/ { item = 0 }
        { sub(/ *$/, ""); print (item && !/^  \* / ? "    " : "") $0 }'
}

# fill TEMPLATE NAME=VALUE... prints a file of packaging/ whose names (@NAME@) are replaced by the facts and these values.
fill() {
    local text pair value left
    # In new shells, a & in a value would mean the replaced name.
    shopt -u patsub_replacement 2>/dev/null || true
    text=$(<"$root/packaging/$1")
    for pair in "${@:2}" VERSION="$version" LICENCE="$licence" COPYRIGHT="$copyright" REPOSITORY="$repository" \
        HOMEPAGE="$homepage" DOCUMENTATION="$documentation" SUMMARY="$summary" MAINTAINER="$maintainer" ID="$id"; do
        value=${pair#*=}
        text=${text//"@${pair%%=*}@"/$value}
    done
    left=$(grep -o '@[A-Z][A-Z_0-9]*@' <<<"$text" | sort -u | tr '\n' ' ') || true
    [[ -z $left ]] || fail "packaging/$1 has unknown names: $left. Remove them, or define them in scripts/lib/package."
    printf '%s\n' "$text"
}

# Prints the licences of all crates in the program: each text once, after the names of its crates.
third_party_notices() {
    local home=${CARGO_HOME:-${HOME:-}/.cargo} crates texts
    crates=$(cd "$root" && cargo tree --quiet --locked --package mariana --edges normal --prefix none --format '{p}|{l}|{r}') ||
        fail "cargo cannot list the crates. See its message above."
    crates=$(sed -n 's/ (\*)$//; s/^\([^ ]*\) v\([^ |]*\)[^|]*|/\1-\2|/p' <<<"$crates" | grep -v '^mariana' | LC_ALL=C sort -u)
    # Sort by checksum, so that crates with the same text follow each other.
    texts=$(cut -d '|' -f 1 <<<"$crates" | while read -r crate; do
        find "$home"/registry/src/*/"$crate" -maxdepth 2 -type f \
            \( -iname 'licen[cs]e*' -o -iname 'copying*' -o -iname 'notice*' -o -iname 'unlicense*' -o -iname '[ou]fl.txt' \) \
            ! -name '*.rs' -exec cksum {} + 2>/dev/null || true
    done | LC_ALL=C sort)
    [[ -n $texts ]] || fail "$home/registry/src has no licences of crates. Run 'cargo fetch', then run this again."
    printf 'Mariana contains these libraries, under these licences:\n\n'
    awk -F '|' '{ print "  " $1 ": " $2 ($3 == "" ? "" : ", " $3) }' <<<"$crates"
    awk '
        { sum = $1 " " $2; sub(/^[0-9]+ [0-9]+ /, ""); crate = $0 }
        { sub(/.*\/registry\/src\/[^\/]*\//, "", crate); sub(/\/.*/, "", crate) }
        sum != last { if (last != "") print file "|" names; last = sum; file = $0; names = crate; next }
        index(names, crate) == 0 { names = names ", " crate }
        END { print file "|" names }' <<<"$texts" |
        while IFS='|' read -r file names; do
            printf '\n%s\n%s\n\n' "$(printf '=%.0s' {1..80})" "$names" | fold -s -w 100
            cat "$file"
        done
}

# notes TAG prints the section of a version in CHANGELOG.md, without its heading.
notes() {
    local section
    section=$(awk -v wanted="${1#v}" '/^## / { on = ($2 == wanted); next } on' "$root/CHANGELOG.md")
    [[ $section == *[!$' \n']* ]] || fail "CHANGELOG.md has no section '## ${1#v}'. Write the changes of this version first."
    sed '/./,$!d' <<<"$section"
}

# check_release TAG fails unless version, changelog and metadata agree with the tag.
check_release() {
    [[ -n $1 ]] || fail "check needs --tag, such as --tag v$version."
    [[ $1 == "v$version" ]] || fail "The tag is $1, but Cargo.toml has the version $version. Change one of them."
    notes "$1" >/dev/null
    ! grep -q "^## $version .*unreleased" "$root/CHANGELOG.md" ||
        fail "CHANGELOG.md calls $version unreleased. Replace the word by the date."
    grep -q "<release version=\"$version\"" "$metainfo" ||
        fail "${metainfo#"$root/"} has no <release version=\"$version\">. Add it with its date."
    say "$1 is ready."
}
