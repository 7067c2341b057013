#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Cycles of the accelerator's model beside those of its RTL, as the table of docs/accelerator/rtl.md: each scene,
# on three variants of the machine and two memories, by fasttree diff. Exit 1 where a word differs, or where the
# model misses by more than 3 per cent in all or 10 in a stage.
#
#   scripts/rtl_cycles.sh SCENE...     mesh files or scene:NAME
#
#   FASTTREE   the program (default build/apps/fasttree/fasttree)
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

program=${FASTTREE:-build/apps/fasttree/fasttree}
[ $# -gt 0 ] || fail "no scene; say for instance: scripts/rtl_cycles.sh scene:knot:500"
wrong=0
wide=(--set paper.bus_bytes_per_cycle=32)
narrow=(--set paper.bus_bytes_per_cycle=8 --set paper.morton_code_units=2 --set paper.prefix_sum_units=2)

printf '| scene | variant | configuration | model | RTL | %% | stage, %% |\n'
printf '| --- | --- | --- | --- | --- | --- | --- |\n'
for scene in "$@"; do
  for variant in paper wide narrow; do
    settings=()
    [ "$variant" = wide ] && settings=("${wide[@]}")
    [ "$variant" = narrow ] && settings=("${narrow[@]}")
    for config in paper-fpga paper-asic65; do
      figures=$("$program" diff "$scene" --config "$config" "${settings[@]}" --json - --quiet) ||
        fail "$scene on $variant, $config: fasttree diff says what is wrong"
      IFS=$'\t' read -r verdict row < <(jq -r --arg variant "$variant" '
        def signed: (. * 100 | round / 100) | (if . >= 0 then "+" else "" end) + tostring;
        def grouped: tostring | [while(length > 0; .[:-3]) | .[-3:]] | reverse | join(",");
        def size: . // 0 | fabs;
        .cycles[-1] as $all
        | (.cycles[:-1] | max_by(.model_off_percent | size)) as $worst
        | [(if ($all.model_off_percent | size) > 3 or ($worst.model_off_percent | size) > 10 then "far" else "near" end),
           ([.scene, $variant, .config, ($all.model_cycles | grouped), ($all.rtl_cycles | grouped),
             ($all.model_off_percent | signed), "\($worst.stage) \($worst.model_off_percent | signed)"]
            | "| " + join(" | ") + " |")]
        | join("\t")' <<<"$figures")
      printf '%s\n' "$row"
      if [ "$verdict" = far ]; then wrong=$((wrong + 1)); fi
    done
  done
done
[ "$wrong" -eq 0 ] || fail "in $wrong runs the model misses by more than 3 per cent (10 in a stage)"
