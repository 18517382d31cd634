#!/usr/bin/env bash
# Every option of generate does what it says, seen from outside.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the stats"

boulder="$models/boulder.glb"
# made INPUT OPTION...: generates out.glb and stats.json, small and quick unless told otherwise.
made() {
    expect 0 "" generate "${quick[@]}" "$@" -o out.glb --stats stats.json
}
# is KEY VALUE
is() {
    local found
    found="$(stat_of stats.json "$1")"
    holds "$1 is $found, not $2" test "$found" = "$2"
}
# compare A OPERATOR B, as numbers
compare() {
    holds "$1 $2 $3 does not hold" node -e "process.exit($1 $2 $3 ? 0 : 1)"
}

made "$boulder" --resolution 24 --budget 5
is resolution 24
is options.budget 5
compare "$(stat_of stats.json triangles)" "<=" 5
compare "$(stat_of stats.json triangles)" ">=" 1
is triangles_in 952
is outside 0
is options.method planar
strict="$(stat_of stats.json error_bound)"
voxel="$(stat_of stats.json voxel_size)"
compare "Math.abs($strict - Math.sqrt(3) * $voxel)" "<" "1e-9 * $voxel"

made "$boulder" --resolution=24 --tolerance 1vx
is options.tolerance 1vx
compare "Math.abs($(stat_of stats.json error_bound) - $strict - $voxel)" "<" "1e-9 * $voxel"
error="$(node -e "console.log(2 * $strict)")"
expect 0 "" generate "$boulder" --error "$error" --views "$here/one_view.txt" --effort fast \
    -o out.glb --stats stats.json
compare "$(stat_of stats.json error_bound)" "<=" "2.0000001 * $strict"
is options.resolution null
made "$boulder" --resolution 24 --smallest-hole 2vx
compare "Math.abs($(stat_of stats.json error_bound) - $strict - $voxel)" "<" "1e-9 * $voxel"

# The house has no floor: --ground closes it, and so does taking the opening for closed.
made "$models/house.glb" --resolution 48
open="$(stat_of stats.json inside_fraction)"
made "$models/house.glb" --resolution 48 --ground
is options.ground true
made "$models/house.glb" --resolution 48 --smallest-hole 3 --ground
compare "$(stat_of stats.json inside_fraction)" ">" "2 * $open"
made "$models/house.glb" --resolution 48 --enclosed 16
compare "$(stat_of stats.json inside_fraction)" ">" "2 * $open"

# The sheet lies level: below it is inside with y up, and with x up much less is.
made "$models/sheet.glb" --resolution 32 --terrain
level="$(stat_of stats.json inside_fraction)"
compare "$level" ">" 0
made "$models/sheet.glb" --resolution 32 --terrain --up x
compare "$(stat_of stats.json inside_fraction)" "<" "0.6 * $level"

made "$boulder" --resolution 24 --budget 8 --method paper
is options.method paper
compare "$(stat_of stats.json triangles)" "<=" 8
efforts=(fast default best)
[ "${PVT_SANITIZED:-}" != 1 ] || efforts=(fast)
for effort in "${efforts[@]}"; do
    made "$boulder" --budget 12 --effort "$effort"
    is options.effort "$effort"
    # What is raised is recall; the measure grows with it, but for a hair.
    compare "$(stat_of stats.json measure)" ">=" "0.999 * ${last:-0}"
    last="$(stat_of stats.json measure)"
done
# Refinement with the best effort takes longer than this anywhere; what there is by then is kept.
made "$boulder" --budget 12 --effort best --deadline 0.5
is options.deadline 0.5
compare "$(stat_of stats.json measure)" ">" 0
compare "$(stat_of stats.json seconds.total)" "<" 30
# All views take long in a sanitizer build.
cp out.glb all.glb
if [ "${PVT_SANITIZED:-}" != 1 ]; then
    made "$boulder" --resolution 24 --budget 2 --views above
    is options.views above
    made "$boulder" --resolution 24 --budget 2 --views all
    cp out.glb all.glb
fi
printf '# straight down, twice as important as along x\n0 -1 0 2\n\n1 0 0 1 # x\n' >views.txt
made "$boulder" --resolution 24 --budget 2 --views views.txt
is options.views views.txt
holds "--views FILE changes the result" test -n "$(cmp out.glb all.glb 2>&1)"

made "$boulder" --resolution 24 --seed 7 --threads 1 --memory-limit 300M
is options.seed 7
is options.threads 1
is options.memory_limit $((300 << 20))

