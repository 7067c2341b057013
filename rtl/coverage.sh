#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Line and toggle coverage of the RTL by the tests of its units (rtl_units_test), as Verilator counts
# it: a table by module, and out/rtl-coverage/uncovered.txt, each branch that is never taken and each
# signal that never changes. A module counts where any of its instances, of any parameters, gets there.
#
#   rtl/coverage.sh [TEST...]    default: all; TEST is a pattern of CTest's, say RtlBus
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

tests='^Rtl'
if [ $# -gt 0 ]; then tests=$(IFS='|'; echo "^($*)"); fi
export FASTTREE_RTL_COVERAGE=$PWD/out/rtl-coverage
mkdir -p "$FASTTREE_RTL_COVERAGE"
rm -f "$FASTTREE_RTL_COVERAGE"/*

say "Building with Verilator's counters (build-rtl-coverage/)"
configure_and_build build-rtl-coverage rtl_units_test -DFASTTREE_TESTS=ON -DFASTTREE_RTL_TOPS=OFF \
  -DFASTTREE_RTL_COVERAGE=ON >"$FASTTREE_RTL_COVERAGE/build.log"

say "Testing"
ctest --test-dir build-rtl-coverage --parallel "$(build_jobs)" -R "$tests" -E '^RtlMachine' \
  --output-on-failure >"$FASTTREE_RTL_COVERAGE/tests.log" || fail "a test failed: out/rtl-coverage/tests.log"

verilator_coverage --write "$FASTTREE_RTL_COVERAGE/all.dat" "$FASTTREE_RTL_COVERAGE"/[0-9]*.dat
python3 - "$FASTTREE_RTL_COVERAGE" <<'PYTHON'
import collections, os, re, sys

folder = sys.argv[1]
points = collections.defaultdict(int)  # of a file: (kind, line, what), over instances and parameters
for line in open(f"{folder}/all.dat", errors="replace"):
    found = re.match(r"C '(.*)' (\d+)$", line)
    if not found:
        continue
    key = dict(part.split("\2", 1) for part in found[1].split("\1") if "\2" in part)
    kind = key["page"].split("/")[0][2:]
    points[os.path.basename(key["f"]), kind, int(key["l"]), key["o"]] += int(found[2])
sources = {os.path.basename(name): name for name in open("rtl/fasttree.f").read().split() if ".sv" in name}
totals = collections.Counter()
with open(f"{folder}/uncovered.txt", "w") as uncovered:
    for (file, kind, line, what), count in sorted(points.items()):
        text = open(f"rtl/{sources[file]}").read().splitlines()[line - 1].strip()
        totals[file, kind] += 1
        totals[file, kind, "covered"] += count > 0
        if count == 0:
            uncovered.write(f"{sources[file]}:{line}: {kind} {what}: {text}\n")
print("| module | lines | toggles |\n| --- | --- | --- |")
def share(files, kind):
    covered = sum(totals[f, kind, "covered"] for f in files)
    total = sum(totals[f, kind] for f in files)
    return f"{covered} of {total}" if total else "-"
files = sorted({file for file, *_ in points})
for file in files:
    print(f"| `{file[:-3]}` | {share([file], 'line')} | {share([file], 'toggle')} |")
print(f"| all | {share(files, 'line')} | {share(files, 'toggle')} |")
PYTHON
