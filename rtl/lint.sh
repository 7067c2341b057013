#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every module of fasttree.f without a warning of Verilator, and the top level through Yosys'
# front end: both tools have to read the same files.
set -euo pipefail
cd "$(dirname "$0")"
mapfile -t files < <(grep -E '\.sv$' fasttree.f)
for file in "${files[@]}"; do
  module=$(basename "$file" .sv)
  [ "$module" = ft_pkg ] && continue
  verilator --lint-only -Wall --top "$module" waivers.vlt "${files[@]}"
done
echo "${#files[@]} files: no warnings"
if command -v yosys >/dev/null; then
  yosys -q -p "read_verilog -sv -D SYNTHESIS ${files[*]}; hierarchy -check -top fasttree_top; proc; check -assert"
  echo "Yosys reads fasttree_top"
else
  echo "Yosys is not here: not read by it"
fi
