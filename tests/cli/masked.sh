#!/usr/bin/env bash
# What does not block the view: a chain-link fence and leaf cards hide nothing through their holes,
# and are judged with them. Taken as opaque, the very same would hide what can be seen.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the results"

fast=(--effort fast --budget 24)
quick=(--views 24 --quads 2000 --pixels 256)
check() {
    holds "masked.mjs $*" node "$here/masked.mjs" "$@"
}

# The fence's cards are closed all around: as walls they have an inside. Where its wires are wide
# enough for panels, these lie on them.
for resolution in 64 256; do
    expect 0 "" generate "$models/fence.glb" -o fence.glb "${fast[@]}" --resolution "$resolution"
    expect 0 "" evaluate "$models/fence.glb" fence.glb "${quick[@]}" --json fence.json
    check score fence.json uniform.precision 1 1
    check score fence.json small.precision 1 1
    # A panel ends where a wire does: corners that are rounded for the screen may cost a pixel.
    check score fence.json over_area 0 0.0001
    check score fence.json uniform.recall 0.4 1
done
expect 0 "" generate "$models/fence.glb" -o wall.glb "${fast[@]}" --masked opaque
expect 0 "" evaluate "$models/fence.glb" wall.glb "${quick[@]}" --json wall.json
check score wall.json uniform.precision 0 0.5
check score wall.json original.triangles 1000 1000000
expect 0 "" evaluate "$models/fence.glb" wall.glb "${quick[@]}" --masked opaque --json wall.json
check score wall.json uniform.precision 1 1
check score wall.json original.triangles 24 24
expect 0 "1 primitives with a masked material were left out" \
    evaluate "$models/fence.glb" wall.glb "${quick[@]}" --masked skip --json wall.json
check score wall.json original.triangles 20 20

# A crown that is closed but for its texture: the occluder is the trunk's, and may lie on what of the
# leaves is opaque.
expect 0 "" generate "$models/leafy_tree.glb" -o tree.glb "${fast[@]}" --resolution 128 --threads 1
cp tree.glb one.glb
expect 0 "" generate "$models/leafy_tree.glb" -o tree.glb "${fast[@]}" --resolution 128 --threads 3
holds "the bytes do not depend on the threads" cmp tree.glb one.glb
expect 0 "" evaluate "$models/leafy_tree.glb" tree.glb "${quick[@]}" --json tree.json
check score tree.json uniform.precision 0.9999 1
check score tree.json small.precision 0.9999 1
check score tree.json uniform.recall 0.3 1
expect 0 "" generate "$models/leafy_tree.glb" -o cube.glb "${fast[@]}" --masked opaque \
    --resolution 128
expect 0 "" evaluate "$models/leafy_tree.glb" cube.glb "${quick[@]}" --json cube.json
check score cube.json uniform.precision 0 0.7

# Without the image the option decides, and the reason is told.
check image "$models/leafy_tree.glb" bare.glb gone.png
expect 0 'bare.glb: images[0]: "gone.png" cannot be read' \
    generate bare.glb -o bare_tree.glb "${fast[@]}" --resolution 128
holds "what becomes of it is told" grep -q -- "--masked opaque keeps them" err
expect 0 "" generate "$models/leafy_tree.glb" -o skipped.glb "${fast[@]}" --resolution 128 \
    --masked skip
holds "auto without the image is skip" node -e '
    const read = (f) => { const b = require("fs").readFileSync(f);
        return b.subarray(28 + b.readUInt32LE(12)); };
    process.exit(read("bare_tree.glb").equals(read("skipped.glb")) ? 0 : 1)'
expect 0 "" generate bare.glb -o bare_cube.glb "${fast[@]}" --resolution 128 --masked opaque
holds "opaque needs no image" test ! -s <(grep gone err)

# Nothing but a mask, all of it too fine: no broken file, but nothing to occlude with.
expect 5 "no part of its masked surfaces is opaque" \
    generate "$models/fence.glb" -o none.glb --node fence --resolution 16
expect 1 "--masked" generate "$models/fence.glb" -o none.glb --masked maybe
expect 1 "--masked" evaluate "$models/fence.glb" wall.glb --masked maybe
finish
