#!/usr/bin/env bash
# SIGINT and SIGTERM stop the run in good time, with exit code 130 and nothing partial.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
set -m # so that a background process is not started with SIGINT ignored

limit=500 # ms
resolution=512
views=(--views all)
if [ "${PVT_SANITIZED:-}" = 1 ]; then
    limit=5000
    resolution=128
    views=(--views "$here/one_view.txt" --effort best)
fi

# stop SIGNAL STAGE: starts a long run and sends the signal when the stage has begun. Sets `code`
# and `took` [ms].
stop() {
    local signal="$1" stage="$2" pid began
    "$PARAVENT" generate "$models/boulder.glb" -o out.glb --stats stats.json "${views[@]}" \
        --resolution "$resolution" --budget 300 --threads 2 --progress json >out 2>err &
    pid=$!
    for _ in $(seq 1200); do
        grep -q "\"stage\":\"$stage\"" err && break
        kill -0 "$pid" 2>/dev/null || break
        sleep 0.05
    done
    began="${EPOCHREALTIME/[.,]/}"
    kill "-$signal" "$pid" 2>/dev/null || fail "the run ended before stage $stage was seen"
    wait "$pid"
    code=$?
    took=$(((${EPOCHREALTIME/[.,]/} - began) / 1000))
    echo "$signal in $stage: exit $code after $took ms"
}

# interrupt SIGNAL STAGE: the best of three, as the machine may be busy with others.
interrupt() {
    local signal="$1" stage="$2" try
    for try in 1 2 3; do
        stop "$signal" "$stage"
        holds "$signal in $stage: exit $code instead of 130" test "$code" = 130
        holds "$signal in $stage: the last line tells so" grep -q '"text":"cancelled' \
            <(tail -n 1 err)
        only
        [ "$took" -gt "$limit" ] || break
    done
    holds "$signal in $stage: stopped after $took ms; at most $limit" test "$took" -le "$limit"
}

interrupt INT voxelize
interrupt TERM solid
interrupt INT sections
interrupt TERM chains
interrupt INT select
interrupt TERM refine
finish
