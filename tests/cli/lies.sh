#!/usr/bin/env bash
# Files that lie about their counts, ranges or compression: the exit code, the file and the place.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

command -v node >/dev/null || skip "there is no node to write the files"
node "$here/lies.mjs" "$scratch" || exit 1
if [ -z "${PVT_DRACO:-}" ]; then
    sed -i '/^[0-9]*\tdraco/d' list
fi
while IFS=$'\t' read -r wanted file text; do
    expect "$wanted" "$text" generate "$file" -o out.glb "${quick[@]}"
    if [ "$wanted" = 0 ]; then
        holds "$file is read" test -s out.glb
        rm -f out.glb
    else
        holds "the message names $file" grep -qF "$file" err
        holds "nothing is left of $file" test ! -e out.glb
    fi
done <list

# A program that was put elsewhere finds no decoder beside it, unless one is installed.
if [ -e "${PVT_INSTALLED:-/none}/paravent-draco" ]; then
    finish
    exit 0
fi
mkdir elsewhere
cp "$PARAVENT" elsewhere/paravent
PARAVENT="$scratch/elsewhere/paravent"
expect 3 "PARAVENT_DRACO=ON" generate draco.gltf -o out.glb "${quick[@]}"
holds "the extension is named" grep -qF KHR_draco_mesh_compression err
expect 0 "the uncompressed copy beside it is taken" generate draco_beside_plain.gltf -o out.glb \
    "${quick[@]}"
holds "what is there uncompressed is read" test -s out.glb
finish
