#!/usr/bin/env bash
# What goes to Godot: text scenes, and the names that its import of glTF acts on.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the scenes"

# scene NAME ARGUMENT…: the scene of a run holds what the model of the same run holds; without a
# name the nodes are called as the model's are.
scene() {
    local name="$1"
    shift
    checks=$((checks + 1))
    expect 0 "" generate "$@" -o scene.tscn
    expect 0 "" generate "$@" -o model.glb
    node "$here/tscn.mjs" scene.tscn model.glb ${name:+"$name"} 2>problems ||
        fail "$*: $(cat problems)"
}

# occluders ARGUMENT…: Godot's import makes occluders of the model's nodes.
occluders() {
    checks=$((checks + 1))
    expect 0 "" generate "$@" -o model.glb --convention godot
    node "$here/occonly.mjs" model.glb 2>problems || fail "$*: $(cat problems)"
}

scene boulder_occluder "$models/boulder.glb" "${quick[@]}"
scene boulder-occonly "$models/boulder.glb" "${quick[@]}" --convention godot
scene house_occluder "$models/house.glb" --ground --resolution 64 --budget 64 --effort fast
odd=$'a"b:c%d\\e@f\n[g];=.v2.glb'
cp "$models/boulder.glb" "$odd"
scene $'a_b_c_d\\e_f_[g];=_v2_occluder' "$odd" "${quick[@]}"
rm "$odd"
paravent generate "$models/boulder.glb" "${quick[@]}" -o again.tscn --threads 1
paravent generate "$models/boulder.glb" "${quick[@]}" -o scene.tscn
holds "the same bytes for any number of threads" cmp scene.tscn again.tscn

# The import takes "$word" anywhere in a name for a suffix, and "$noimp" drops the node.
mkdir in
for name in 'a$noimp' 'b$colonly_c' 'noimp-colonly' 'c.v2'; do
    cp "$models/boulder.glb" "in/$name.glb"
    occluders "in/$name.glb" "${quick[@]}"
done
rm -r in

# Instances share what they can, in their places; for the import they are moved there.
apart=("$models/yard.glb" --separate --views "$here/one_view.txt" --resolution 24 --effort fast)
scene "" "${apart[@]}"
holds "instances have places" grep -q '^transform = Transform3D(' scene.tscn
scene "" "${apart[@]}" --convention godot
occluders "${apart[@]}"
finish
