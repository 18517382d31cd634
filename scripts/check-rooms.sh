#!/usr/bin/env bash
# The rules of the house that a compiler does not check:
#   who may include whom, C++ only in lib/io, functions of at most 80 lines, files of at most 700,
#   no mutable globals (in the object files of the build tree given, or build/release).
#   scripts/check-rooms.sh [BUILD]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build="${1:-build/release}"
failures=0

fail() {
    echo "rooms: $*" >&2
    failures=$((failures + 1))
}

# Which rooms each room may look into. Public headers and a room's own files follow the same rule.
allowed() {
    case "$1" in
    base) echo "base" ;;
    mesh) echo "base mesh" ;;
    voxel) echo "base mesh voxel" ;;
    section) echo "base mesh voxel section" ;;
    occlusion) echo "base mesh occlusion" ;;
    occluder) echo "base mesh voxel section occlusion evaluate occluder" ;;
    separate) echo "base mesh voxel section occlusion occluder separate" ;;
    evaluate) echo "base mesh occlusion evaluate" ;;
    ladder) echo "base mesh voxel section occlusion occluder evaluate ladder" ;;
    gl) echo "base mesh voxel section occlusion gl" ;;
    io) echo "base mesh io" ;;
    *) echo "" ;;
    esac
}

# The room that a header below include/paravent belongs to.
room_of_header() {
    case "$1" in
    image | output) echo base ;;
    *) echo "$1" ;;
    esac
}

check_include() { # file, its room, the room that it includes
    case " $(allowed "$2") " in
    *" $3 "*) ;;
    *) fail "$1 includes $3, which room $2 may not know" ;;
    esac
}

check_includes() {
    local file room line target
    while IFS=: read -r file line; do
        case "$file" in
        lib/include/paravent/paravent.h) continue ;;
        lib/include/paravent/*) room="$(room_of_header "$(basename "$file" .h)")" ;;
        *) room="$(cut -d/ -f2 <<<"$file")" ;;
        esac
        target="$(sed -E 's/^[^<"]*[<"]([^>"]*)[>"].*/\1/' <<<"$line")"
        case "$target" in
        paravent/paravent.h) fail "$file includes paravent.h, which is for users" ;;
        paravent/*) check_include "$file" "$room" "$(room_of_header "$(basename "$target" .h)")" ;;
        */*)
            if [ -d "lib/${target%%/*}" ]; then
                check_include "$file" "$room" "${target%%/*}"
            fi
            ;;
        esac
    done < <(grep -rHE '^ *# *include' lib --include='*.h' --include='*.c' --include='*.cpp' \
        --include='*.hpp')

    # The command is a user: public headers, and its own.
    while IFS=: read -r file line; do
        target="$(sed -E 's/^[^<"]*[<"]([^>"]*)[>"].*/\1/' <<<"$line")"
        if [ -d "lib/${target%%/*}" ] && [ "${target%%/*}" != "$target" ]; then
            fail "$file includes $target, which is the library's own"
        fi
    done < <(grep -rHE '^ *# *include "' apps --include='*.h' --include='*.c')
}

# Draco has an encoder in C++ alone, which makes what its tests read.
check_languages() {
    local file
    while read -r file; do
        fail "$file is C++; only lib/io, the tests of the package and draco_encoder may be"
    done < <(find lib apps tests -type f \
        \( -name '*.cpp' -o -name '*.cc' -o -name '*.cxx' -o -name '*.hpp' \) \
        -not -path 'lib/io/*' -not -path 'tests/package/*' -not -path 'tests/fuzz/*' \
        -not -path 'tests/unit/draco_encoder.cpp')
}

# clang-format puts the braces of a function's body, and of nothing else but namespaces and
# classes, into the first column.
check_lengths() {
    local text
    text="$(find lib apps tests -type f \
        \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' \) -print0 |
        sort -z | xargs -0 awk '
        FNR == 1 {
            if (lines > 700) print last ": " lines " lines; a file has at most 700"
            start = 0; before = ""
        }
        { lines = FNR; last = FILENAME }
        /^\{/ && before !~ /^(namespace|class)/ { start = FNR }
        /^\}/ && start {
            if (FNR - start - 1 > 80)
                print FILENAME ":" start ": " FNR - start - 1 " lines; a function has at most 80"
            start = 0
        }
        /[^ ]/ { before = $0 }
        END { if (lines > 700) print last ": " lines " lines; a file has at most 700" }')"
    if [ -n "$text" ]; then
        while read -r line; do
            fail "$line"
        done <<<"$text"
    fi
}

# Symbols in sections that can be written, other than those that the loader alone writes. The unit
# that holds tinygltf, and what the C++ library puts into every unit, are not ours to judge.
check_globals() {
    local text
    if ! compgen -G "$build/lib/*.a" >/dev/null; then
        echo "rooms: no libraries in $build/lib: globals are not checked" >&2
        return
    fi
    text="$(for library in "$build"/lib/*.a; do
        objdump -t "$library" | awk -v library="$(basename "$library")" '
            / file format / { object = $1; sub(/:$/, "", object) }
            object ~ /tinygltf/ { next }
            $NF ~ /^(_ZStL8__ioinit|_ZGV|DW\.ref)/ { next }
            {
                for (i = 2; i < NF; ++i) {
                    if ($i ~ /^(\.data|\.bss|\.tdata|\.tbss|\*COM\*)/ &&
                        $i !~ /^\.data\.rel\.ro/ && $NF != $i)
                        print library "(" object "): " $NF " in " $i " can be written"
                }
            }'
    done)"
    if [ -n "$text" ]; then
        while read -r line; do
            fail "$line"
        done <<<"$text"
    fi
}

check_includes
check_languages
check_lengths
check_globals
if [ "$failures" -gt 0 ]; then
    echo "rooms: $failures broken rules" >&2
    exit 1
fi
echo "rooms: in order"
