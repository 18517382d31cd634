#!/usr/bin/env bash
# `paravent ladder`: levels whose errors grow and whose triangles fall, in both namings, with the
# original or without, and every contradiction refused by the option's name.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the stats"

boulder="$models/boulder.glb"
few=(--views "$here/one_view.txt" --effort fast)
small=("${few[@]}" --errors 0.5,0.8,1.3 --budgets 12,8,4)

# checked FILE WHAT: ladder.mjs finds that the file is what it should be.
checked() {
    checks=$((checks + 1))
    node "$here/ladder.mjs" "$@" || fail "ladder.mjs $*"
}

# The defaults: four levels, from the resolution on.
expect 0 "LOD3" ladder "$boulder" -o four.glb --resolution 32 "${few[@]}" --stats four.json
checked four.glb msft four.json 4
expect 0 "" ladder "$boulder" -o lists.glb "${small[@]}" --stats lists.json
checked lists.glb msft lists.json 3
expect 0 "" ladder "$boulder" -o plain.gltf --naming suffix "${small[@]}" --stats plain.json
checked plain.gltf suffix plain.json 3
expect 0 "" ladder "$boulder" -o one.glb --levels 1 --resolution 32 "${few[@]}" --stats one.json
checked one.glb suffix one.json 1
expect 0 "" ladder "$boulder" -o screen.glb "${small[@]}" --stats screen.json --pixel-error 2.5 \
    --fov 95 --screen-height 700 --screen-width 2000
checked screen.glb msft screen.json 3
expect 0 "" ladder "$boulder" -o budgets.glb "${few[@]}" --resolution 48 --budgets 9,3 \
    --stats budgets.json
