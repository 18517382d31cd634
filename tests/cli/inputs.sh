#!/usr/bin/env bash
# Inputs that cannot be used: exit 2 with file, place and reason; nothing inside: exit 5; limits:
# exit 6. Nothing is left behind by any of them.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

expect 2 "missing.glb" generate missing.glb -o out.glb
printf '' >empty.glb
expect 2 "empty.glb" generate empty.glb -o out.glb
head -c 300 "$models/boulder.glb" >cut.glb
expect 2 "cut.glb" generate cut.glb -o out.glb
printf 'this is no model\n' >text.gltf
expect 2 "text.gltf" generate text.gltf -o out.glb
mkdir folder.glb
expect 2 "folder.glb" generate folder.glb -o out.glb
printf 'v 0 0 0\n' >points.obj
expect 2 "points.obj" generate points.obj -o out.glb
cp points.obj model.xyz
expect 3 "model.xyz" generate model.xyz -o out.glb
cp "$models/boulder.glb" boulder.glb
expect 1 'no node named "no such"' generate boulder.glb -o out.glb --node "no such"
expect 1 "no scene 7" generate boulder.glb -o out.glb --scene 7

expect 2 "--views views.txt: No such file" generate boulder.glb -o out.glb --views views.txt
printf '0 -1 0 1\n\n# down\n1 0 0\n' >views.txt
expect 2 "views.txt:4: expected the direction" generate boulder.glb -o out.glb --views views.txt
printf '0 -1 0 1 5\n' >views.txt
expect 2 "views.txt:1: expected" generate boulder.glb -o out.glb --views views.txt
printf '0 -1 0 heavy\n' >views.txt
expect 2 "views.txt:1: expected" generate boulder.glb -o out.glb --views views.txt
printf '0 0 0 1\n' >views.txt
expect 2 "views.txt:1: the direction 0 0 0" generate boulder.glb -o out.glb --views views.txt
printf '0 1 0 -1\n' >views.txt
expect 2 "views.txt:1: the weight is negative" generate boulder.glb -o out.glb --views views.txt
printf '0 1 0 0 # none\n' >views.txt
expect 2 "views.txt: no direction has a weight" generate boulder.glb -o out.glb --views views.txt
head -c 5000 /dev/zero | tr '\0' '1' >views.txt
expect 2 "views.txt:1: the line is too long" generate boulder.glb -o out.glb --views views.txt
printf '0 1 0 1\n\0\n' >views.txt
expect 2 "views.txt:2: this is not a text" generate boulder.glb -o out.glb --views views.txt
expect 2 "/dev/zero:1: this is not a text" generate boulder.glb -o out.glb --views /dev/zero
# Numbers whose squares and sums are beyond what a double holds.
printf '1e200 0 0 1e308\n0 1e-200 0 1e308' >views.txt
expect 0 "" generate boulder.glb -o large.glb --views views.txt --resolution 16 --budget 6
printf '1 0 0 1\n0 1 0 1\n' >views.txt
expect 0 "" generate boulder.glb -o plain.glb --views views.txt --resolution 16 --budget 6
holds "only the directions and the proportion of the weights matter" cmp large.glb plain.glb
rm large.glb plain.glb
expect 2 "--views . cannot be read" generate boulder.glb -o out.glb --views .

# The paper's way knows of no panels on the surface.
paper=(--method paper --tolerance 0)
expect 5 "sheet.glb: nothing is inside" generate "$models/sheet.glb" -o out.glb --resolution 32 "${paper[@]}"
expect 5 "--terrain" generate "$models/sheet.glb" -o out.glb --resolution 32 "${paper[@]}"
expect 5 "--smallest-hole" generate "$models/tree.glb" -o out.glb --resolution 16 "${paper[@]}"
expect 5 "--ground" generate "$models/house.glb" -o out.glb --resolution 16 "${paper[@]}"
expect 6 "memory limit" generate boulder.glb -o out.glb --memory-limit 1M
expect 6 "a resolution of" generate boulder.glb -o out.glb --resolution 2048 --memory-limit 10M
fits="$(sed -n 's/.*a resolution of \([0-9]*\) would fit.*/\1/p' err)"
expect 0 "" generate boulder.glb -o fits.glb --views "$here/one_view.txt" --budget 1 --effort fast \
    --resolution "${fits:-0}" --memory-limit 10M
rm -f fits.glb
expect 6 "" generate boulder.glb -o out.glb --error 1e-9

only boulder.glb cut.glb empty.glb folder.glb model.xyz points.obj text.gltf views.txt
finish
