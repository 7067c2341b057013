# SPDX-License-Identifier: Apache-2.0
# What the scripts share: messages, and one way to configure and build. Sourced by bash.

say() { printf '\n\033[1m==> %s\033[0m\n' "$*"; }
note() { printf '    %s\n' "$*"; }
fail() {
  printf '\nerror: %s\n' "$*" >&2
  exit 1
}

# Without a terminal the messages carry no colour codes.
if [ ! -t 1 ]; then
  say() { printf '\n==> %s\n' "$*"; }
fi

# How many compilers fit: one a processor, and no more than one a 1.5 GB of free memory (the
# vectorised files and the sanitizers need that much).
build_jobs() {
  local cpus memory
  cpus=$(nproc)
  memory=$(awk '/^MemAvailable:/ { print int($2 / 1500000) }' /proc/meminfo 2>/dev/null || true)
  if [ -n "$memory" ] && [ "$memory" -lt "$cpus" ]; then cpus=$memory; fi
  if [ "$cpus" -lt 1 ]; then cpus=1; fi
  echo "$cpus"
}

# configure_and_build FOLDER TARGET [CMAKE ARGUMENT...]: TARGET is a target's name, or "all".
configure_and_build() {
  local folder=$1 target=$2 log
  shift 2
  local arguments=(-G Ninja "$@")
  if command -v ccache >/dev/null 2>&1; then
    arguments+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
  fi
  mkdir -p "$folder"
  log=$folder/configure.log
  if ! cmake -S . -B "$folder" "${arguments[@]}" >"$log" 2>&1; then
    cat "$log" >&2
    fail "CMake could not configure $folder. A package may be missing (run scripts/setup.sh), or" \
         "the folder may stem from another place (remove it and start again)."
  fi
  cmake --build "$folder" --target "$target" --parallel "$(build_jobs)" ||
    fail "the build in $folder failed; the first error above says where."
}
