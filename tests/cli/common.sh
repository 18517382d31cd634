# Sourced by every test of the commands. Needs PARAVENT, the program, and PVT_MODELS_FOLDER, the
# models that the project ships; PARAVENT_BENCH is the developers' program, and PVT_NODE_MODULES is
# where npm put the glTF validator and engines of the web.
set -uo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
models="$PVT_MODELS_FOLDER"
quick=(--views "$here/one_view.txt" --resolution 16 --budget 6 --effort fast)
scratch="$(mktemp -d)"
trap 'chmod -R u+w "$scratch"; rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
failures=0
checks=0
code=0
export MESA_SHADER_CACHE_DISABLE=true
unset PARAVENT_MODULE_PATH # the programs beside the one that is tested are looked for by itself

fail() {
    failures=$((failures + 1))
    echo "FAILED: $*" >&2
}

# Runs the command; the exit code is in $code, the streams are in the files out and err.
paravent() {
    "$PARAVENT" "$@" >out 2>err
    code=$?
}

# expect CODE TEXT ARGUMENT...: the exit code, and a text that stderr has. After a failure that is
# not about the results, stdout must be empty.
expect() {
    local wanted="$1" text="$2"
    shift 2
    checks=$((checks + 1))
    paravent "$@"
    # What looks for leaks may itself crash at the end, as threads of a driver of OpenGL go: it has
    # found nothing then, and looks again.
    if grep -qF "LeakSanitizer has encountered a fatal error" err; then
        paravent "$@"
    fi
    if [ "$code" != "$wanted" ]; then
        fail "paravent $*: exit $code instead of $wanted"
        sed 's/^/    /' err >&2
    elif [ -n "$text" ] && ! grep -qF -- "$text" err; then
        fail "paravent $*: stderr has no '$text'"
        sed 's/^/    /' err >&2
    elif [ "$wanted" != 0 ] && [ -s out ]; then
        fail "paravent $*: something was written to stdout"
    fi
}

# holds WHAT COMMAND...: the command succeeds.
holds() {
    local what="$1"
    shift
    checks=$((checks + 1))
    "$@" >/dev/null 2>&1 || fail "$what"
}

# only FILE...: the scratch folder holds these and no more, so that nothing partial was left.
only() {
    local wanted found
    checks=$((checks + 1))
    wanted="$(printf '%s\n' out err "$@" | sort)"
    found="$(ls -A | sort)"
    [ "$wanted" = "$found" ] || fail "files are: $(tr '\n' ' ' <<<"$found")instead of: $wanted"
}

clear_scratch() {
    rm -rf "${scratch:?}"/* "$scratch"/.[!.]*
}

# stat FILE KEY: a field of a stats file, by its path, such as seconds.total.
stat_of() {
    node -e '
        let value = JSON.parse(require("fs").readFileSync(process.argv[1], "utf8"));
        for (const key of process.argv[2].split(".")) value = value[key];
        console.log(value);' "$1" "$2"
}

skip() {
    echo "skipped: $*"
    exit 77
}

finish() {
    if [ "$failures" -gt 0 ]; then
        echo "$failures of $checks checks failed" >&2
        exit 1
    fi
    echo "$checks checks"
}
