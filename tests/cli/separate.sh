#!/usr/bin/env bash
# --separate: an occluder a mesh node, shared by the nodes of a mesh.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to look into the files"

cp "$models/yard.glb" yard.glb
small=(--separate --views "$here/one_view.txt" --resolution 24 --effort fast)

# Names, sharing and transforms; what has no inside is told and left out.
expect 0 '"banner": no occluder: ' generate yard.glb -o shared.glb "${small[@]}" --stats stats.json
holds "nodes share their meshes" node "$here/separate.mjs" yard.glb shared.glb shared
holds "the stats are in order" node "$here/stats.mjs" stats.json
holds "a node has no occluder" test "$(stat_of stats.json nodes_without)" = 1
holds "two occluders were made, each once" test \
    "$(stat_of stats.json occluders.0.nodes)/$(stat_of stats.json occluders.1.nodes)" = 3/3
holds "the budget is 16 a node with an inside" test "$(stat_of stats.json options.budget)" = 96
expect 0 "" generate yard.glb -o moved.glb "${small[@]}" --convention godot
holds "Godot's occluders stand without transforms" node "$here/separate.mjs" yard.glb moved.glb moved

# All of them hide nothing that can be seen, in whatever file they stand.
for format in glb gltf obj ply; do
    expect 0 "" generate yard.glb -o "all.$format" "${small[@]}"
    expect 0 "" evaluate yard.glb "all.$format" --views 24 --quads 1000 --json scores.json
    holds "$format: precision is 1" test \
        "$(stat_of scores.json occluders.0.uniform.precision)" = 1
    holds "$format: nothing sticks out" test "$(stat_of scores.json occluders.0.over_area)" = 0
    recall="$(stat_of scores.json occluders.0.uniform.recall)"
    holds "$format: recall is $recall" awk -v recall="$recall" 'BEGIN { exit !(recall > 0.2) }'
    rm scores.json
done
holds "an object a node" test "$(grep -c '^o ' all.obj)" = 6
expect 0 "" generate yard.glb -o all.tscn "${small[@]}"
holds "a node of Godot a node" test "$(grep -c 'type="OccluderInstance3D"' all.tscn)" = 6
if [ -d "$PVT_NODE_MODULES/gltf-validator" ]; then
    NODE_PATH="$PVT_NODE_MODULES" holds "the validator finds nothing" \
        node "$here/validate.cjs" shared.glb moved.glb all.gltf
fi

# The budget is that of all nodes as drawn, whatever it is.
for budget in 3 7 12 40 300; do
    expect 0 "" generate yard.glb -o budget.glb "${small[@]}" --budget "$budget" --stats stats.json
    holds "a budget of $budget holds: $(stat_of stats.json triangles)" test \
        "$(stat_of stats.json triangles)" -le "$budget"
    holds "and is named" test "$(stat_of stats.json options.budget)" = "$budget"
done
expect 0 "is used up before its 3 instances; --budget 12 has two for every instance" \
    generate yard.glb -o budget.glb "${small[@]}" --budget 8
expect 5 "yard.glb: none of the 3 meshes gets an occluder; of the first, \"tower\" and 2 more of its mesh: the budget of 2" \
    generate yard.glb -o none.glb "${small[@]}" --budget 2
expect 5 "sheet.glb: \"sheet\": " generate "$models/sheet.glb" -o none.glb "${small[@]}" --method paper --tolerance 0
expect 0 "" generate "$models/sheet.glb" -o terrain.glb "${small[@]}" --terrain

# Side by side or one by one: the same bytes.
for threads in 1 2 5; do
    expect 0 "" generate "$models/house.glb" -o "threads-$threads.glb" "${small[@]}" --ground --threads "$threads"
    expect 0 "" generate yard.glb -o "yard-$threads.glb" "${small[@]}" --threads "$threads"
done
for threads in 2 5; do
    holds "house on 1 and $threads threads" cmp threads-1.glb "threads-$threads.glb"
    holds "yard on 1 and $threads threads" cmp yard-1.glb "yard-$threads.glb"
done

# The other options go along with it.
expect 6 "the memory limit" generate yard.glb -o limit.glb "${small[@]}" --resolution 2048 --memory-limit 4M
expect 0 "" generate yard.glb -o error.glb "${small[@]}" --resolution 24 --deadline 0.01 --stats stats.json
expect 0 "" generate yard.glb -o node.glb "${small[@]}" --node tower_2 --stats stats.json
holds "--node takes a part" test "$(stat_of stats.json nodes)" = 1
expect 0 "" generate yard.glb -o error.glb --separate --views above --effort fast --error 0.4 --stats stats.json
holds "the error holds for the largest instance: $(stat_of stats.json error_bound)" \
    awk -v bound="$(stat_of stats.json error_bound)" 'BEGIN { exit !(bound <= 0.4 && bound > 0.399) }'
paravent generate yard.glb -o picture.glb "${small[@]}" --preview picture.png
holds "a preview of all, or no graphics: $(cat err)" test "$code" = 0 -o "$code" = 3
[ "$code" != 0 ] || holds "it has bytes" test -s picture.png
finish
