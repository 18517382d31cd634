#!/usr/bin/env bash
# paravent evaluate: its files hold what they promise, and what is bad is refused as the rest of the
# command does.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the results"

boulder="$models/boulder.glb"
make() {
    node "$here/mesh.mjs" "$@" || fail "cannot make $1"
}
# A tetrahedron within the boulder, one half as large, and a square five meters below.
faces=(0,2,1 0,1,3 1,2,3 2,0,3)
make large.gltf -0.5,0.3,-0.5 0.5,0.3,-0.5 0,0.3,0.5 0,0.9,0 -- "${faces[@]}"
make small.gltf -0.2,0.3,-0.2 0.2,0.3,-0.2 0,0.3,0.2 0,0.6,0 -- "${faces[@]}"
make beside.gltf -1,-5,-1 1,-5,-1 1,-5,1 -1,-5,1 -- 0,1,2 0,2,3
quick=(--views 30 --quads 2000 --pixels 128)

# A mesh against itself: perfect, to the last digit.
expect 0 "" evaluate "$boulder" "$boulder" "${quick[@]}" --json self.json
holds "a mesh against itself is perfect" node -e '
    const o = JSON.parse(require("fs").readFileSync("self.json")).occluders[0];
    const all = [o.uniform, o.small, ...o.per_view.flatMap((v) => [v.uniform, v.small])];
    const perfect = all.every((s) => s.precision === 1 && s.recall === 1) && o.coverage === 1 &&
        o.over_area === 0 && o.over_thickness === 0 && o.per_view.length === 30;
    process.exit(perfect ? 0 : 1);'
holds "the table says so" grep -qE 'recall +100 %$' out

# Several occluders, all outputs.
outputs=(--json all.json --csv all.csv --plot all.svg --silhouettes all.png)
expect 0 "" evaluate "$boulder" large.gltf small.gltf beside.gltf "${quick[@]}" "${outputs[@]}"
holds "the JSON and the CSV hold what they promise" node "$here/evaluate.mjs" all.json all.csv
holds "the table marks the best" grep -qE 'recall .*% \*' out
holds "the sheet is a picture" test "$(head -c 4 all.png | tail -c 3)" = PNG
holds "the plot is a picture" grep -q '^</svg>' all.svg
holds "a curve an occluder and family, and a line of the legend" \
    test "$(grep -c 'class="curve"' all.svg)" = 9

# The same bytes for any number of threads, and for the same occluder in other company.
expect 0 "" evaluate "$boulder" large.gltf small.gltf beside.gltf "${quick[@]}" --threads 1 \
    --json one.json --csv one.csv --plot one.svg --silhouettes one.png
for kind in json csv svg png; do
    holds "threads do not change the $kind" cmp all.$kind one.$kind
done
expect 0 "" evaluate "$boulder" small.gltf "${quick[@]}" --csv alone.csv
holds "nor does company" cmp <(grep '^small' all.csv) <(grep '^small' alone.csv)
expect 0 "" evaluate "$boulder" small.gltf "${quick[@]}" --seed 2 --csv other.csv
checks=$((checks + 1))
cmp -s alone.csv other.csv && fail "another seed gives the same numbers"

# A name that would steer a terminal, by ESC or by CSI in one character.
odd=$'a\x1b\xc2\x9bb.gltf'
cp small.gltf "$odd"
expect 0 "" evaluate "$boulder" "$odd" "${quick[@]}"
holds "the table shows a harmless name" grep -qF 'a??b.gltf' out
rm "$odd"

# Streams.
expect 0 "" evaluate "$boulder" large.gltf "${quick[@]}" --json -
holds "--json - puts nothing but JSON on stdout" node -e '
    JSON.parse(require("fs").readFileSync("out"))'
expect 0 "" evaluate "$boulder" large.gltf "${quick[@]}" -q
holds "quiet is quiet" test ! -s out -a ! -s err
"$PARAVENT" evaluate "$boulder" large.gltf "${quick[@]}" -q --json - >/dev/full 2>err
code=$?
holds "a stdout that is full exits 4, not $code" test "$code" = 4
"$PARAVENT" evaluate "$boulder" large.gltf "${quick[@]}" >/dev/full 2>err
code=$?
holds "the same for the table, not $code" test "$code" = 4
"$PARAVENT" evaluate --help >out
holds "the help defines the numbers" grep -q 'Nt/(Nt+Pf)' out

# What is wrong, and nothing is left of it.
clear_scratch
make in.gltf -0.5,0.3,-0.5 0.5,0.3,-0.5 0,0.3,0.5 -- 0,1,2
make wild.gltf NaN,0,0 1,0,0 0,1,0 -- 0,1,2
expect 1 "OCCLUDER" evaluate "$boulder"
expect 1 "--views" evaluate "$boulder" in.gltf --views 0
expect 1 "--pixels" evaluate "$boulder" in.gltf --pixels 5000
expect 1 "same file as the input" evaluate in.gltf "$boulder" --json in.gltf
expect 1 "is the same file as" evaluate in.gltf "$boulder" --json a --csv ./a
expect 1 "cannot go to the standard output" evaluate in.gltf in.gltf --silhouettes -
expect 2 "missing.glb" evaluate "$boulder" missing.glb "${quick[@]}" --json a.json
expect 2 "wild.gltf" evaluate wild.gltf in.gltf "${quick[@]}" --json a.json
expect 3 ".png" evaluate "$boulder" in.gltf --silhouettes a.jpg
many=()
for i in {1..28}; do
    many+=(in.gltf)
done
expect 1 "--silhouettes shows at most 27 occluders, and there are 28" evaluate "$boulder" \
    "${many[@]}" --silhouettes a.png
expect 1 "--plot a.png: a plot is written as .svg" evaluate "$boulder" in.gltf --plot a.png
expect 4 "folder nowhere" evaluate "$boulder" in.gltf --json nowhere/a.json
expect 4 "/dev/full cannot be written" evaluate "$boulder" in.gltf "${quick[@]}" --csv /dev/full \
    --json a.json
expect 6 "fewer --pixels" evaluate "$boulder" in.gltf --pixels 4096 --memory-limit 2M --json a.json
only in.gltf wild.gltf

# Stopped in the middle of the work.
"$PARAVENT" evaluate "$boulder" in.gltf --views 65536 --json a.json --csv b.csv >out 2>err &
process=$!
sleep 0.5
kill -INT "$process"
wait "$process"
code=$?
holds "a stopped run exits 130, not $code" test "$code" = 130
only in.gltf wild.gltf
finish
