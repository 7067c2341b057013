#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails where clang-format 14 would change a source file, or where a file lacks its licence line.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/lib.sh

mapfile -t sources < <(find apps bench device fuzz include model render rtl scene src tests \
  -path '*/corpus/*' -prune -o \( -name '*.cpp' -o -name '*.h' -o -name '*.c' \) -print | sort)
bad=0
for file in "${sources[@]}"; do
  if ! head -n 1 "$file" | grep -q 'SPDX-License-Identifier: Apache-2.0'; then
    note "$file: the first line is not the licence line"
    bad=1
  fi
done

formatter=$(command -v clang-format-14 || command -v clang-format || true)
if [ -z "$formatter" ]; then
  note "clang-format is not here: formats are not checked (scripts/setup.sh --ci installs it)"
else
  for file in "${sources[@]}"; do
    if ! "$formatter" --dry-run -Werror --style=file "$file" 2>/dev/null; then
      note "$file: clang-format -i $file would change it"
      bad=1
    fi
  done
fi
if [ "$bad" -eq 0 ]; then note "${#sources[@]} files in order"; fi
exit "$bad"
