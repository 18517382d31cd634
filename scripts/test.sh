#!/usr/bin/env bash
# Sets the machine up, builds, and runs every test.
#   scripts/test.sh              everything, as CI does
#   scripts/test.sh --long       the tests that take minutes, too
#   scripts/test.sh STAGE...     only these stages, such as: format release asan
# PVT_MODELS may name a folder of further *.glb models to test with.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all_stages=(format release rooms shared core asan tsan tidy)
jobs="$(nproc)"
log_folder=build/logs
long=0
stages=()
for argument in "$@"; do
    case "$argument" in
    --long) long=1 ;;
    -h | --help)
        sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
        echo "stages: ${all_stages[*]}"
        exit 0
        ;;
    *)
        if [[ " ${all_stages[*]} " != *" $argument "* ]]; then
            echo "test: no stage $argument; there are: ${all_stages[*]}" >&2
            exit 1
        fi
        stages+=("$argument")
        ;;
    esac
done
if [ "${#stages[@]}" = 0 ]; then
    stages=("${all_stages[@]}")
fi

# Drivers would write their compiled shaders into the home folder.
export MESA_SHADER_CACHE_DISABLE=true
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1"
export TSAN_OPTIONS="halt_on_error=1"
export PVT_LONG="$long"

build_preset() { # preset
    # The demo leaves the tests out of its build.
    cmake --preset "$1" -DPARAVENT_TESTS=ON && cmake --build "build/$1" --parallel "$jobs"
}

run_ctest() { # preset [ctest's options]
    local options=("${@:2}")
    if [ "$long" = 0 ]; then
        options+=(-LE long)
    fi
    ctest --test-dir "build/$1" --output-on-failure --parallel "$jobs" --no-tests=error \
        "${options[@]}"
}

stage_format() { scripts/format.sh; }
stage_release() { build_preset release && run_ctest release; }
stage_rooms() { scripts/check-rooms.sh build/release; }
# The command's other tests have seen the same code in the release.
stage_shared() {
    build_preset shared && run_ctest shared -R '^(package_|cli_(usage|startup|outputs|stats)$)'
}
stage_core() { build_preset core && run_ctest core -E '^header_'; }
# What compares runs of the command with each other, or measures it, need not run in slow motion.
stage_asan() { build_preset asan && run_ctest asan -E '^cli_(threads|bench_speed)$'; }
# test_golden runs every stage and the whole build on one, two and four threads, and
# test_sheet_threads does so where there is no inside.
stage_tsan() { build_preset tsan && run_ctest tsan -E '^test_(build|sheets)$'; }
stage_tidy() { BUILD=build/release scripts/tidy.sh; }

scripts/setup.sh test || exit
mkdir -p "$log_folder"
passed=0
failed=0
summary=""

# A stage counts with each of its tests; a stage without, and one that cannot be built, as one.
count_stage() { # log, exit code
    local line bad total
    line="$(grep -E 'tests passed, [0-9]+ tests? failed out of' "$1" | tail -n 1)"
    if [ -n "$line" ]; then
        bad="$(sed -E 's/.* ([0-9]+) tests? failed out of.*/\1/' <<<"$line")"
        total="$(sed -E 's/.* out of ([0-9]+).*/\1/' <<<"$line")"
        stage_passed=$((total - bad))
        stage_failed=$bad
    else
        stage_passed=$(($2 == 0))
        stage_failed=$(($2 != 0))
    fi
    if [ "$2" != 0 ] && [ "$stage_failed" = 0 ]; then
        stage_failed=1
    fi
}

for stage in "${stages[@]}"; do
    log="$log_folder/$stage.log"
    echo "== $stage"
    began=$SECONDS
    "stage_$stage" >"$log" 2>&1
    code=$?
    count_stage "$log" "$code"
    passed=$((passed + stage_passed))
    failed=$((failed + stage_failed))
    if [ "$code" != 0 ]; then
        tail -n 200 "$log"
        echo "== $stage failed; all of its output is in $log"
    fi
    summary+="$(printf '%-8s %4d s  %4d passed  %d failed' "$stage" $((SECONDS - began)) \
        "$stage_passed" "$stage_failed")"$'\n'
done

echo
printf '%s' "$summary"
echo "$SECONDS s in all"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
