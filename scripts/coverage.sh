#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Line and branch coverage of the library, the scene readers and the renderer by all tests but the
# large ones: a summary on the terminal, out/coverage/summary.txt, out/coverage/uncovered.txt (each
# line that no test reaches) and out/coverage/index.html.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

scripts/setup.sh --ci
say "Building with gcov's counters (build-coverage/)"
configure_and_build build-coverage all -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1" \
  -DFASTTREE_COVERAGE=ON -DFASTTREE_TESTS=ON -DFASTTREE_APPS=ON

say "Testing"
find build-coverage -name '*.gcda' -delete
failed=no
ctest --test-dir build-coverage --output-on-failure --parallel "$(build_jobs)" -LE large || failed=yes

say "Counting"
mkdir -p out/coverage
# Branches that only an exception of the standard library takes are left out: they are g++'s, not
# the source's.
common=(--root . --object-directory build-coverage --filter 'src/' --filter 'scene/'
        --filter 'render/' --exclude '.*_test\.cpp' --exclude '.*/test_[^/]*\.h'
        --exclude-throw-branches --exclude-unreachable-branches)
gcovr "${common[@]}" --html-details out/coverage/index.html --json out/coverage/coverage.json \
  --print-summary >out/coverage/totals.txt
gcovr --root . --add-tracefile out/coverage/coverage.json --txt out/coverage/lines.txt
gcovr --root . --add-tracefile out/coverage/coverage.json --branches --txt out/coverage/branches.txt
{
  echo "Lines"
  cat out/coverage/lines.txt
  echo
  echo "Branches"
  cat out/coverage/branches.txt
  echo
  cat out/coverage/totals.txt
} >out/coverage/summary.txt
jq -r '.files[] | .file as $f | .lines[] | select(.count == 0 and (."gcovr/noncode" | not))
       | "\($f):\(.line_number)"' out/coverage/coverage.json | while IFS=: read -r file line; do
  printf '%s:%s: %s\n' "$file" "$line" "$(sed -n "${line}{s/^ *//;p}" "$file")"
done >out/coverage/uncovered.txt
rm out/coverage/lines.txt out/coverage/branches.txt

cat out/coverage/totals.txt
note "out/coverage/summary.txt, out/coverage/uncovered.txt ($(wc -l <out/coverage/uncovered.txt)" \
     "lines), out/coverage/index.html"
[ "$failed" = no ] || fail "a test failed (see above); the coverage counts what it reached"
