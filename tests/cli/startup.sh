#!/usr/bin/env bash
# `paravent --version` is quick, and loads neither graphics nor image libraries.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

LD_DEBUG=libs "$PARAVENT" --version >out 2>loaded
holds "--version runs under LD_DEBUG" grep -q "^paravent " out
holds "the loader told what it did" grep -q "libc.so" loaded
checks=$((checks + 1))
if grep -oE 'lib(GL|EGL|OSMesa|GLX|gallium|OpenImageIO|OpenEXR|paravent_image)[^ /]*' loaded |
    sort -u >heavy && [ -s heavy ]; then
    fail "--version loads $(tr '\n' ' ' <heavy)"
fi

# Processor time, and the best of some runs: the machine may be busy with others.
TIMEFORMAT="%U %S"
best=1000000
for _ in $(seq 20); do
    { time "$PARAVENT" --version >out; } 2>took
    read -r user system <took
    took=$((10#${user/[.,]/} + 10#${system/[.,]/}))
    best=$((took < best ? took : best))
done
echo "--version takes $best ms"
if [ "${PVT_SANITIZED:-}" != 1 ]; then
    holds "--version takes $best ms; at most 20" test "$best" -le 20
fi
finish
