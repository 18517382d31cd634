#!/usr/bin/env bash
# Every model that the project ships, and those of PVT_MODELS, at the default's resolution and with
# all effort, where the other tests take less: the same bytes on any number of threads, nothing
# outside what may be covered, and nothing hidden farther from the model than the error bound says.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ "${PVT_LONG:-0}" = 1 ] || skip "takes minutes; scripts/test.sh --long runs it"
[ "${PVT_SANITIZED:-}" != 1 ] || skip "the release build shows it as well, and in less time"
command -v node >/dev/null || skip "needs node to read the numbers"

# The picture of a view tells lengths to about a pixel: `views` of 512 along the longer side.
keeps_its_bound() { # stats.json scores.json
    node -e '
        const [stats, scores] = process.argv.slice(1).map(
            path => JSON.parse(require("fs").readFileSync(path, "utf8")));
        const pixel = stats.voxel_size * stats.resolution * Math.sqrt(3) / 512;
        const over = scores.occluders[0].over_thickness;
        if (!(over <= stats.error_bound + 2 * pixel)) {
            console.error(over + " is beyond " + stats.error_bound);
            process.exit(1);
        }' "$1" "$2" 2>bound
}

judge() { # MODEL OPTION...
    local model="$1" name
    name="$(basename "$model") ${*:2}"
    paravent generate "$@" --threads 1 -o one.glb --stats one.json --quiet
    if [ "$code" = 5 ]; then
        echo "$name: nothing inside"
        return
    fi
    holds "$name on one thread: exit $code: $(cat err)" test "$code" = 0
    [ "$code" = 0 ] || return
    expect 0 "" generate "$@" --threads 3 -o three.glb --quiet
    holds "$name gives the same bytes on three threads" cmp one.glb three.glb
    holds "$name stays where it may lie" test "$(stat_of one.json outside)" = 0
    expect 0 "" evaluate "$model" one.glb --views 200 --quads 200 --json scores.json --quiet
    holds "$name keeps its error bound" keeps_its_bound one.json scores.json
    [ ! -s bound ] || echo "$name: $(cat bound)" >&2
}

shopt -s nullglob
all=("$models"/*.glb)
[ -z "${PVT_MODELS:-}" ] || all+=("$PVT_MODELS"/*.glb)
for model in "${all[@]}"; do
    echo "$(basename "$model")"
    judge "$model" --resolution 256 --effort best
    judge "$model" --resolution 256 --smallest-hole 4vx --ground --method paper
done

finish
