#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is needed (Debian packages), builds in Release and runs all tests.
#
#   ./test.sh [CTEST ARGUMENT...]      for example: ./test.sh -R grid, ./test.sh -LE large
set -euo pipefail
cd "$(dirname "$0")"
. scripts/lib.sh

scripts/setup.sh --test

say "Building (Release, build/)"
configure_and_build build all -DCMAKE_BUILD_TYPE=Release -DFASTTREE_TESTS=ON -DFASTTREE_APPS=ON

say "Testing"
# Some tests are parallel themselves; the machine is shared fairly all the same.
ctest --test-dir build --output-on-failure --parallel "$(build_jobs)" "$@"