checked budgets.glb msft budgets.json 2
rm ./*.glb ./*.gltf ./*.json

# What contradicts itself, by the name of the option.
refused() {
    local text="$1"
    shift
    expect 1 "$text" ladder "$boulder" -o refused.glb "$@"
}
refused "--errors 0.3,0.2: 0.2 follows 0.3; errors grow" --errors 0.3,0.2
refused "--errors 0.3,0.3: 0.3 follows 0.3" --errors 0.3,0.3
refused "--errors 0,1: 0 is not above 0" --errors 0,1
refused "--errors 0.3,,1: '' is not a number" --errors 0.3,,1
refused "--errors nan,1: 'nan' is not a number" --errors nan,1
refused "--budgets 4,8: 8 follows 4; triangles fall" --budgets 4,8
refused "--budgets 8,8: 8 follows 8" --budgets 8,8
refused "--budgets 8.5,2: 8.5 is not a whole number" --budgets 8.5,2
refused "--budgets 8,0: 0 is not a whole number, 1 to 65535" --budgets 8,0
refused "--budgets 70000: 70000 is not a whole number" --budgets 70000
refused "at most 8 levels" --errors 1,2,3,4,5,6,7,8,9
refused "--errors has 2 numbers and --budgets 3" --errors 1,2 --budgets 9,5,2
refused "--levels is 3, but --errors has 2 numbers" --levels 3 --errors 1,2
refused "--levels is 3, but --budgets has 1 number;" --levels 3 --budgets 64
refused "--resolution and --errors both set" --resolution 64 --errors 1,2
refused "--levels 9: it takes a whole number, 1 to 8" --levels 9
refused "--pixel-error 0: it takes a number, above 0" --pixel-error 0
refused "--fov 180: it takes a number, 1 to 179" --fov 180
refused "--screen-height 0" --screen-height 0
refused "--naming lod: it takes msft or suffix" --naming lod
refused "unknown option --budget" --budget 64
refused "LOD0: the error 0.2 is used up by the tolerance" --errors 0.2,3 --tolerance 0.5
expect 3 "ladders are written as .glb or .gltf" ladder "$boulder" -o refused.obj
expect 3 "pictures are written as .png" ladder "$boulder" -o refused.glb --preview refused.jpg
expect 1 "is the same file as the input" ladder "$boulder" -o "$boulder"
expect 2 "missing.glb" ladder missing.glb -o refused.glb
expect 4 "folder nowhere" ladder "$boulder" -o nowhere/refused.glb
expect 5 "sheet.glb: LOD0: nothing is inside" ladder "$models/sheet.glb" -o refused.glb \
    "${few[@]}" --resolution 16 --method paper --tolerance 0
expect 6 "LOD0: an error of 0.0001 needs" ladder "$boulder" -o refused.glb --errors 0.0001,1
only

# A level that cannot be had is told, in the stats, too, and the others are there.
expect 0 "LOD2: the level is left out" ladder "$boulder" -o short.glb "${few[@]}" \
    --errors 0.5,90,100 --stats short.json
checked short.glb msft short.json 2
holds "the warning is in the stats" grep -q "LOD2: the level is left out" short.json
rm short.*

# Names.
expect 0 "" ladder "$boulder" -o names.gltf "${small[@]}"
holds "the finest is named as generate names it" grep -q '"boulder_occluder"' names.gltf
holds "the others are numbered" grep -q '"boulder_occluder_LOD2"' names.gltf
expect 0 "" ladder "$boulder" -o names.gltf "${small[@]}" --convention godot
holds "Godot's suffix" grep -q '"boulder-occonly"' names.gltf
holds "Godot's suffix, numbered" grep -q '"boulder_LOD2-occonly"' names.gltf
cp "$boulder" 'a$noimp.glb'
expect 0 "" ladder 'a$noimp.glb' -o names.gltf "${small[@]}" --convention godot
holds "Godot's import has nothing to act on" grep -q '"a_noimp-occonly"' names.gltf
rm 'a$noimp.glb'
expect 0 "Godot's import makes one occluder of all" ladder "$boulder" -o names.gltf "${small[@]}" \
    --convention godot --naming suffix
holds "Godot's suffix behind the level's" grep -q '"boulder_LOD0-occonly"' names.gltf

# The original beside the ladder, as the file has it or as triangles.
beside() {
    local original="$1" naming="$2" output="$3" whole
    shift 3
    expect 0 "" ladder "$original" -o "$output" --with-original --naming "$naming" "$@" \
        --stats with.json
    checked "$output" "$naming" with.json 3
    paravent generate "$output" -o again.glb "${quick[@]}" --tolerance 1vx --stats again.json
    whole="$(node -e '
        const stats = JSON.parse(require("fs").readFileSync("with.json", "utf8"));
        const levels = process.argv[1] === "msft" ? stats.levels.slice(0, 1) : stats.levels;
        console.log(levels.reduce((sum, level) => sum + level.triangles, stats.triangles_in))
        ' "$naming")"
    holds "$output: all triangles come out" test "$(stat_of again.json triangles_in)" = "$whole"
}
beside "$models/house.glb" msft house.glb "${few[@]}" --errors 0.3,0.5,0.9 --ground
beside "$models/house.glb" suffix house.gltf "${few[@]}" --errors 0.3,0.5,0.9 --ground
holds "the original's nodes are there" grep -q '"house_LOD0"' house.gltf
expect 0 "" generate "$boulder" -o rock.obj --resolution 24 --budget 40 "${few[@]}" --tolerance 1vx
beside rock.obj msft rock.glb "${few[@]}" --resolution 24 --levels 3 --tolerance 1vx

# The same bytes for any number of threads.
expect 0 "" ladder "$boulder" -o one.glb "${small[@]}" --threads 1
expect 0 "" ladder "$boulder" -o two.glb "${small[@]}" --threads 2
holds "threads change nothing" cmp one.glb two.glb

# Progress runs through all levels, one after the other.
expect 0 "" ladder "$boulder" -o one.glb "${small[@]}" --progress json
holds "stages are named by level, in order" node -e '
    const lines = require("fs").readFileSync("err", "utf8").trimEnd().split("\n").map(JSON.parse);
    const levels = lines.filter(line => /^LOD/.test(line.stage ?? "")).map(line => line.stage[3]);
    const sorted = [...levels].sort();
    process.exit(new Set(levels).size === 3 && levels.join() === sorted.join() ? 0 : 1)'

# A stop between or within levels leaves nothing.
rm -f ./*.glb ./*.gltf ./*.json ./*.obj
set -m
"$PARAVENT" ladder "$boulder" -o out.glb --stats stats.json --resolution 64 \
    --progress json >out 2>err &
pid=$!
for _ in $(seq 1200); do
    grep -q '"LOD1: ' err && break
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.05
done
kill -INT "$pid"
wait "$pid"
code=$?
holds "stopped in its second level it exits $code" test "$code" = 130
only

# The glTF validator, on both namings and with originals.
if [ -d "$PVT_NODE_MODULES/gltf-validator" ]; then
    expect 0 "" ladder "$boulder" -o msft.glb "${small[@]}"
    expect 0 "" ladder "$boulder" -o suffix.gltf "${small[@]}" --naming suffix
    expect 0 "" ladder "$models/house.glb" -o house.glb --with-original "${small[@]}" --ground
    expect 0 "" ladder "$models/house.glb" -o house.gltf --with-original "${small[@]}" --ground \
        --naming suffix
    checks=$((checks + 1))
    NODE_PATH="$PVT_NODE_MODULES" node "$here/validate.cjs" ./*.glb ./*.gltf || fail "the validator"
fi
finish
