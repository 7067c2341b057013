#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves what rtl/formal/*.sv assert, with Yosys and ABC.
#
#   rtl/formal/prove.sh [PROOF...]            default: all
#   rtl/formal/prove.sh --mutants [PROOF...]  plants each fault that a proof names in a copy of the
#                                             sources, and expects a counterexample for each
#   rtl/formal/prove.sh --list                names the proofs
#
# A proof is a module `proof` with assertions, and says in comments of its head
#   engine: pdr      for all time: ABC finds an invariant and checks it (IC3)
#   engine: bmc N    for the first N cycles
#   engine: sat      combinational: for all inputs
#   sources: FILE... modules that it uses, from rtl/
#   fault: FILE: TEXT => OTHER    a line that occurs once, and what breaks the proof
# FASTTREE_PROOF_SECONDS: how long one may take (default 120).
set -uo pipefail
cd "$(dirname "$0")/../.."
. scripts/lib.sh

limit=${FASTTREE_PROOF_SECONDS:-120}
mutants=no
names=()
for argument in "$@"; do
  case $argument in
    --mutants) mutants=yes ;;
    --list)
      for file in rtl/formal/*.sv; do basename "$file" .sv; done
      exit 0
      ;;
    -*) fail "unknown option $argument; known: --mutants, --list" ;;
    *)
      [ -e "rtl/formal/$argument.sv" ] || fail "there is no proof '$argument' (--list names them)"
      names+=("$argument")
      ;;
  esac
done
if [ ${#names[@]} -eq 0 ]; then mapfile -t names < <("$0" --list); fi
command -v yosys >/dev/null || fail "yosys is not here (scripts/setup.sh --ci installs it)"
command -v berkeley-abc >/dev/null || fail "berkeley-abc is not here (it comes with yosys)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# said FILE KEY: the lines of its head that begin with KEY.
said() { sed -n "s|^// $2: ||p" "$1"; }

# prove NAME FOLDER LABEL: with the sources in FOLDER; 0 proved, 1 refuted, 2 neither.
prove() {
  local file=rtl/formal/$1.sv folder=$2 base=$work/$3 engine
  engine=$(said "$file" engine)
  local sources=$folder/ft_pkg.sv source
  for source in $(said "$file" sources); do sources="$sources $folder/$source"; done
  {
    echo "read_verilog -sv -formal -D SYNTHESIS $sources $file"
    echo "prep -flatten -top proof"
    if [ "$engine" = sat ]; then
      echo "opt -full"
      echo "sat -prove-asserts -verify"
    else
      printf '%s\n' memory_map async2sync 'opt -fast' techmap 'opt -fast' \
        'dfflegalize -cell $_DFF_P_ 01' 'setundef -undriven -anyseq' aigmap clean \
        "write_aiger -zinit $base.aig"
    fi
  } >"$base.ys"
  timeout "$limit" yosys -q -l "$base.log" "$base.ys" >"$base.out" 2>&1
  local status=$?
  if [ "$engine" = sat ]; then
    if grep -q 'no model found: SUCCESS' "$base.log"; then return 0; fi
    if grep -q 'model found: FAIL' "$base.log"; then return 1; fi
    return 2
  fi
  [ "$status" -eq 0 ] || return 2
  local command=pdr
  case $engine in bmc*) command="bmc3 -F ${engine#bmc }" ;; esac
  timeout "$limit" berkeley-abc -c "read_aiger $base.aig; fold; $command" >"$base.abc" 2>&1
  if grep -q 'was asserted in frame' "$base.abc"; then return 1; fi
  if grep -qE 'Property proved|No output (asserted|failed)|No output.*failed in' "$base.abc"; then
    return 0
  fi
  return 2
}

complain() {
  tail -n 3 "$work/$1.out" "$work/$1.abc" 2>/dev/null | grep -vE '^$|^==>' | sed 's/^/        /'
}

# faulty NUMBER NAME FAULT: expects a counterexample.
faulty() {
  local label=$2.$1 source=${3%%: *} rest=${3#*: } begin=$SECONDS
  local find=${rest%% => *} replace=${rest#* => } folder=$work/$2.$1.rtl
  mkdir -p "$folder"
  cp -r rtl/ft_pkg.sv rtl/common "$folder/"
  for part in units system; do if [ -d "rtl/$part" ]; then cp -r "rtl/$part" "$folder/"; fi; done
  if [ "$(grep -cF -- "$find" "$folder/$source")" != 1 ]; then
    note "$2: '$find' does not occur on exactly one line of $source"
    return 1
  fi
  FIND=$find REPLACE=$replace awk '
    { place = index($0, ENVIRON["FIND"])
      if (place) $0 = substr($0, 1, place - 1) ENVIRON["REPLACE"] \
                      substr($0, place + length(ENVIRON["FIND"]))
      print }' "rtl/$source" >"$folder/$source"
  prove "$2" "$folder" "$label"
  case $? in
    1) note "refuted   $2, with: $replace ($((SECONDS - begin)) s)" ;;
    0) note "NOT SEEN  $2, with: $replace" && return 1 ;;
    *) note "UNDECIDED $2, with: $replace" && complain "$label" && return 1 ;;
  esac
}

sound() {
  local begin=$SECONDS
  prove "$1" rtl "$1"
  case $? in
    0) note "proved    $1, $(said "rtl/formal/$1.sv" engine) ($((SECONDS - begin)) s)" ;;
    1) note "REFUTED   $1" && complain "$1" && return 1 ;;
    *) note "UNDECIDED $1 (within $limit s)" && complain "$1" && return 1 ;;
  esac
}

failed=0
running=0
start() {
  if [ "$running" -ge "$(nproc)" ]; then
    wait -n || failed=$((failed + 1))
    running=$((running - 1))
  fi
  "$@" &
  running=$((running + 1))
}
for name in "${names[@]}"; do
  if [ "$mutants" = no ]; then
    start sound "$name"
    continue
  fi
  number=0
  while IFS= read -r fault; do
    start faulty "$number" "$name" "$fault"
    number=$((number + 1))
  done < <(said "rtl/formal/$name.sv" fault)
  [ "$number" -gt 0 ] || { note "$name names no fault" && failed=$((failed + 1)); }
done
while [ "$running" -gt 0 ]; do
  wait -n || failed=$((failed + 1))
  running=$((running - 1))
done
[ "$failed" -eq 0 ]
