#!/usr/bin/env bash
# The stats file has the fields of the contract, and no number that is not one.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to read the stats"

check_stats() {
    checks=$((checks + 1))
    node "$here/stats.mjs" stats.json || fail "stats of: $*"
}
for model in boulder torus house; do
    expect 0 "" generate "$models/$model.glb" -o out.glb --stats stats.json --resolution 32 \
        --budget 20 --tolerance 1vx --ground --views "$here/one_view.txt" --effort fast
    check_stats "$model"
done
expect 0 "" generate "$models/boulder.glb" -o out.glb --stats stats.json --error 0.2 \
    --method paper --enclosed 5 --scene 0 --memory-limit 1GB \
    --views "$here/one_view.txt"
check_stats "many options"
odd=$'in\n"put\xff.glb'
cp "$models/boulder.glb" "$odd"
expect 0 "" generate "$odd" -o out.glb --stats stats.json "${quick[@]}"
check_stats "an odd name"
finish
