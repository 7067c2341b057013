#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From nothing to a verified kd-tree and a picture of it: installs what is needed (Debian packages),
# builds the program, builds the Stanford Dragon's tree, proves it right with rays, draws it, and
# compares the builders. Everything it makes lies in out/.
#
#   ./demo.sh            the Dragon; where it cannot be fetched, a built-in scene
#   ./demo.sh SCENE      a mesh file (PLY, OBJ, STL, glTF, GLB) or scene:NAME[:TRIANGLES]
set -euo pipefail
case ${1:-} in
  -h | --help)
    sed -n '3,8s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
esac
# A scene given by file is meant as seen from where the script was called.
scene=${1:-}
if [ -n "$scene" ] && [ -e "$scene" ]; then scene=$(realpath "$scene"); fi
cd "$(dirname "$0")"
. scripts/lib.sh
begin=$SECONDS

scripts/setup.sh

say "Building the program (Release, build/)"
configure_and_build build fasttree_app -DCMAKE_BUILD_TYPE=Release -DFASTTREE_APPS=ON \
  -DFASTTREE_TESTS=OFF
program=build/apps/fasttree/fasttree

mkdir -p out
credit=
view=(--size 1280x960)
if [ -z "$scene" ]; then
  say "Looking for the Stanford Dragon"
  if scene=$(scripts/fetch_dragon.sh --install-npm); then
    note "$scene"
    view=(--size 1280x720 --eye 0.06,0.19,0.24 --target -0.006,0.118,-0.004 --fov 40)
    credit="The Stanford Dragon is a model of the Stanford Computer Graphics Laboratory (Stanford 3D \
Scanning Repository): free for research, with credit; no commercial use without permission."
  else
    scene=scene:knot:500000
    note "not reachable from here: the built-in scene $scene takes its place"
  fi
fi

say "1 of 4: building its kd-tree"
"$program" build "$scene" --repeat 5 --out out/tree.ft --json out/build.json

say "2 of 4: proving it right"
"$program" verify out/tree.ft --mesh "$scene" --rays 100000 --json out/verify.json

say "3 of 4: drawing it"
"$program" render out/tree.ft --mesh "$scene" "${view[@]}" --samples 4 --ao 4 --ground \
  --out out/picture.png --json out/render.json
"$program" render out/tree.ft --mesh "$scene" "${view[@]}" --mode heat --out out/heat.png \
  --json out/heat.json --quiet
"$program" render out/tree.ft --mesh "$scene" --size 960x720 --mode leaves --out out/leaves.png \
  --json out/leaves.json --quiet
note "and out/heat.png (what each pixel costs), out/leaves.png (the tree's leaves, cut by a plane)"

say "4 of 4: comparing it with trees of the surface-area heuristic"
builders=realtime,paper-cyclic,paper-longest,sah-binned,sah-exact
if "$program" info --json - | jq -e .embree >/dev/null; then builders+=,embree; fi
"$program" compare "$scene" --builders "$builders" --size 512x512 --repeat 3 \
  --json out/compare.json --svg out/compare.svg

jq -n --slurpfile build out/build.json --slurpfile verify out/verify.json \
  --slurpfile render out/render.json --slurpfile heat out/heat.json \
  --slurpfile compare out/compare.json \
  '{build: $build[0], verify: $verify[0], render: $render[0], heat: $heat[0],
    compare: $compare[0]}' >out/figures.json
scripts/summary.sh out "$credit" >out/index.html

say "Done in $(((SECONDS - begin) / 60)) min $(((SECONDS - begin) % 60)) s"
note "picture   $PWD/out/picture.png"
note "figures   $PWD/out/figures.json"
note "summary   $PWD/out/index.html"
if [ -n "$credit" ]; then printf '\n'; fold -s -w 92 <<<"$credit" | sed 's/^/    /; s/ $//'; fi
