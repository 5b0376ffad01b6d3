# shellcheck shell=bash
# What experiments/run and tests/run share: missing packages, configuring, building. Sourced, not run.
# All messages go to standard error, so that standard output belongs to the program that is run.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
dry_run=${LANCET_DRY_RUN:-}

say() { printf '%s\n' "$*" >&2; }

die() {
    say "${0##*/}: error: $*"
    exit 2
}

# Runs a command, or only shows it when LANCET_DRY_RUN is set.
act() {
    if [ -n "$dry_run" ]; then
        say "would run: $*"
    else
        "$@"
    fi
}

# packages_in FILE: the package names in a list, without comments.
packages_in() { sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$1"; }

# missing_packages FILE...: those packages of the lists that are not installed.
missing_packages() {
    local list package
    for list in "$@"; do
        for package in $(packages_in "$list"); do
            # The status of a package that dpkg has never heard of is empty.
            if [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
                printf '%s\n' "$package"
            fi
        done
    done
}

# install_packages FILE...: installs what is missing; does nothing at all when nothing is.
install_packages() {
    if [ -n "${LANCET_NO_INSTALL:-}" ]; then
        return 0
    fi
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        die "this is not a Debian system: install the counterparts of the packages in cmake/debian-packages.txt," \
            "then set LANCET_NO_INSTALL=1"
    fi
    local missing
    missing=$(missing_packages "$@")
    [ -n "$missing" ] || return 0
    missing=${missing//$'\n'/ }
    say "Missing Debian packages: $missing"

    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null ||
            die "neither root nor sudo: ask for 'apt-get install $missing', then run this again"
        as_root=(sudo)
    fi
    # shellcheck disable=SC2086  # the names are words of their own
    if ! { act "${as_root[@]}" apt-get update &&
        act "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing; } >&2
    then
        die "apt-get could not install: $missing"
    fi
}

# build PRESET [TARGET...]: configures and builds targets, or everything without one; returns 1 when that fails.
build() {
    local preset=$1
    shift
    local folder=$root/build/$preset
    local targets=()
    [ $# -eq 0 ] || targets=(--target "$@")
    if [ -n "$dry_run" ]; then
        act cmake --preset "$preset"
        act cmake --build "$folder" "${targets[@]}"
        return
    fi

    mkdir -p "$folder"
    (
        # Two runs at once would build in the same folder: the second one waits.
        if command -v flock >/dev/null; then
            exec 9>"$folder/.lock"
            flock 9
        fi
        say "Configuring build/$preset ..."
        if ! (cd "$root" && cmake --preset "$preset") >"$folder/configure.log" 2>&1; then
            cat "$folder/configure.log" >&2
            exit 1
        fi
        say "Building build/$preset ..."
        cmake --build "$folder" "${targets[@]}" >&2
    ) || {
        say "${0##*/}: error: build/$preset could not be built"
        return 1
    }
}
