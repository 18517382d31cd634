#!/usr/bin/env bash
# Every glTF that comes out passes the Khronos validator with no error and no warning.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ -d "$PVT_NODE_MODULES/gltf-validator" ] ||
    skip "no glTF validator in $PVT_NODE_MODULES; scripts/setup.sh test installs it"

for model in "$models"/*.glb; do
    name="$(basename "$model" .glb)"
    for format in glb gltf; do
        paravent generate "$model" -o "$name.$format" --resolution 32 --tolerance 1vx --budget 40 \
            --views "$here/one_view.txt" --effort fast
        holds "$name: exit $code" test "$code" = 0 -o "$code" = 5
    done
done
expect 0 "" generate "$models/boulder.glb" -o one.glb "${quick[@]}" --budget 1
expect 0 "" generate "$models/boulder.glb" -o planar.glb --resolution 32 --budget 12 \
    --effort fast
expect 0 "" generate "$models/sheet.glb" -o godot.gltf "${quick[@]}" --terrain --convention godot
cp "$models/boulder.glb" $'q"\xc3\xa4.glb'
expect 0 "" generate $'q"\xc3\xa4.glb' -o name.glb "${quick[@]}"
rm $'q"\xc3\xa4.glb'
checks=$((checks + 1))
NODE_PATH="$PVT_NODE_MODULES" node "$here/validate.cjs" ./*.glb ./*.gltf || fail "the validator"

# And what was written can be read again.
for format in glb gltf obj ply; do
    expect 0 "" generate "$models/boulder.glb" -o "again.$format" "${quick[@]}"
    paravent generate "again.$format" -o thrice.glb "${quick[@]}" --resolution 64 --tolerance 1vx
    holds "again.$format is read: $(cat err)" test "$code" = 0 -o "$code" = 5
done
finish
