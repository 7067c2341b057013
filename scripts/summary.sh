#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes one self-contained HTML page about what demo.sh made, to standard output.
#
#   scripts/summary.sh FOLDER [CREDIT]    FOLDER holds figures.json and the pictures
set -euo pipefail
folder=$1
credit=${2:-}
figures=$folder/figures.json

# A failure inside the page below would go unseen, so it leaves a mark.
broken=$(mktemp)
trap 'rm -f "$broken"' EXIT
query() { jq -r "$1" "$figures" || echo "${1#"$jq_functions"}" >>"$broken"; }

# A figure, made safe for HTML. Argument: a jq expression.
get() { query "$1 | tostring | @html"; }

# Numbers for people: 871,414; 12.3.
jq_functions='
def commas: tostring | explode | reverse | [range(0; length; 3) as $i | .[$i:$i+3]]
  | map(reverse) | reverse | map(implode) | join(",");
def rounded($digits): (. * pow(10; $digits) | round | tostring)
  | if $digits == 0 then . else
      (if length <= $digits then "0" * ($digits + 1 - length) + . else . end)
      | .[:-$digits] + "." + .[-$digits:]
    end;'
show() { query "$jq_functions $1 | tostring | @html"; }

picture() {
  printf '<img alt="%s" src="data:image/%s;base64,' "$3" "$2"
  base64 -w 0 "$folder/$1" || echo "$1" >>"$broken"
  printf '">'
}

