#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the commands of the README and of docs/ for real. Every ```sh block that follows a line
# <!-- run --> is executed, in order, in one folder of its own per page, with fasttree on the PATH.
# A block after <!-- compile --> (```cpp or ```c) is compiled against the installed library, linked
# and run. Links to files that do not exist fail as well.
#
#   scripts/check_readme.sh [PAGE...]     default: README.md, CONTRIBUTING.md, docs/*.md and docs/*/*.md
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh
root=$PWD
export PATH=$root/build/apps/fasttree:$PATH

pages=("$@")
if [ ${#pages[@]} -eq 0 ]; then pages=(README.md CONTRIBUTING.md docs/*.md docs/*/*.md); fi

configure_and_build build fasttree_app -DCMAKE_BUILD_TYPE=Release >/dev/null

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install build --component library --prefix "$work/install" >/dev/null

# Writes each marked block of page $1 to $2/NUMBER.sh, .cpp or .c.
extract() {
  awk -v folder="$2" '
    /^<!-- (run|compile) -->$/ { marked = 1; next }
    /^```/ && inside { inside = 0; close(file); next }
    /^```(sh|cpp|c)$/ && marked {
      inside = 1; marked = 0; ++number
      file = sprintf("%s/%03d.%s", folder, number, substr($0, 4)); next
    }
    /^```/ { marked = 0 }
    inside { print > file }
  ' "$1"
}

bad=0
for page in "${pages[@]}"; do
  # Links: every relative target has to exist.
  while read -r target; do
    target=${target%%#*}
    [ -n "$target" ] || continue
    if [ ! -e "$(dirname "$page")/$target" ]; then
      note "$page: link to $target, which is not there"
      bad=1
    fi
  done < <(grep -oE '\]\([^)]+\)|(src|href)="[^"]+"' "$page" |
    sed -E 's/^\]\(//; s/\)$//; s/^(src|href)="//; s/"$//' | grep -vE '^(https?:|mailto:)' || true)

  blocks=$work/${page%.md}  # pages in two folders may share a name
  mkdir -p "$blocks"
  extract "$page" "$blocks"
  count=0
  # A page's commands run at the root of a copy of the tree's links, so that they read as a user
  # types them but leave nothing behind in the tree.
  mkdir -p "$blocks/run"
  for entry in "$root"/*; do ln -s "$entry" "$blocks/run/"; done
  rm -f "$blocks/run/out"
  for block in "$blocks"/*.sh "$blocks"/*.cpp "$blocks"/*.c; do
    [ -e "$block" ] || continue
    count=$((count + 1))
    log=$blocks/log
    case $block in
      *.sh) (cd "$blocks/run" && bash -euo pipefail "$block") >"$log" 2>&1 </dev/null ;;
      *) (
        cd "$blocks/run"
        export PKG_CONFIG_PATH=$work/install/lib/pkgconfig
        export PKG_CONFIG_PATH=$PKG_CONFIG_PATH:$work/install/lib/$(uname -m)-linux-gnu/pkgconfig
        compiler=(g++ -std=c++20 -Wall -Wextra)
        case $block in *.c) compiler=(gcc -std=c99 -Wall -Wextra) ;; esac
        read -ra flags <<<"$(pkg-config --cflags --libs --static fasttree)"
        "${compiler[@]}" "$block" -o "$block.out" "${flags[@]}" &&
          LD_LIBRARY_PATH=$work/install/lib "$block.out"
      ) >"$log" 2>&1 </dev/null ;;
    esac || {
      note "$page: block $(basename "$block") failed:"
      cat "$block" "$log"
      bad=1
    }
  done
  note "$page: $count blocks run"
done
exit "$bad"
