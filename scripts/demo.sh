#!/usr/bin/env bash
# Sets the machine up, builds a release, makes the occluder of a model, and judges it.
#   scripts/demo.sh [MODEL]    default: models/building_kaykit_a.glb
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

model="${1:-models/building_kaykit_a.glb}"
name="$(basename "${model%.*}")"
results=results/demo
log=build/logs/demo.log

scripts/setup.sh build
mkdir -p "$results" build/logs
echo "building (the first time takes a minute or two; output in $log)"
{
    if [ ! -f build/release/build.ninja ]; then
        cmake --preset release -DPARAVENT_TESTS=OFF
    fi
    cmake --build build/release --parallel "$(nproc)"
} >"$log" 2>&1 || {
    tail -n 40 "$log"
    echo "demo: the build failed; all of its output is in $log" >&2
    exit 1
}

paravent=build/release/apps/paravent/paravent
occluder="$results/${name}_occluder.glb"
stats="$results/${name}_stats.json"
picture="$results/${name}.png"
silhouettes="$results/${name}_silhouettes.png"
set -x
"$paravent" generate "$model" -o "$occluder" --budget 64 \
    --stats "$stats" --preview "$picture"
"$paravent" evaluate "$model" "$occluder" --silhouettes "$silhouettes"
{ set +x; } 2>/dev/null

echo
echo "the occluder:  $PWD/$occluder"
echo "its numbers:   $PWD/$stats"
echo "the picture:   $PWD/$picture"
echo "silhouettes:   $PWD/$silhouettes"
