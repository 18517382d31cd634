#!/usr/bin/env bash
# Runs clang-tidy over the library and the command, on all cores.
#   scripts/tidy.sh [FILE...]   default: all of lib/ and apps/
# Needs a build tree with compile commands: build/release, or the one that BUILD names.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build="${BUILD:-build/release}"
if [ ! -f "$build/compile_commands.json" ]; then
    echo "tidy: no $build/compile_commands.json; run: cmake --preset release" >&2
    exit 1
fi
if [ "$#" -gt 0 ]; then
    files=("$@")
else
    mapfile -t files < <(find lib apps -type f \( -name '*.c' -o -name '*.cpp' \) | sort)
fi
# Only what is compiled here: a build may leave gl and io out.
compiled=()
for file in "${files[@]}"; do
    if grep -qF "\"file\": \"$PWD/$file\"" "$build/compile_commands.json"; then
        compiled+=("$file")
    fi
done
if [ "${#compiled[@]}" = 0 ]; then
    echo "tidy: none of these files is compiled in $build" >&2
    exit 1
fi
# One file a process: the slowest file, not the sum, is what one waits for.
check() {
    local assume=(--extra-arg=-include --extra-arg="$PWD/scripts/analyzer.h"
        --extra-arg="-I$PWD/lib")
    case "$2" in
    lib/base/context.c | *.cpp) assume=() ;;
    esac
    # Assertions tell the analyzer what holds, in a release's flags too.
    clang-tidy -p "$1" --quiet --extra-arg=-UNDEBUG "${assume[@]}" "$2" 2>/dev/null
}
export -f check
printf '%s\0' "${compiled[@]}" | xargs -0 -n 1 -P "$(nproc)" bash -c 'check "$0" "$1"' "$build"
echo "tidy: ${#compiled[@]} files"
