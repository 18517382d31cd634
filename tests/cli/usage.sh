#!/usr/bin/env bash
# Command lines that are wrong, and the help.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

expect 1 "Usage: paravent COMMAND INPUT"
expect 1 "unknown command 'genrate'; did you mean generate?" genrate a.glb
expect 1 "unknown command 'zzz'; 'paravent --help' lists the commands" zzz
expect 1 "unknown option '--verson'; did you mean --version?" --verson
expect 1 "'more' is one argument too many" --version more
expect 0 "" --version
holds "--version prints the version alone" grep -qxE 'paravent [0-9]+\.[0-9]+\.[0-9]+' out
expect 0 "" --help
holds "the overview names generate" grep -q "generate" out
expect 0 "" -h

generate=(generate in.glb -o out.glb)
expect 1 "the input file is missing" generate -o out.glb
expect 1 "-o FILE is missing" generate in.glb
expect 1 "'b.glb' is one argument too many" "${generate[@]}" b.glb
expect 1 "unknown option --budgte; did you mean --budget?" "${generate[@]}" --budgte 5
expect 1 "unknown option --resolutoin; did you mean --resolution?" "${generate[@]}" --resolutoin=64
expect 1 "unknown option -budget; did you mean --budget?" "${generate[@]}" -budget 5
expect 1 "unknown option --xyzzy; 'paravent generate --help' lists them" "${generate[@]}" --xyzzy
expect 1 "unknown option -z" "${generate[@]}" -z
expect 1 "--output needs a value" generate in.glb -o
expect 1 "--output needs a value" generate in.glb -o --ground
expect 1 "--budget 0: it takes a whole number, 1 to 65535" "${generate[@]}" --budget 0
expect 1 "--budget -3: it takes" "${generate[@]}" --budget -3
expect 1 "--budget 65536: it takes" "${generate[@]}" --budget=65536
expect 1 "--budget ten: it takes" "${generate[@]}" --budget ten
expect 1 "--resolution 7: it takes a whole number, 8 to 2048" "${generate[@]}" --resolution 7
expect 1 "--error 0: it takes a number, above 0" "${generate[@]}" --error 0
expect 1 "--error nan: it takes" "${generate[@]}" --error nan
expect 1 "--tolerance 1px: it takes a length" "${generate[@]}" --tolerance 1px
expect 1 "--tolerance -1vx: it takes" "${generate[@]}" --tolerance -1vx
expect 1 "--smallest-hole inf: it takes" "${generate[@]}" --smallest-hole inf
expect 1 "--enclosed 26: it takes a whole number, 0 to 25" "${generate[@]}" --enclosed 26
expect 1 "--up w: it takes x, y or z" "${generate[@]}" --up w
expect 1 "--method papre: did you mean paper?" "${generate[@]}" --method papre
expect 1 "--effort most: it takes fast, default or best" "${generate[@]}" --effort most
expect 1 "--slicer gpu: it takes auto, sample, egl or osmesa" "${generate[@]}" --slicer gpu
expect 1 "--masked off: it takes auto, opaque or skip" "${generate[@]}" --masked off
expect 1 "--convention unity: it takes plain or godot" "${generate[@]}" --convention unity
expect 1 "--progress loud: it takes auto, json or none" "${generate[@]}" --progress loud
expect 1 "--threads 65: it takes a whole number, 1 to 64" "${generate[@]}" --threads 65
expect 1 "--memory-limit lots: it takes a size such as 512M or 2G" "${generate[@]}" \
    --memory-limit lots
expect 1 "--seed -1: it takes" "${generate[@]}" --seed -1
expect 1 "--scene -1: it takes" "${generate[@]}" --scene -1
expect 1 "--ground takes no value" "${generate[@]}" --ground=yes
expect 1 "--resolution and --error both set the voxels' size" "${generate[@]}" \
    --resolution 64 --error 0.1
expect 1 "--output cannot go to the standard output" generate in.glb -o -
only

expect 0 "" generate --help
for option in output budget resolution error tolerance smallest-hole ground terrain up enclosed \
    method effort deadline views slicer threads seed memory-limit stats preview convention scene node masked \
    progress quiet verbose help; do
    holds "generate --help tells of --$option" grep -qE -- "--$option( |\$)" out
done
holds "no line of the help is longer than 80 columns" test -z "$(grep -E '^.{81}' out)"
expect 0 "" "${generate[@]}" --budgte 5 --help
expect 0 "" generate -h
for shown in "default 64" "default 256" "default planar" "default y" "default auto" "default all"; do
    holds "generate --help says $shown" grep -qF "$shown" <(tr -s '\n ' ' ' <out)
done
"$PARAVENT" --help >/dev/full 2>err
code=$?
holds "help that cannot be written exits 4, not $code" test "$code" = 4

finish
