#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages that the project needs, and only those that are missing.
#
#   scripts/setup.sh           what the program and its demonstration need
#   scripts/setup.sh --test    and what the tests need
#   scripts/setup.sh --ci      and what the checks of .ci/run need
#   scripts/setup.sh --npm     and npm, which can fetch the Dragon (large; see fetch_dragon.sh)
#   scripts/setup.sh --list    print the names of all of them, install nothing
#
#   FASTTREE_SETUP=no          installs nothing: for systems other than Debian that have it all
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

build=(g++ cmake ninja-build pkg-config libtbb-dev libhwy-dev libxxhash-dev libfmt-dev
       libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libfast-float-dev libstb-dev libasio-dev
       libembree-dev libsdl2-dev zlib1g-dev verilator ca-certificates curl jq)
test=(libgtest-dev librapidcheck-dev libtinyobjloader-dev)
ci=(clang-14 libclang-rt-14-dev clang-format gcovr libbenchmark-dev yosys z3 qflow-tech-osu018
    chromium)

wanted=("${build[@]}")
list=no
for argument in "$@"; do
  case $argument in
    --test) wanted+=("${test[@]}") ;;
    --ci) wanted+=("${test[@]}" "${ci[@]}") ;;
    --npm) wanted+=(npm) ;;
    --list)
      wanted=("${build[@]}" "${test[@]}" "${ci[@]}")
      list=yes
      ;;
    *) fail "unknown argument '$argument'; known: --test, --ci, --npm, --list" ;;
  esac
done
if [ "$list" = yes ]; then
  printf '%s\n' "${wanted[@]}"
  exit 0
fi

if [ "${FASTTREE_SETUP:-yes}" = no ]; then exit 0; fi

installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

missing=()
if command -v dpkg-query >/dev/null 2>&1; then
  for package in "${wanted[@]}"; do
    installed "$package" || missing+=("$package")
  done
else
  fail "this set-up knows Debian and its relatives only (no dpkg-query here). Install what these" \
       "Debian packages hold, and run this again with FASTTREE_SETUP=no in the environment: ${wanted[*]}"
fi
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

say "Installing ${#missing[@]} packages: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 ||
    fail "packages are missing, and this is neither root nor is there sudo. Have somebody run:" \
         "apt-get install ${missing[*]}"
  as_root=(sudo)
fi
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 \
    -o Acquire::Retries=3 "$@"
}

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt update >"$log" 2>&1 </dev/null || {
  cat "$log" >&2
  fail "apt-get update failed: is the network there, and /etc/apt in order?"
}
apt install --yes --no-install-recommends "${missing[@]}" >"$log" 2>&1 </dev/null || {
  tail -n 30 "$log" >&2
  fail "apt-get could not install: ${missing[*]}. Is the network there? Is this" \
       "Debian 12 (bookworm)? Others may lack some of these packages."
}
note "installed"
