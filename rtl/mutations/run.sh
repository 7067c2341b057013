#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Plants faults in a copy of the RTL, one at a time, and expects the test that each names to fail.
# rtl/mutations/*.txt list them: file, find (occurs once), replace, test, why.
#
#   rtl/mutations/run.sh [--first N] [LIST...]    default: every fault of every list
#
#   FASTTREE_MUTATIONS   folder for the copy and its build (default out/mutations), kept for next time
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

work=${FASTTREE_MUTATIONS:-$PWD/out/mutations}
copy=$work/source
mkdir -p "$copy"
for entry in CMakeLists.txt apps cmake configs include model render rtl scene src tests bench fuzz; do
  rm -rf "${copy:?}/$entry"
  cp -a "$entry" "$copy/"
done
build() {
  (cd "$copy" && configure_and_build build rtl_units_test -DFASTTREE_TESTS=ON -DFASTTREE_RTL_TOPS=OFF) \
    >"$work/build.log" 2>&1
}
build || fail "the unchanged copy does not build; see $work/build.log"

caught=0 missed=0
plant() {  # file find replace test why
  python3 - "$copy/rtl/$1" "$2" "$3" <<'PYTHON' || { note "NOT PLANTED  $1: $2"; missed=$((missed + 1)); return; }
import sys
path, find, replace = sys.argv[1:]
text = open(path).read()
if text.count(find) != 1:
    sys.exit(1)
open(path, "w").write(text.replace(find, replace))
PYTHON
  local result=caught
  # A fault that is refused before it runs is caught by lint.
  if build; then
    if timeout 300 "$copy/build/rtl/rtl_units_test" --gtest_filter="$4" >"$work/test.log" 2>&1; then
      result=MISSED
    fi
  else
    result="caught by the build"
  fi
  cp -p "rtl/$1" "$copy/rtl/$1"
  touch "$copy/rtl/$1"
  if [ "$result" = MISSED ]; then missed=$((missed + 1)); else caught=$((caught + 1)); fi
  note "$(printf '%-20s %-28s %-40s %s' "$result" "$1" "$4" "$5")"
}

for list in "${lists[@]}"; do
  number=0
  file='' find='' replace='' test='' why=''
  while IFS= read -r line || [ -n "$line" ]; do
    case $line in
      'file: '*) file=${line#file: } ;;
      'find: '*) find=${line#find: } ;;
      'replace: '*) replace=${line#replace: } ;;
      'replace:') replace='' ;;
      'test: '*) test=${line#test: } ;;
      'why: '*)
        why=${line#why: }
        number=$((number + 1))
        if [ "$number" -le "$first" ]; then plant "$file" "$find" "$replace" "$test" "$why"; fi
        ;;
    esac
  done <"$list"
done
say "$caught caught, $missed not"
[ "$missed" -eq 0 ]
