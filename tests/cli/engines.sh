#!/usr/bin/env bash
# What is written, loaded by engines of the web in a real browser.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
for package in three babylonjs babylonjs-loaders; do
    [ -d "$PVT_NODE_MODULES/$package" ] ||
        skip "no $package in $PVT_NODE_MODULES; scripts/setup.sh test installs it"
done
browser="$(command -v chromium || command -v chromium-browser || true)"
[ -n "$browser" ] || skip "needs chromium"

boulder="$models/boulder.glb"
small=(--views "$here/one_view.txt" --effort fast --errors 0.1,0.2,0.4 --budgets 24,12,6)
expect 0 "" generate "$boulder" "${quick[@]}" -o occluder.glb
expect 0 "" generate "$boulder" "${quick[@]}" -o godot.glb --convention godot
expect 0 "" ladder "$boulder" "${small[@]}" -o linked.glb
expect 0 "" ladder "$boulder" "${small[@]}" -o named.glb --naming suffix
expect 0 "" ladder "$boulder" "${small[@]}" -o both.glb --with-original
[ "$failures" = 0 ] || finish
checks=$((checks + 1))
node "$here/engines.mjs" "$browser" "$PVT_NODE_MODULES" occluder.glb godot.glb linked.glb named.glb \
    both.glb 2>problems || fail "in the browser: $(cat problems)"
finish
