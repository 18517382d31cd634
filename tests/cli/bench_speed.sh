#!/usr/bin/env bash
# paravent-bench speed has a line for everything it measures, with a number on it.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

bench() {
    "$PARAVENT_BENCH" "$@" >out 2>err
    code=$?
}

# A number that is above zero, as it stands in a table.
number='[0-9]*\.?[0-9]*[1-9][0-9]*\.?[0-9]*'

# At 16 voxels the walls of the house are all surface: it has no inside, which the paper's way needs.
bench speed "$models/torus.glb" "$models/house.glb" --repeats 1 --seconds 0 --resolution 16 \
    --budget 1 --against-paper --paper-resolution 16 --progress none
holds "speed exits 0, not $code: $(cat err)" test "$code" = 0
for rule in centre covered; do
    for size in 256 64; do
        holds "a time of $rule slices at $size voxels" \
            grep -qE "^$rule slices, N = $size +$number ms a slice\$" out
    done
done
for backend in EGL OSMesa; do
    holds "a time of stencil slices by $backend, or that there are none" \
        grep -qE "^stencil slices, $backend, N = 64 +($number ms a slice; .+|not here)\$" out
done
for size in 64 128 256; do
    for shape in "a blob" full; do
        holds "distances of $size pixels, $shape" \
            grep -qE "^distances of $size x $size pixels, $shape +$number million pixels" out
    done
done
for model in torus house; do
    holds "a table of $model" grep -qF "$model.glb, resolution 16, budget 1;" out
done
for effort in fast default; do
    holds "effort $effort makes a triangle of the torus, with seconds of each stage and the peak" \
        grep -qE "^$effort +1,920 +1( +[0-9]+\.[0-9]+){9}\$" out
    holds "effort $effort makes a panel of the house's thin walls" \
        grep -qE "^$effort +158 +1( +[0-9]+\.[0-9]+){9}\$" out
done
holds "the torus against the paper's way" \
    grep -qE "^torus\.glb( +$number +[0-9.]+ %){2}( +$number +[0-9.]+ %( +$number){2}| +not here +- +-)\$" out
holds "the house has nothing to compare with" \
    grep -qE "^house\.glb( +$number +[0-9.]+ %){2} +(nothing inside|not here) +- +-\$" out

bench speed --repeats 1 --seconds 0 --progress none
holds "without a model, a ball is sliced" grep -q "^slices of a ball" out
holds "the ball has slices" grep -qE "^covered slices, N = 64 +$number ms a slice\$" out

for command in quality speed; do
    bench "$command" --help
    holds "$command --help says how it is called" grep -qF "Usage: paravent-bench $command" out
    bench "$command" --budgte 5
    holds "$command names the program that lists its options" \
        grep -qE "^paravent-bench $command: unknown option --budgte" err
done

finish
