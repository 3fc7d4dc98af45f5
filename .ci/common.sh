# Shared by ./run and ./test; sourced, not run. Expects to stand in the project's root.
# shellcheck shell=bash

started_s=$SECONDS

# say WORDS...: one line of progress with the time since the start.
say() { printf '%5d s  %s\n' "$((SECONDS - started_s))" "$*"; }

# die WORDS...: what is wrong and what to do about it.
die() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit 1; }

# packages_of SECTION...: names from packages.txt.
packages_of() {
    local section
    for section in "$@"; do
        awk -v want="[$section]" '
            /^\[/ { inside = ($1 == want); next }
            inside && NF && $1 !~ /^#/ { print $1 }' packages.txt
    done
}

missing_of() {
    local name
    for name in $(packages_of "$@"); do
        dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q ' installed$' || echo "$name"
    done
}

# install_missing SECTION...: asks apt-get for what is not there; silent if nothing is missing.
install_missing() {
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        say "no apt-get here: packages.txt names what must be installed"
        return
    fi
    local missing optional
    missing=$(missing_of "$@" | tr '\n' ' ')
    if [ -z "$missing" ]; then return; fi
    optional=$(missing_of optional | tr '\n' ' ')
    say "installing: $missing$optional"
    local -a root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null ||
            die "these packages are missing and there is no sudo; as root: apt-get install $missing"
        root=(sudo)
    fi
    local log=build/apt.log
    mkdir -p build
    "${root[@]}" apt-get update >"$log" 2>&1 ||
        say "apt-get update failed ($log); trying with the lists that are there"
    # shellcheck disable=SC2086
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y --no-install-recommends $missing >>"$log" 2>&1 ||
        { tail -n 15 "$log" >&2; die "apt-get could not install: $missing (all of it in $log)"; }
    local name
    for name in $optional; do
        "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y --no-install-recommends "$name" >>"$log" 2>&1 ||
            say "going on without $name"
    done
}
