#!/usr/bin/env bash
# Previews and slices by OpenGL; what is missing is told before the work, with exit code 3.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

boulder="$models/boulder.glb"

# A library that is no library stands for one that is not installed. Which OpenImageIO it is depends
# on the machine that the module was built on.
image_library=libOpenImageIO.so
if [ -n "${PVT_IMAGE_MODULE:-}" ]; then
    image_library="$(objdump -p "$PVT_IMAGE_MODULE" | awk '$2 ~ /^libOpenImageIO\.so/ { print $2 }')"
    holds "the image module names its library" test -n "$image_library"
fi
mkdir broken
for name in libEGL.so.1 libOSMesa.so.8 "$image_library"; do
    : >"broken/$name"
done
LD_LIBRARY_PATH="$PWD/broken" expect 3 "install" generate "$boulder" "${quick[@]}" -o out.glb --slicer osmesa
LD_LIBRARY_PATH="$PWD/broken" expect 3 "install" generate "$boulder" "${quick[@]}" -o out.glb --slicer egl
LD_LIBRARY_PATH="$PWD/broken" expect 3 "install" generate "$boulder" "${quick[@]}" -o out.glb --preview out.png
rm broken/libEGL.so.1 broken/libOSMesa.so.8
LD_LIBRARY_PATH="$PWD/broken" expect 3 "" generate "$boulder" "${quick[@]}" -o out.glb --preview out.png
LD_LIBRARY_PATH="$PWD/broken" expect 0 "" generate "$boulder" "${quick[@]}" -o out.glb --slicer auto
rm -r broken out.glb
only

expect 0 "" generate "$boulder" "${quick[@]}" -o sample.glb --slicer sample
for slicer in egl osmesa; do
    expect 0 "" generate "$boulder" "${quick[@]}" -o "$slicer.glb" --slicer "$slicer"
    holds "$slicer wrote a model" test "$(head -c 4 "$slicer.glb")" = glTF
done
for format in png PNG; do
    expect 0 "" generate "$boulder" "${quick[@]}" -o out.glb --preview "out.$format"
    holds "out.$format is a PNG" test "$(head -c 4 "out.$format" | tail -c 3)" = PNG
    holds "out.$format holds a picture" test "$(stat -c %s "out.$format")" -gt 20000
done
expect 0 "" generate "$boulder" "${quick[@]}" -o out.glb --preview out.png --slicer osmesa
only sample.glb egl.glb osmesa.glb out.glb out.png out.PNG
expect 0 "" ladder "$boulder" -o ladder.glb --views "$here/one_view.txt" --effort fast \
    --errors 0.5,0.9,1.5 --preview ladder.png
holds "a ladder's picture holds its levels" test "$(stat -c %s ladder.png)" -gt 60000
rm ladder.glb ladder.png

# A picture that cannot be written: the model was, and the message says so.
ln -s /dev/full full.png
expect 4 "out.glb was written" generate "$boulder" "${quick[@]}" -o out.glb --preview full.png
finish
