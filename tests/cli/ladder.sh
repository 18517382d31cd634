#!/usr/bin/env bash
# `paravent ladder`: levels whose errors grow and whose triangles fall, in both namings, with the
# original or without, and every contradiction refused by the option's name.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the stats"

boulder="$models/boulder.glb"
few=(--views "$here/one_view.txt" --effort fast)
small=("${few[@]}" --errors 0.3,0.5,0.9 --budgets 12,8,4)

# checked FILE WHAT: ladder.mjs finds that the file is what it should be.
checked() {
    checks=$((checks + 1))
    node "$here/ladder.mjs" "$@" || fail "ladder.mjs $*"
}

# The defaults: four levels, from the resolution on.
expect 0 "LOD3" ladder "$boulder" -o four.glb --resolution 64 "${few[@]}" --stats four.json
checked four.glb msft four.json 4
expect 0 "" ladder "$boulder" -o lists.glb "${small[@]}" --stats lists.json
checked lists.glb msft lists.json 3
expect 0 "" ladder "$boulder" -o plain.gltf --naming suffix "${small[@]}" --stats plain.json
checked plain.gltf suffix plain.json 3
expect 0 "" ladder "$boulder" -o one.glb --levels 1 --resolution 32 "${few[@]}" --stats one.json
checked one.glb suffix one.json 1
finish