cat <<EOF2
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>FastTree: $(get .build.scene)</title>
<style>
  :root { --ink: #1f2937; --muted: #6b7280; --line: #e5e7eb; --accent: #2563eb; --back: #ffffff; --card: #f9fafb; }
  @media (prefers-color-scheme: dark) {
    :root { --ink: #e5e7eb; --muted: #9ca3af; --line: #374151; --accent: #60a5fa; --back: #111827; --card: #1f2937; }
  }
  body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 62rem; background: var(--back); color: var(--ink);
         font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
  h1 { font-size: 1.7rem; margin: 0 0 .25rem; }
  h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
  p { margin: .5rem 0; }
  .muted, figcaption { color: var(--muted); }
  figcaption { font-size: .9rem; margin-top: .4rem; }
  figure { margin: 0; }
  img { max-width: 100%; height: auto; border-radius: 8px; display: block; background: #fff; }
  .cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .75rem; margin: 1.25rem 0; }
  .card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: .7rem .9rem; }
  .card b { display: block; font-size: 1.3rem; font-variant-numeric: tabular-nums; }
  .card span { color: var(--muted); font-size: .85rem; }
  .right { color: #15803d; font-weight: 600; }
  .two { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1.25rem; }
  .scroll { overflow-x: auto; }
  table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: .92rem; }
  th, td { text-align: right; padding: .35rem .6rem; border-bottom: 1px solid var(--line); white-space: nowrap; }
  th:first-child, td:first-child { text-align: left; }
  th { color: var(--muted); font-weight: 500; }
  .bar { display: inline-block; height: .6rem; background: var(--accent); border-radius: 2px; vertical-align: middle; }
  td.wide { width: 45%; text-align: left; }
</style>
</head>
<body>
<h1>FastTree: $(get .build.scene)</h1>
<p class="muted">A kd-tree by the six steps of the FastTree paper, proved right and traced.
Version $(get .build.version), $(get .build.threads) threads, $(date -u '+%Y-%m-%d %H:%M') UTC.</p>

<div class="cards">
<div class="card"><b>$(show '.build.triangles | commas')</b><span>triangles</span></div>
<div class="card"><b>$(show '.build.build_ms | rounded(1)') ms</b><span>to build the tree</span></div>
<div class="card"><b>$(show '.build.nodes | commas')</b><span>nodes, depth $(get .build.quality.max_depth)</span></div>
<div class="card"><b>$(show '.build.quality.references_per_triangle | rounded(2)')</b><span>references a triangle</span></div>
<div class="card"><b>$(show '.verify.rays.rays | commas')</b><span>rays checked, $(show '.verify.rays.wrong | commas') wrong</span></div>
</div>

<figure>
$(picture picture.png png "The scene, drawn through its tree")
<figcaption>Drawn through the tree in $(show '.render.render_ms / 1000 | rounded(1)') s:
$(show '.render.primary.rays + .render.shadow.rays + .render.ao.rays | commas') rays,
$(show '.render.mrays_per_s | rounded(1)') million a second.</figcaption>
</figure>

<h2>Is it right?</h2>
<p><span class="right">$(show 'if .verify.ok then "Yes." else "No." end')</span>
$(show '.verify.invariants.checks | commas') facts about the tree and its mesh hold;
all ways to build it ($(show '.verify.bytes.compared_with | map(.builder) | join("; ")')) give the same bytes,
hash <code>$(get .build.tree_hash)</code>;
$(show '.verify.rays.rays | commas') rays, most of them made to meet planes, edges, vertices and corners exactly, were compared with
$(show 'if .verify.rays.oracle == "embree" then "Embree, and with a test of every triangle where the two differ" else "a test of every triangle" end'):
$(show '.verify.rays.wrong | commas') wrong.</p>

<h2>Where the time went</h2>
<div class="scroll"><table>
<tr><th>stage</th><th>ms</th><th></th></tr>
$(query "$jq_functions"'(.build.stages | map(.time_ms) | max) as $most | .build.stages[]
  | "<tr><td>\(.stage | @html)</td><td>\(.time_ms | rounded(2))</td><td class=\"wide\"><span class=\"bar\" style=\"width:\(
      if $most > 0 then .time_ms / $most * 100 | round else 0 end)%\"></span></td></tr>"')
</table></div>

<h2>What a ray costs, and what the tree looks like</h2>
<div class="two">
<figure>$(picture heat.png png "Cost a pixel")
<figcaption>Nodes and triangle tests of each pixel&#8217;s ray, $(show '.heat.mean_cost | rounded(1)') on average.</figcaption></figure>
<figure>$(picture leaves.png png "The leaves, cut by a plane")
<figcaption>The tree&#8217;s leaves cut by a plane, coloured by their number of triangles.</figcaption></figure>
</div>

<h2>Against the surface-area heuristic</h2>
<p>The same rays through the trees of all builders, each kind the fastest way; all find the same hits, to the bit.
Embree&#8217;s hierarchy is not a kd-tree and stands here as a yardstick.</p>
<div class="scroll"><table>
<tr><th>builder</th><th>build, ms</th><th>nodes</th><th>references a triangle</th><th>SAH cost</th><th>primary, Mray/s</th><th>shadow, Mray/s</th><th>diffuse, Mray/s</th></tr>
$(query "$jq_functions"'.compare.builders[]
  | "<tr><td>\(.builder | @html)</td><td>\(.build_ms | rounded(1))</td><td>\(if .quality then .quality.nodes | commas else "" end)</td><td>\(
      if .quality then .quality.references_per_triangle | rounded(2) else "" end)</td><td>\(
      if .quality then .quality.sah_cost | rounded(0) | tostring else "" end)</td><td>\(.primary.mrays_per_s | rounded(2))</td><td>\(
      .shadow.mrays_per_s | rounded(2))</td><td>\(.diffuse.mrays_per_s | rounded(2))</td></tr>"')
</table></div>

<h2>The commands</h2>
<pre><code>fasttree build  $(get '.build.source | sub(".*/"; "")') --out tree.ft
fasttree verify tree.ft --mesh $(get '.build.source | sub(".*/"; "")') --rays 100000
fasttree render tree.ft --mesh $(get '.build.source | sub(".*/"; "")') --out picture.png
fasttree compare $(get '.build.source | sub(".*/"; "")')</code></pre>
<p class="muted">All figures: <code>figures.json</code>. ${credit}</p>
</body>
</html>
EOF2
if [ -s "$broken" ]; then
  printf 'error: the summary lacks figures or pictures:\n%s\n' "$(cat "$broken")" >&2
  exit 1
fi
