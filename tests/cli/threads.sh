#!/usr/bin/env bash
# The same bytes for any number of threads, on any run.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ "${PVT_SANITIZED:-}" != 1 ] || skip "the release build shows it as well, and in less time"

# alike NAME ARGUMENT...: two runs on one thread and two on two.
alike() {
    local name="$1" run threads other
    shift
    for run in 1 2; do
        for threads in 1 2; do
            expect 0 "" generate "$@" -o "$threads-$run.glb" --threads "$threads"
        done
    done
    for other in 1-2 2-1 2-2; do
        holds "$name: 1-1 and $other (threads-run) differ" cmp 1-1.glb "$other.glb"
    done
}

for method in planar paper; do
    for model in building_kaykit_a foliage_commontree_1 torus; do
        alike "$model, $method" "$models/$model.glb" --resolution 48 --tolerance 1vx --budget 20 \
            --method "$method" --views "$here/one_view.txt"
    done
done
alike "all views" "$models/vehicle_kaykit_police.glb" --resolution 32 --tolerance 1vx --budget 6
finish
