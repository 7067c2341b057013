#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Plants faults in a copy of the RTL, one at a time, and expects the test that each names to fail.
# rtl/mutations/*.txt list them: file, find (occurs once), replace, test, why; and from there on in its
# list, models: in which of the verilated models that the test includes it is planted (else in all).
#
#   rtl/mutations/run.sh [--first N] [LIST...]    default: every fault of every list
#
# The tests are compiled once, in build/. For a fault only its models are made anew, and linked before
# those of build/. Warnings of Verilator do not count: the test has to see it.
# out/mutations/LIST.md holds a list's outcome as rows of a table.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/lib.sh

first=1000
lists=()
while [ $# -gt 0 ]; do
  case $1 in
    --first) first=$2; shift ;;
    -*) fail "unknown option $1; known: --first N" ;;
    *) lists+=("rtl/mutations/$(basename "$1" .txt).txt") ;;
  esac
  shift
done
[ ${#lists[@]} -gt 0 ] || lists=(rtl/mutations/*.txt)

root=$PWD
work=$root/out/mutations
mkdir -p "$work"
scratch=$(mktemp -d "$work/faults.XXXXXX")
if command -v ccache >/dev/null; then export OBJCACHE=ccache; fi
export GTEST_FAIL_FAST=1

# binary_of TEST: the program that has it.
binary_of() {
  case $1 in
    RtlMachine.*) echo rtl_machine_test ;;
    *) echo rtl_units_test ;;
  esac
}

# models_of TEST: what its file includes of them, or the machine's first variant.
models_of() {
  case $1 in
    RtlMachine.*) echo paper ;;
    *) grep -lE "^TEST(_F)?\\(${1%%.*}," rtl/*/*_test.cpp | xargs sed -n 's/^#include "V\(.*\)\.h"$/\1/p' ;;
  esac
}

# link BINARY OUTPUT ARCHIVE...: as build/ links it, with the archives before build's own. An object of
# these may come in all the same, for a function of the standard library: the first one counts.
link() {
  local command
  command=$(ninja -C build -t commands "$1" | tail -n 1)
  command=${command#*&& }
  command=${command% &&*}
  local archives="-Wl,--allow-multiple-definition -Wl,--whole-archive ${*:3} -Wl,--no-whole-archive"
  (cd build && eval "${command/-o rtl\/$1/-o $2 $archives}")
}

# outcome FOLDER FILE FIND REPLACE TEST MODELS: prints it.
outcome() {
  local folder=$1 test=$5 models=$6 binary pieces=0 model archives=() status=0
  rm -rf "$folder"
  mkdir -p "$folder/rtl"
  (cd rtl && cp --parents fasttree.f waivers.vlt ./*.sv ./*/*.sv "$folder/rtl")
  python3 - "$folder/rtl/$2" "$3" "$4" <<'PYTHON' || { echo "NOT PLANTED"; return; }
import sys
path, find, replace = sys.argv[1:]
text = open(path).read()
if text.count(find) != 1:
    sys.exit(1)
open(path, "w").write(text.replace(find, replace))
PYTHON
  binary=$(binary_of "$test")
  # The machine in pieces, of which most are as they were.
  [ "$binary" = rtl_units_test ] || pieces=1
  for model in ${models:-$(models_of "$test")}; do
    local verilated=$folder/V$model arguments
    arguments=$(<"build/rtl/V$model.dir/verilator_args.txt")
    arguments=${arguments//--make;cmake;/}
    arguments=${arguments//$root\/build\/rtl\/V$model.dir/$verilated}
    arguments=${arguments//$root\/rtl\//}
    local words
    IFS=';' read -r -a words <<<"$arguments"
    if ! (cd "$folder/rtl" && "${words[@]}" -Wno-fatal) >"$verilated.log" 2>&1 ||
      ! cmp -s "build/rtl/V$model.dir/V$model.h" "$verilated/V$model.h" ||
      ! make -C "$verilated" -f "V$model.mk" VM_PARALLEL_BUILDS=$pieces OPT_FAST=-O1 OPT_SLOW=-O0 \
        CFG_CXXFLAGS_NO_UNUSED=-w "V${model}__ALL.a" >>"$verilated.log" 2>&1; then
      echo "NOT BUILT"
      return
    fi
    archives+=("$verilated/V${model}__ALL.a")
  done
  link "$binary" "$folder/test" "${archives[@]}" >"$folder/link.log" 2>&1 || { echo "NOT LINKED"; return; }
  timeout 300 "$folder/test" --gtest_filter="$test" >"$folder/test.log" 2>&1 || status=$?
  case $status in
    0) echo MISSED ;;
    124) echo "caught by the time limit" ;;
    *) echo caught ;;
  esac
}

# plant NUMBER ROW FILE FIND REPLACE TEST MODELS WHY: one fault, in the folder of that number.
plant() {
  local begin=$SECONDS result
  result=$(outcome "$scratch/$1" "${@:3:5}")
  note "$(printf '%-12s %3d s  %-28s %s' "$result" $((SECONDS - begin)) "$3" "$8")"
  echo "| \`$(basename "$3")\` | \`$6\` | $8 | $result |" >"$2"
  case $result in caught*) rm -rf "${scratch:?}/$1" ;; esac
}

binaries=(rtl_units_test)
if grep -q '^test: RtlMachine' "${lists[@]}"; then binaries+=(rtl_machine_test); fi
for binary in "${binaries[@]}"; do
  (configure_and_build build "$binary" -DFASTTREE_TESTS=ON) >"$work/build.log" 2>&1 ||
    fail "$binary does not build; see $work/build.log"
done

total=0
places=$(build_jobs)
for list in "${lists[@]}"; do
  name=$(basename "$list" .txt)
  rm -f "$work/$name".*.row
  number=0
  file='' find='' replace='' test='' models=''
  while IFS= read -r line || [ -n "$line" ]; do
    case $line in
      'file: '*) file=${line#file: } ;;
      'find: '*) find=${line#find: } ;;
      'replace: '*) replace=${line#replace: } ;;
      'replace:') replace='' ;;
      'test: '*) test=${line#test: } ;;
      'models: '*) models=${line#models: } ;;
      'why: '*)
        number=$((number + 1))
        [ "$number" -le "$first" ] || continue
        total=$((total + 1))
        if [ "$total" -gt "$places" ]; then wait -n; fi
        row=$work/$name.$(printf %02d "$number").row
        plant "$total" "$row" "$file" "$find" "$replace" "$test" "$models" "${line#why: }" &
        ;;
    esac
  done <"$list"
done
wait
caught=0
for list in "${lists[@]}"; do
  name=$(basename "$list" .txt)
  cat "$work/$name".*.row >"$work/$name.md"
  caught=$((caught + $(grep -c '| caught[^|]*|$' "$work/$name.md" || true)))
done
say "$caught of $total caught"
if [ "$caught" -ne "$total" ]; then fail "what is left of the others lies in $scratch"; fi
rmdir "$scratch"
