#!/usr/bin/env bash
# Checks that every C and C++ file is as clang-format would write it; --fix writes them so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case "${1:-}" in
"") options=(--dry-run -Werror) ;;
--fix) options=(-i) ;;
*)
    echo "usage: scripts/format.sh [--fix]" >&2
    exit 1
    ;;
esac

find lib apps tests -type f \
    \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' \) -print0 |
    sort -z | xargs -0 clang-format --style=file "${options[@]}"

# What clang-format does not look at: line ends, trailing blanks and the last line feed of scripts.
bad="$(find scripts cmake .ci lib apps tests shaders -type f \
    \( -name '*.sh' -o -name '*.cmake' -o -name CMakeLists.txt -o -name '*.in' -o -name '*.frag' \
    -o -name '*.vert' -o -name run \) -not -path '*/node_modules/*' -print0 |
    xargs -0 grep -lE $'[ \t\r]+$' || true)"
if [ -n "$bad" ]; then
    echo "blanks at the end of lines in: $bad" >&2
    exit 1
fi
