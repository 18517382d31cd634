#!/usr/bin/env bash
# The page of evaluate --report in a real browser.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
command -v node >/dev/null || skip "needs node to drive the browser"

boulder="$models/boulder.glb"
faces=(0,2,1 0,1,3 1,2,3 2,0,3)
odd='<!--<script>"&.gltf'
node "$here/mesh.mjs" "$odd" -1,0.3,-1 2.4,0.3,-1 0,0.3,1 0,1.6,0 -- "${faces[@]}"
node "$here/mesh.mjs" small.gltf -0.2,0.3,-0.2 0.2,0.3,-0.2 0,0.3,0.2 0,0.6,0 -- "${faces[@]}"
quick=(--views 30 --quads 2000 --pixels 128)

paravent evaluate "$boulder" "$odd" small.gltf "${quick[@]}" --report page.html
if [ "$code" = 3 ]; then
    holds "a build without Node says so" grep -q "built without Node" err
    only "$odd" small.gltf
    [ "$failures" = 0 ] && skip "this build has no page"
    finish
fi
holds "the report is written, not $code" test "$code" = 0
[ "$failures" = 0 ] || finish
expect 1 "cannot go to the standard output" evaluate "$boulder" small.gltf --report -
expect 4 "folder nowhere" evaluate "$boulder" small.gltf --report nowhere/page.html
expect 4 "/dev/full cannot be written" evaluate "$boulder" small.gltf "${quick[@]}" \
    --report /dev/full
only "$odd" small.gltf page.html
paravent evaluate "$boulder" "$odd" small.gltf "${quick[@]}" --report again.html --threads 1
holds "the same bytes for any number of threads" cmp page.html again.html

holds "the page's pictures are valid" node -e '
    const { inflateSync } = require("zlib");
    const page = require("fs").readFileSync("page.html", "utf8");
    const extra = JSON.parse(page.match(/id="extra">([^]*?)<.script>/)[1]);
    for (const uri of extra.pictures.flat()) {
        const png = Buffer.from(uri.split(",")[1], "base64");
        const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
        const data = inflateSync(png.subarray(41, 41 + png.readUInt32BE(33)));
        if (data.length !== (3 * width + 1) * height) process.exit(1);
    }
    process.exit(extra.pictures.length === 2 && extra.pictures[0].length === 12 ? 0 : 1);'

browser="$(command -v chromium || command -v chromium-browser || true)"
[ -n "$browser" ] || skip "needs chromium to open the page"
holds "the page is a page" grep -q '^</html>' page.html
checks=$((checks + 1))
node "$here/report.mjs" "$browser" page.html . 2>problems || fail "in the browser: $(cat problems)"
if [ -n "${PVT_KEEP:-}" ]; then
    cp ./*.png "$PVT_KEEP"
fi
finish
