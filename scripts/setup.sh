#!/usr/bin/env bash
# Checks that this Debian 12 machine has what paravent needs, and installs what is missing: as root
# or with a sudo that asks for no password. Otherwise it names the packages and stops with 3.
#   scripts/setup.sh        to build and run
#   scripts/setup.sh test   to test as well
set -euo pipefail

purpose="${1:-build}"
case "$purpose" in
build | test) ;;
*)
    echo "usage: scripts/setup.sh [build|test]" >&2
    exit 1
    ;;
esac

# Tools, as command:package. A tool that is there already is fine, wherever it came from.
tools=(gcc:gcc g++:g++ cmake:cmake ninja:ninja-build pkg-config:pkg-config)
# What programs link with or open at run time. Nothing else in this list depends on zlib1g-dev, which
# assimp's CMake package asks for, nor on libgl1-mesa-dri, which holds the software rasteriser.
packages=(libc6-dev zlib1g-dev libgl-dev libegl-dev libegl1 libosmesa6 libgl1-mesa-dri
    libtinygltf-dev nlohmann-json3-dev libassimp-dev libdraco-dev libmeshoptimizer-dev
    libopenimageio-dev libjemalloc-dev)
if [ "$purpose" = test ]; then
    tools+=(clang:clang clang-format:clang-format clang-tidy:clang-tidy node:nodejs npm:npm
        chromium:chromium)
    packages+=(libcmocka-dev libclang-rt-14-dev)
fi

missing=()
for tool in "${tools[@]}"; do
    command -v "${tool%%:*}" >/dev/null || missing+=("${tool#*:}")
done
if command -v dpkg-query >/dev/null; then
    installed="$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null ||
        true)"
    for package in "${packages[@]}"; do
        grep -qx "$package installed" <<<"$installed" || missing+=("$package")
    done
elif [ "${PARAVENT_NO_SETUP:-}" != 1 ]; then
    echo "setup: this is not Debian. Install what corresponds to these packages:" >&2
    echo "    ${tools[*]#*:} ${packages[*]}" >&2
    echo "then run again with PARAVENT_NO_SETUP=1" >&2
    exit 3
fi

if [ "${#missing[@]}" -gt 0 ]; then
    if [ "$(id -u)" = 0 ]; then
        as_root=(env)
    elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
        as_root=(sudo -n env)
    else
        echo "setup: these packages are missing, and only root may install them:" >&2
        echo "    apt-get update && apt-get install -y --no-install-recommends ${missing[*]}" >&2
        exit 3
    fi
    echo "setup: installing ${missing[*]}" >&2
    "${as_root[@]}" apt-get update -qq >&2
    "${as_root[@]}" DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
fi

# The Khronos glTF validator and engines of the web, as package-lock.json pins them.
node="$(cd "$(dirname "${BASH_SOURCE[0]}")/node" && pwd)"
if [ "$purpose" = test ] && ! cmp -s "$node/package-lock.json" "$node/node_modules/.installed"; then
    echo "setup: installing the glTF validator, three.js and Babylon.js for the tests" >&2
    (cd "$node" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2) || {
        echo "setup: npm cannot fetch them; is there a network?" >&2
        exit 3
    }
    cp "$node/package-lock.json" "$node/node_modules/.installed"
fi
