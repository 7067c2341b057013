#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the libFuzzer targets with clang, ASan and UBSan, and runs each on its committed corpus.
#
#   scripts/fuzz.sh                       FASTTREE_FUZZ_SECONDS (default 5) seconds a target
#   scripts/fuzz.sh TARGET [ARGUMENT...]  one target, with libFuzzer's own arguments, for example
#                                         scripts/fuzz.sh ply_fuzz -runs=1000000
# New inputs are kept in build-fuzz/found/, not in the committed corpus.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

clang=$(command -v clang++-14 || command -v clang++ || true)
if [ -z "$clang" ]; then
  note "skipped: no clang here (scripts/setup.sh --ci installs it)"
  exit 0
fi
seconds=${FASTTREE_FUZZ_SECONDS:-5}

CC=${clang/clang++/clang} CXX=$clang configure_and_build build-fuzz fuzz/all \
  -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" \
  -DFASTTREE_FUZZ=ON -DFASTTREE_SANITIZE=address,undefined -DFASTTREE_TESTS=OFF -DFASTTREE_APPS=ON \
  -DFASTTREE_RTL=OFF

mapfile -t targets < <(find build-fuzz/fuzz -maxdepth 1 -type f -executable -name '*_fuzz' | sort)
[ ${#targets[@]} -gt 0 ] || fail "no fuzz target was built"
limits=(-max_total_time="$seconds")
if [ $# -gt 0 ]; then
  targets=("build-fuzz/fuzz/$1")
  [ -x "${targets[0]}" ] || fail "there is no fuzz target '$1'"
  shift
  limits=("$@")
fi

for target in "${targets[@]}"; do
  name=$(basename "$target")
  corpus=fuzz/corpus/${name%_fuzz}
  if [ ! -d "$corpus" ]; then corpus=${corpus%_file}; fi
  found=build-fuzz/found/$name
  mkdir -p "$found"
  folders=("$found")
  if [ -d "$corpus" ]; then folders+=("$corpus"); fi
  log=build-fuzz/$name.log
  if ! "$target" -rss_limit_mb=3000 -timeout=20 -artifact_prefix="$found/" -print_final_stats=1 \
         "${limits[@]}" "${folders[@]}" >"$log" 2>&1 </dev/null; then
    tail -n 60 "$log" >&2
    fail "$name found a fault; the input that shows it is in $found"
  fi
  note "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, no fault"
done
