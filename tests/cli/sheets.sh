# Meshes without an inside: the occluder lies on the surface itself, says so, and leaves doors open.
. "$(dirname "$0")/common.sh"
command -v node >/dev/null || exit 77

expect 0 "all panels lie on its surface" generate "$models/hangar.glb" -o hangar.glb \
    --resolution 128 --budget 32 --effort fast --threads 1 --stats stats.json
holds "nothing leaves the surface" test "$(stat_of stats.json outside)" = 0
holds "the stats count what lies on it" test "$(stat_of stats.json surface_polygons)" = \
    "$(stat_of stats.json polygons)"
holds "and say how closely" node -e '
    const s = JSON.parse(require("fs").readFileSync("stats.json"));
    process.exit(s.surface_deviation > 0 && s.surface_deviation < s.error_bound ? 0 : 1)'
holds "so does the summary" grep -q "on surface" out err
expect 0 "" evaluate "$models/hangar.glb" hangar.glb --json score.json
holds "the door, the window and the hole in the roof stay open" node -e '
    const [s] = JSON.parse(require("fs").readFileSync("score.json")).occluders;
    process.exit(s.uniform.precision >= 0.9999 && s.small.precision >= 0.9999 ? 0 : 1)'
holds "most is hidden" node -e '
    const [s] = JSON.parse(require("fs").readFileSync("score.json")).occluders;
    process.exit(s.coverage >= 0.9 ? 0 : 1)'
expect 0 "all panels lie on its surface" generate "$models/hangar.glb" -o again.glb \
    --resolution 128 --budget 32 --effort fast --threads 3
holds "the bytes do not depend on the threads" cmp hangar.glb again.glb
finish
