#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes a report (fasttree reproduce all) from small scenes, one of them with a name full of HTML,
# and opens it in Chromium as wide as a screen and as a phone. Fails on script errors, on anything
# in the console, pictures that do not show, a page wider than the phone, a link to a section that
# is not there, any request, and where printing to PDF does not work. Pages with each of these
# faults come first: each has to be noticed.
#
#   scripts/check_report.sh [FOLDER]    FOLDER keeps the report, screenshots and the PDF
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

browser=$(command -v chromium || command -v chromium-browser || true)
[ -n "$browser" ] || fail "no Chromium here; scripts/setup.sh --ci installs it"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
keep=${1:-$work/keep}
mkdir -p "$keep"
keep=$(realpath "$keep")

# open PAGE FLAG...: what the browser says goes to $work/browser.log, its requests to $work/net.json.
open_page() {
  local page=$1
  shift
  rm -f "$work/net.json"
  timeout 120 "$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" \
    --no-first-run --disable-background-networking --disable-component-update --disable-sync \
    --disable-domain-reliability --disable-extensions --virtual-time-budget=10000 \
    --enable-logging=stderr --log-net-log="$work/net.json" "$@" "file://$page" 2>"$work/browser.log"
}

# Looks at the page from inside and tells the page around it. Put before the page's own policy,
# which would not let it run.
probe='<script>(() => {
  const faults = [], say = (text) => faults.push(text);
  addEventListener("error", (e) => say("error: " + (e.message || e.target.src || e.target.href)), true);
  addEventListener("securitypolicyviolation", (e) => say("request: " + e.blockedURI));
  addEventListener("load", () => {
    const root = document.documentElement, all = (s) => [...document.querySelectorAll(s)];
    if (root.scrollWidth > root.clientWidth) {
      const wide = all("body *").filter((e) => e.getBoundingClientRect().right > root.clientWidth + 1 && !e.closest(".scroll, pre"));
      say(`width: ${root.scrollWidth} in ${root.clientWidth}: ` + wide.slice(0, 3).map((e) => e.outerHTML.slice(0, 120)).join(" | "));
    }
    for (const i of all("img")) if (!i.complete || i.naturalWidth === 0) say("picture: " + i.alt);
    for (const i of all("img:not([alt]), img[alt=\"\"], svg[role=img]:not([aria-label])")) say("no text: " + i.outerHTML.slice(0, 80));
    for (const t of all("th:not([scope])")) say("no scope: " + t.textContent);
    for (const a of all("a[href^=\"#\"]")) if (!document.getElementById(a.getAttribute("href").slice(1))) say("link: " + a.getAttribute("href"));
    const ids = all("[id]").map((e) => e.id);
    for (const id of ids.filter((id, i) => ids.indexOf(id) !== i)) say("twice: " + id);
    for (const r of performance.getEntriesByType("resource")) if (!r.name.startsWith("data:")) say("request: " + r.name);
    if (/\b(NaN|nan|inf|undefined)\b/.test(document.body.innerText)) say("no number: " + document.body.innerText.match(/.{0,40}\b(NaN|nan|inf|undefined)\b/)[0]);
    parent.postMessage({name: window.name, faults}, "*");
  });
})()</script>'

# host NAME=PAGE@WIDTH...: a page with each of the pages in a frame of that width, probed. What they
# found comes out as lines "NAME: FAULT", with "NAME: looked at" after them.
host() {
  local frames="" entry name page width
  for entry in "$@"; do
    name=${entry%%=*} page=${entry#*=} width=${entry##*@}
    page=${page%@*}
    probe=$probe awk '!done && (at = index($0, "<head>")) {
        print substr($0, 1, at + 5) ENVIRON["probe"] substr($0, at + 6); done = 1; next
      } { print }' "$page" >"$work/probed_$name.html"
    frames+="<iframe name=\"$name\" src=\"probed_$name.html\" width=\"$width\" height=\"800\"></iframe>"
  done
  cat >"$work/host.html" <<END
<!DOCTYPE html><html><head><meta charset="utf-8"></head><body><pre id="found"></pre><script>
addEventListener("message", (e) => {
  document.getElementById("found").textContent += e.data.faults.concat("looked at").map((f) => e.data.name + ": " + f.replace(/\s+/g, " ") + "\n").join("");
});
</script>$frames</body></html>
END
  open_page "$work/host.html" --window-size=1400,900 --dump-dom >"$work/dom.html" ||
    fail "Chromium failed: $(tail -n 5 "$work/browser.log")"
  sed -n '/<pre id="found">/,/<\/pre>/p' "$work/dom.html" | sed 's/.*<pre id="found">//; s/<\/pre>.*//' | grep . || true
}

