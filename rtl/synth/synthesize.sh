#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Synthesises units of the accelerator with Yosys, for the FPGA family of the paper and to standard
# cells, and writes their figures to rtl/synth/reports/UNIT.json.
#
#   rtl/synth/synthesize.sh [UNIT...]          units of rtl/synth/units.json; none: all of them
#   rtl/synth/synthesize.sh --check [UNIT...]  writes nothing; fails where a committed report is not
#                                              what comes out now, and says what drifted
#   rtl/synth/synthesize.sh --list             names the units
#
# Needs yosys, qflow-tech-osu018, jq (scripts/setup.sh --ci). docs/accelerator/synthesis.md explains.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/lib.sh

list=rtl/synth/units.json
liberty=${FASTTREE_LIBERTY:-/usr/share/qflow/tech/osu018/osu018_stdcells.lib}
reports=rtl/synth/reports

check=no
units=()
for argument in "$@"; do
  case $argument in
    --check) check=yes ;;
    --list)
      jq -r '.[].unit' "$list"
      exit 0
      ;;
    -*) fail "unknown option $argument; known: --check, --list" ;;
    *) units+=("$argument") ;;
  esac
done
if [ ${#units[@]} -eq 0 ]; then mapfile -t units < <(jq -r '.[].unit' "$list"); fi
for unit in "${units[@]}"; do
  jq -e --arg u "$unit" 'any(.[]; .unit == $u)' "$list" >/dev/null ||
    fail "there is no unit '$unit'; known: $(jq -r '[.[].unit] | join(", ")' "$list")"
done
command -v yosys >/dev/null || fail "yosys is not here (scripts/setup.sh --ci installs it)"
[ -e "$liberty" ] || fail "$liberty is not here (scripts/setup.sh --ci installs qflow-tech-osu018)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$reports"
configure_and_build build fasttree_netlist -DCMAKE_BUILD_TYPE=Release >"$work/build.log" ||
  { cat "$work/build.log" && exit 1; }
netlist=$PWD/build/rtl/synth/fasttree_netlist

# sources MODULE: the files of it and of what it instances, in fasttree.f's order. No others: what Yosys
# makes of a unit depends on all it has read, and a unit's figures should change with the unit alone.
sources() {
  local needed=" ft_pkg " queue=("$1") module file
  while [ ${#queue[@]} -gt 0 ]; do
    module=${queue[0]}
    queue=("${queue[@]:1}")
    [[ $needed != *" $module "* ]] || continue
    file=$(grep -E "(^|/)$module\.sv$" rtl/fasttree.f) || continue
    needed+="$module "
    mapfile -t -O "${#queue[@]}" queue < <(sed 's|//.*||' "rtl/$file" | grep -oE '\bft_[a-z_]+' | sort -u)
  done
  while read -r file; do
    module=$(basename "$file" .sv)
    if [[ $needed == *" $module "* ]]; then printf 'rtl/%s ' "$file"; fi
  done < <(grep -E '\.sv$' rtl/fasttree.f)
}
printf 'set_driving_cell INVX1\nset_load 0.02 [all_outputs]\n' >"$work/constraints"

# synthesize UNIT: writes $work/UNIT.report.
synthesize() {
  local unit=$1 entry module parameters sources options still begin=$SECONDS
  entry=$(jq -c --arg u "$unit" '.[] | select(.unit == $u)' "$list")
  module=$(jq -r .module <<<"$entry")
  sources=$(sources "$module")
  options=$(jq -r '.options // ""' <<<"$entry")
  parameters=$(jq -r '.parameters | to_entries[] | "-chparam \(.key) \(.value)"' <<<"$entry" | tr '\n' ' ')
  mapfile -t still < <(jq -r '.still // [] | .[]' <<<"$entry")
  # The unit is renamed, since Yosys names a module with parameters after a hash of them.
  cat >"$work/$unit.xc7.ys" <<YOSYS
read_verilog -sv $sources
hierarchy -check -top $module $parameters
rename -top unit
synth_xilinx -family xc7 -flatten -noiopad -noclkbuf $options -top unit
delete =*/A:blackbox=1 =*/A:whitebox=1
write_json $work/$unit.xc7.json
YOSYS
  # Memories of up to eight words become flip-flops; larger ones stay what they are.
  cat >"$work/$unit.asic.ys" <<YOSYS
read_liberty -lib $liberty
read_verilog -sv $sources
hierarchy -check -top $module $parameters
rename -top unit
synth -flatten -top unit -run begin:fine
memory_map t:\$mem_v2 r:SIZE<=8 %i
opt -fast -full
opt -undriven -fine
techmap
opt -fast
dfflegalize -cell \$_DFF_P_ x
dfflibmap -liberty $liberty
abc -liberty $liberty -constr $work/constraints
clean
write_json $work/$unit.asic.json
YOSYS
  local flow
  for flow in xc7 asic; do
    if ! yosys -q -l "$work/$unit.$flow.log" "$work/$unit.$flow.ys" >"$work/$unit.$flow.out" 2>&1; then
      note "$unit: Yosys failed ($flow):"
      grep -E 'ERROR|Warning' "$work/$unit.$flow.out" "$work/$unit.$flow.log" | tail -n 5
      return 1
    fi
  done
  "$netlist" "$work/$unit.xc7.json" "$work/$unit.asic.json" "$liberty" "$work/$unit.asic.log" \
    "${still[@]}" >"$work/$unit.figures" || { note "$unit: no figures"; return 1; }
  jq -S --argjson entry "$entry" --arg yosys "$(yosys -V | awk '{ print $2 }')" \
    '. + {unit: $entry.unit, module: $entry.module, parameters: $entry.parameters, yosys: $yosys}' \
    "$work/$unit.figures" >"$work/$unit.report"
  rm -f "$work/$unit".*.json "$work/$unit".*.log
  jq -r --arg s "$((SECONDS - begin))" '"    \(.unit): \(.fpga.lut) LUT, \(.fpga.ff) FF, " +
    "\(.fpga.bram_kbits) kbit, \(.fpga.dsp) DSP, \(.timing.with_ports.mhz) MHz " +
    "(\(.timing.with_ports.levels) levels), \(.asic.gates) gates; \($s) s"' "$work/$unit.report"
}

failed=0
running=0
for unit in "${units[@]}"; do
  if [ "$running" -ge "$(nproc)" ]; then
    wait -n || failed=1
    running=$((running - 1))
  fi
  synthesize "$unit" &
  running=$((running + 1))
done
while [ "$running" -gt 0 ]; do
  wait -n || failed=1
  running=$((running - 1))
done

drifted=0
for unit in "${units[@]}"; do
  [ -e "$work/$unit.report" ] || continue
  if [ "$check" = no ]; then
    cp "$work/$unit.report" "$reports/$unit.json"
  elif ! diff -U 0 "$reports/$unit.json" "$work/$unit.report" >"$work/drift" 2>&1; then
    note "$unit drifted (- committed, + now):"
    grep -E '^[-+] |No such file' "$work/drift" || true
    drifted=$((drifted + 1))
  fi
done
if [ "$check" = yes ] && [ "$drifted" -eq 0 ] && [ "$failed" -eq 0 ]; then
  note "${#units[@]} reports are what comes out now"
fi
if [ "$drifted" -gt 0 ]; then
  note "$drifted of ${#units[@]} drifted; rtl/synth/synthesize.sh writes them anew"
fi
[ "$failed" -eq 0 ] && [ "$drifted" -eq 0 ]
