#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Cycles of the accelerator's model beside those of its RTL, as the table of docs/accelerator/rtl.md: each scene,
# on three variants of the machine and two memories. Every run's arrays and tree are compared with the reference
# builder's. Exit 1 where one differs, or where the model misses by more than 3 per cent (10 in a stage).
#
#   scripts/rtl_cycles.sh SCENE...     mesh files or scene:NAME
#
#   FASTTREE   the program (default build/apps/fasttree/fasttree)
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

program=${FASTTREE:-build/apps/fasttree/fasttree}
[ $# -gt 0 ] || fail "no scene; say for instance: scripts/rtl_cycles.sh scene:knot:500"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
wrong=0

wide=(--set paper.bus_bytes_per_cycle=32)
narrow=(--set paper.bus_bytes_per_cycle=8 --set paper.morton_code_units=2 --set paper.prefix_sum_units=2)
printf '| scene | variant | memory, clock | model | RTL | %% | stage, %% |\n'
printf '| --- | --- | --- | --- | --- | --- | --- |\n'
for scene in "$@"; do
  for variant in paper wide narrow; do
    settings=()
    [ "$variant" = wide ] && settings=("${wide[@]}")
    [ "$variant" = narrow ] && settings=("${narrow[@]}")
    for config in paper-fpga paper-asic65; do
      for engine in model rtl; do
        "$program" simulate "$scene" --config "$config" "${settings[@]}" --engine "$engine" --verify --quiet \
          --json "$work/$engine.json" || fail "$scene on $variant, $config: the $engine's tree is not right"
      done
      # An empty stage has no per cent; the grid's set-up is no stage of the paper.
      jq -r -n --slurpfile m "$work/model.json" --slurpfile r "$work/rtl.json" --arg variant "$variant" '
        def percent(a; b): 100 * (a - b) / b;
        def signed: (. * 100 | round / 100) as $v | (if $v >= 0 then "+" else "" end) + ($v | tostring);
        def grouped: tostring | [while(length > 0; .[:-3]) | .[-3:]] | reverse | join(",");
        $m[0] as $m | $r[0] as $r
        | ([range($m.stages | length) as $i | $m.stages[$i] as $s | $r.stages[$i] as $t
            | select($t.cycles > 0) | {stage: $s.stage, off: percent($s.cycles; $t.cycles)}]
           | max_by(.off | fabs)) as $worst
        | percent($m.cycles; $r.cycles) as $total
        | [(if ($total | fabs) > 3 or ($worst.off | fabs) > 10 then "far" else "near" end),
           "| \($m.scene) | \($variant) | \($m.config), \($m.clock_mhz) MHz | \($m.cycles | grouped) | \($r.cycles | grouped) | \($total | signed) | \($worst.stage) \($worst.off | signed) |"]
        | join("\t")' >"$work/row"
      IFS=$'\t' read -r verdict row <"$work/row"
      printf '%s\n' "$row"
      if [ "$verdict" = far ]; then wrong=$((wrong + 1)); fi
    done
  done
done
[ "$wrong" -eq 0 ] || fail "$wrong runs are farther from the model than 3 per cent (10 in a stage)"