bad=0
complain() {
  note "$*"
  bad=1
}

console() { grep 'CONSOLE' "$work/browser.log" || true; }
# Of pages: what the browser asks for on its own account has no origin.
requests() {
  grep '"initiator":' "$work/net.json" | grep -v '"initiator":"not an origin"' |
    grep -oE '"url":"(https?|wss?|ftp)://[^"]*"' | sort -u || true
}

say "Faults that have to be noticed"
plant() { printf '<!DOCTYPE html><html><head><title>t</title></head><body>%s</body></html>\n' "$2" >"$work/plant_$1.html"; }
plant fine '<h1 id="a">t</h1><a href="#a">a</a>'
plant error '<script>nothing.at.all()</script>'
plant picture '<img alt="broken" width="9" height="9" src="data:image/png;base64,AAAA">'
plant width '<div style="width: 600px">wide</div>'
plant link '<a href="#nowhere">nowhere</a>'
plant request '<img alt="far" src="http://127.0.0.1:9/x.png">'
plant number '<p>takes nan ms</p>'
plant scope '<table><tr><th>t</th></tr></table>'
pages=()
for page in "$work"/plant_*.html; do
  name=$(basename "$page" .html)
  pages+=("${name#plant_}=$page@390")
done
found=$(host "${pages[@]}")
for name in error picture width link request number scope; do
  grep -qE "^$name: (error|picture|width|link|request|no number|no scope):" <<<"$found" ||
    complain "the planted fault '$name' was not noticed"
done
[ "$(grep '^fine: ' <<<"$found")" = "fine: looked at" ] || complain "a fault was seen in a page without any"
[ -n "$(console)" ] || complain "a planted line in the console was not noticed"
[ -n "$(requests)" ] || complain "a planted request was not noticed"

say "The report"
configure_and_build build fasttree_app -DCMAKE_BUILD_TYPE=Release >/dev/null
nasty=$work/'<b onclick="x">&amp;.obj'
cp docs/examples/five_triangles.obj "$nasty"
build/apps/fasttree/fasttree reproduce all --quick --scene scene:knot:3k --scene scene:hall:3k \
  --scene "$nasty" --out "$keep" --quiet
page=$keep/report.html
found=$(host "phone=$page@390" "small=$page@320" "screen=$page@1280")
for name in phone small screen; do
  grep -qx "$name: looked at" <<<"$found" || complain "$name: the page did not come up"
done
while read -r line; do complain "$line"; done < <(grep -v ': looked at$' <<<"$found" || true)
while read -r line; do complain "console: $line"; done < <(console)
while read -r line; do complain "requested: $line"; done < <(requests)

say "On paper, and as pictures"
open_page "$page" --no-pdf-header-footer --print-to-pdf="$keep/report.pdf" || complain "printing failed"
sheets=$(grep -aoE '/Type ?/Page\b' "$keep/report.pdf" | wc -l || true)
note "$sheets sheets of paper"
[ "$sheets" -ge 7 ] || complain "fewer sheets of paper than six breaks between them give"
open_page "$page" --window-size=1280,4000 --screenshot="$keep/screen.png" || complain "no screenshot"
# Windows are not as narrow as a phone; a frame is.
printf '<!DOCTYPE html><body style="margin: 0"><iframe width="390" height="6000" src="%s"></iframe>' \
  "file://$page" >"$work/phone.html"
open_page "$work/phone.html" --window-size=500,6000 --screenshot="$keep/phone.png" ||
  complain "no screenshot"
for picture in screen phone; do
  [ "$(stat -c %s "$keep/$picture.png")" -gt 20000 ] || complain "the picture $picture.png is empty"
done

[ "$bad" -eq 0 ] && note "the report is in order"
exit "$bad"