# Of the house's three nodes, one; and the default scene by its number.
made "$models/house.glb" --resolution 32 --scene 0 --ground
whole="$(stat_of stats.json triangles_in)"
name="$(node -e '
    const bytes = require("fs").readFileSync(process.argv[1]);
    const json = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
    console.log(json.nodes.find(node => node.mesh !== undefined).name)' "$models/house.glb")"
made "$models/house.glb" --node "$name"
compare "$(stat_of stats.json triangles_in)" "<" "$whole"
for masked in auto opaque skip; do
    made "$boulder" --resolution 16 --masked "$masked"
    is options.masked "$masked"
done

# What is said.
paravent generate "$boulder" "${quick[@]}" -o out.glb
holds "the summary names the output" grep -q "^out.glb: .* triangles in .* polygon" err
holds "the summary tells the error bound" grep -q "error bound" err
paravent generate "$boulder" "${quick[@]}" -o out.glb -q
holds "-q says nothing" test ! -s err
paravent generate "$boulder" "${quick[@]}" -o out.glb -v
holds "-v tells seconds" grep -q "seconds: load" err
paravent generate missing.glb -o out.glb -q
holds "-q still tells errors" grep -q "missing.glb" err
holds "plain text has no escape codes" test -z "$(grep -l $'\033' err)"

paravent generate "$boulder" "${quick[@]}" -o out.glb --progress none
holds "--progress none leaves the summary" grep -q "error bound" err
paravent generate "$boulder" "${quick[@]}" -o out.glb --progress json -v
holds "--progress json: every line is an object, and stages run from 0 to 1" node -e '
    const lines = require("fs").readFileSync("err", "utf8").trimEnd().split("\n").map(JSON.parse);
    const steps = lines.filter(line => line.stage !== undefined);
    if (steps.length < 3) process.exit(1);
    let last = {stage: "", fraction: 0, seconds: 0};
    for (const step of steps) {
        if (!(step.fraction >= 0 && step.fraction <= 1 && step.seconds >= last.seconds))
            process.exit(2);
        if (step.stage === last.stage && step.fraction < last.fraction) process.exit(3);
        last = step;
    }
    if (!lines.some(line => line.level === "info")) process.exit(4);'
paravent generate missing.glb -o out.glb --progress json
holds "errors are objects too, with the exit code" node -e '
    const lines = require("fs").readFileSync("err", "utf8").trimEnd().split("\n").map(JSON.parse);
    const line = lines.at(-1);
    process.exit(line.level === "error" && line.exit === 2 && /missing.glb/.test(line.text) ? 0 : 1)'
# Rods with gaps between them: few triangles hide little, unless the gaps count as closed.
node -e '
    const rods = 8;
    let text = "";
    for (let i = 0; i < rods * rods; ++i) {
        for (let k = 0; k < 8; ++k)
            text += `v ${i % rods * 2 + (k & 1)} ${2 * (i / rods | 0) + (k >> 1 & 1)} ${20 * (k >> 2)}\n`;
        for (const face of [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]])
            text += `f ${face.map(corner => corner + 8 * i).join(" ")}\n`;
    }
    require("fs").writeFileSync("rods.obj", text);'
rods=(generate rods.obj "${quick[@]}" --resolution 64 -o out.glb)
expect 0 "16 triangles hide only" "${rods[@]}" --budget 16
expect 0 "" "${rods[@]}" --budget 16 --smallest-hole 1.5
holds "nothing is told where much is hidden" test -z "$(grep "hide only" err)"
expect 0 "" "${rods[@]}" --budget 15
holds "nor where little was asked for" test -z "$(grep "hide only" err)"

if command -v script >/dev/null; then
    TERM=xterm script -qec "'$PARAVENT' generate '$boulder' --resolution 64 --views '$here/one_view.txt' -o out.glb" /dev/null \
        </dev/null >terminal 2>&1
    holds "on a terminal there is a bar" grep -q $'\033\\[K' terminal
    TERM=dumb script -qec "'$PARAVENT' generate '$boulder' --resolution 64 --views '$here/one_view.txt' -o out.glb" /dev/null \
        </dev/null >terminal 2>&1
    holds "on a dumb terminal there is none" test -z "$(grep -l $'\033' terminal)"
    TERM=xterm script -qec "'$PARAVENT' generate '$boulder' --resolution 64 --views '$here/one_view.txt' --progress none -o out.glb" /dev/null \
        </dev/null >terminal 2>&1
    holds "--progress none shows no bar" test -z "$(grep -l $'\033' terminal)"
    holds "--progress none is not quiet" grep -q "error bound" terminal
fi
finish
