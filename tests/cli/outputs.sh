#!/usr/bin/env bash
# Outputs: refused before the work when that can be known, whole or not there at all.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cp "$models/boulder.glb" in.glb

expect 3 "models are written as .glb, .gltf, .obj, .ply or .tscn" generate in.glb "${quick[@]}" -o out.stl
expect 3 "models are written as" generate in.glb "${quick[@]}" -o out
expect 3 "pictures are written as .png" generate in.glb "${quick[@]}" -o out.glb --preview out.jpg
expect 4 "folder nowhere: No such file or directory; make it first" generate in.glb "${quick[@]}" -o nowhere/out.glb
expect 4 "in.glb is not a folder" generate in.glb "${quick[@]}" -o in.glb/out.glb
expect 4 "folder nowhere" generate in.glb "${quick[@]}" -o out.glb --stats nowhere/stats.json
expect 4 "folder nowhere" generate in.glb "${quick[@]}" -o out.glb --preview nowhere/picture.png
mkdir folder.glb
expect 4 "folder.glb cannot be written: Is a directory" generate in.glb "${quick[@]}" -o folder.glb
rmdir folder.glb
expect 4 "cannot be written" generate in.glb "${quick[@]}" -o /proc/out.glb
if [ "$(id -u)" != 0 ]; then
    mkdir locked && chmod a-w locked
    expect 4 "locked/out.glb cannot be written: Permission denied" generate in.glb "${quick[@]}" -o locked/out.glb
    rmdir locked
    printf 'old' >kept.glb
    chmod a-w kept.glb
    expect 4 "kept.glb cannot be written: Permission denied" generate in.glb "${quick[@]}" -o kept.glb
    holds "a read-only file stays as it was" grep -qx old kept.glb
    rm -f kept.glb
fi
only in.glb

# The same file twice, however it is written.
expect 1 "is the same file as the input" generate in.glb "${quick[@]}" -o in.glb
expect 1 "is the same file as the input" generate in.glb "${quick[@]}" -o ./in.glb
ln -s in.glb link.glb
expect 1 "is the same file as the input" generate in.glb "${quick[@]}" -o link.glb
ln in.glb hard.glb
expect 1 "is the same file as the input" generate in.glb "${quick[@]}" -o hard.glb
expect 1 "--stats ./out.glb is the same file as --output" generate in.glb "${quick[@]}" -o out.glb \
    --stats ./out.glb
expect 1 "--preview p.png is the same file as --stats" generate in.glb "${quick[@]}" -o out.glb \
    --stats "$PWD/p.png" --preview p.png
printf '0 -1 0 1\n' >views.txt
expect 1 "is the same file as the input" generate in.glb "${quick[@]}" -o out.glb --views views.txt \
    --stats views.txt
rm link.glb hard.glb views.txt
only in.glb

# A full disk.
ln -s /dev/full full.glb
expect 4 "full.glb cannot be written: No space left on device" generate in.glb "${quick[@]}" -o full.glb
rm full.glb
expect 4 "/dev/full cannot be written: No space left on device; out.glb was written" \
    generate in.glb "${quick[@]}" -o out.glb --stats /dev/full
holds "what the message says was written is there" test -s out.glb
rm out.glb
(
    ulimit -f 0
    "$PARAVENT" generate in.glb "${quick[@]}" -o out.glb 2>&1 >/dev/null | cat >&3
    exit "${PIPESTATUS[0]}"
) 3> >(cat >told)
code=$?
wait
holds "over the file size limit the exit code is 4, not $code" test "$code" = 4
rm -f told
only in.glb

# An older file stays as it was until the new one is whole.
printf 'old' >out.glb
expect 5 "" generate "$models/sheet.glb" -o out.glb --resolution 16 --method paper --tolerance 0
holds "a failed run leaves the older output alone" grep -qx old out.glb
expect 0 "" generate in.glb "${quick[@]}" -o out.glb
holds "a run that works replaces it" test "$(head -c 4 out.glb)" = glTF

# Streams.
expect 0 "" generate in.glb "${quick[@]}" -o out.glb --stats -
holds "--stats - puts JSON on stdout" test "$(head -c 1 out)" = "{"
expect 0 "" generate in.glb "${quick[@]}" -o out.glb
holds "without it stdout stays empty" test ! -s out
expect 0 "" generate in.glb "${quick[@]}" -o out.glb --stats /dev/null
"$PARAVENT" generate in.glb "${quick[@]}" -o out.glb --stats - >/dev/full 2>err
code=$?
holds "a stdout that is full exits 4, not $code" test "$code" = 4
"$PARAVENT" generate in.glb "${quick[@]}" -o out.glb --stats - 2>err | true
code="${PIPESTATUS[0]}"
holds "a closed pipe is an error or goes unseen, never a signal: $code" test "$code" -le 4

# The names of nodes, and a name that is not UTF-8.
expect 0 "" generate in.glb "${quick[@]}" -o out.gltf
holds "the node is named after the input" grep -q '"in_occluder"' out.gltf
holds "the check of the result is told with it" grep -qE "\"outside\": *0(\\.0)?," out.gltf
expect 0 "" generate in.glb "${quick[@]}" -o out.gltf --convention godot
holds "Godot's suffix" grep -q '"in-occonly"' out.gltf
odd=$'\xff\xe4odd"name.v2.glb'
cp in.glb "$odd"
expect 0 "" generate "$odd" "${quick[@]}" -o out.gltf
holds "bytes that are not UTF-8 become _" grep -q '__odd\\"name.v2_occluder"' out.gltf
rm "$odd"
for format in glb gltf obj ply tscn GLB; do
    expect 0 "" generate in.glb "${quick[@]}" -o "all.$format"
    holds "all.$format has bytes" test -s "all.$format"
done
only in.glb out.glb out.gltf all.glb all.gltf all.obj all.ply all.tscn all.GLB
finish
