#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The benchmark: real scenes, profiles realtime and paper, one and two threads, each against Embree.
# Figures and charts go to out/benchmark/; a table of ratios ends it (more than 1: the kd-tree is
# faster), after an uneven scene and the growth of time and memory from 10,000 to 10,000,000
# triangles. Takes minutes; nothing else should run on the machine.
#
#   scripts/benchmark.sh [FOLDER] [OPTION...]
#
#   FOLDER    holds bunny.ply, dragon.ply, sponza.ply, sibenik.ply; those that are not there are
#             skipped. Default: the folder that FASTTREE_SCENES names, or ./scenes
#   OPTION    for fasttree compare, such as --repeat 3 --size 512x512
#   FASTTREE  in the environment: the program to run, instead of building it
set -euo pipefail
case ${1:-} in
  -h | --help)
    sed -n '3,14s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
esac
scenes=${FASTTREE_SCENES:-scenes}
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
  scenes=$1
  shift
fi
# Both are meant as seen from where the script was called.
scenes=$(realpath -m "$scenes")
program=${FASTTREE:-}
if [ -n "$program" ]; then program=$(realpath "$program"); fi
cd "$(dirname "$0")/.."
. scripts/lib.sh

command -v jq >/dev/null 2>&1 || fail "jq is not here: run scripts/setup.sh"
[ -d "$scenes" ] || fail "$scenes is not a folder: give the one with the scenes, or name it in FASTTREE_SCENES"
if [ -z "$program" ]; then
  say "Building the program (Release, build/)"
  configure_and_build build fasttree_app -DCMAKE_BUILD_TYPE=Release -DFASTTREE_APPS=ON
  program=build/apps/fasttree/fasttree
fi

# Name, and where to look from: statues from outside, churches and courts from within the nave.
views=(
  "bunny"
  "dragon"
  "sponza --eye=-11,4,0 --target=10,5,0 --light=0,10,0"
  "sibenik --eye=-10,6,0 --target=20,8,0 --light=0,14,0"
)
out=out/benchmark
mkdir -p "$out"
# What an earlier run left would stand in the table as if it were this one's.
rm -f "$out"/*.json "$out"/*.svg

results=()
for entry in "${views[@]}"; do
  read -ra view <<<"$entry"
  scene=${view[0]}
  if [ ! -e "$scenes/$scene.ply" ]; then
    say "Skipped: $scenes/$scene.ply is not there"
    continue
  fi
  for profile in realtime paper; do
    for threads in 1 2; do
      say "$scene, profile $profile, $threads thread$([ "$threads" = 1 ] || echo s)"
      result=$out/$scene-$profile-$threads
      "$program" compare "$scenes/$scene.ply" "${view[@]:1}" --profile "$profile" \
        --threads "$threads" --json "$result.json" --svg "$result.svg" "$@"
      results+=("$result.json")
    done
  done
done
[ ${#results[@]} -gt 0 ] || fail "none of the scenes is in $scenes"

say "An uneven scene: a dense object in a huge room, profile realtime, 2 threads"
"$program" compare scene:stadium --profile realtime --threads 2 --json "$out/stadium-realtime-2.json" \
  --svg "$out/stadium-realtime-2.svg" "$@"
results+=("$out/stadium-realtime-2.json")

say "Growth: scene:knot, profile realtime, builds alone"
for size in 10k 100k 1M 10M; do
  for threads in 1 2; do
    result=$out/knot-$size-$threads.json
    "$program" build "scene:knot:$size" --threads "$threads" --repeat 7 --quiet --json "$result"
    jq -r '[.triangles, .threads, .build_ms, .build_ms * 1e6 / .triangles,
            (.peak_resident_bytes // 0) / .triangles] | @tsv' "$result"
  done
done | awk -F'\t' 'BEGIN { print "   triangles  threads  build ms  ns a triangle  peak bytes a triangle" }
  { printf "%12d %8d %9.2f %14.1f %22.0f\n", $1, $2, $3, $4, $5 }' | tee "$out/growth.txt"

say "How many times as fast as Embree (rays: build quality medium)"
jq -rs '
  def text: if . == null then "-" else (. * 100 | round | tostring
    | if length < 3 then "0" * (3 - length) + . else . end | .[:-2] + "." + .[-2:]) end;
  ["scene", "profile", "threads", "build", "frame", "primary", "shadow", "diffuse",
   "primary_packet", "shadow_packet"],
  (.[] | [.scene, .ratio.of, .threads, (.ratio | .build, .frame, .primary_single, .shadow_single,
    .diffuse_single, .primary_packet, .shadow_packet | text)])
  | @tsv' "${results[@]}" | tee "$out/ratios.tsv" |
  awk -F'\t' '{
    printf "%-12s %-14s", $1, $2
    for (i = 3; i <= NF; ++i) printf(i > 8 ? " %14s" : " %8s", $i)
    print ""
  }'
note "figures and charts: $PWD/$out/"
