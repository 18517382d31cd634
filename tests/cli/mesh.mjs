// node mesh.mjs FILE.gltf X,Y,Z … -- A,B,C …: a glTF file of these positions and triangles, whose
// node tells how it was made as an occluder's does.
import { writeFileSync } from "node:fs";

const [path, ...words] = process.argv.slice(2);
const split = words.indexOf("--");
const positions = words.slice(0, split).map((word) => word.split(",").map(Number));
const indices = words.slice(split + 1).flatMap((word) => word.split(",").map(Number));
const bytes = Buffer.concat([Buffer.from(new Float32Array(positions.flat()).buffer),
    Buffer.from(new Uint32Array(indices).buffer)]);
const finite = (limit) => [0, 1, 2].map((k) =>
    limit(...positions.map((p) => p[k]).filter(Number.isFinite)));
writeFileSync(path, JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: "made",
        extras: { paravent: { budget: 4, resolution: 64, note: "</script><b>&" } } }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: bytes.length,
        uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
    bufferViews: [{ buffer: 0, byteLength: 12 * positions.length },
        { buffer: 0, byteOffset: 12 * positions.length, byteLength: 4 * indices.length }],
    accessors: [
        { bufferView: 0, componentType: 5126, count: positions.length, type: "VEC3",
            min: finite(Math.min), max: finite(Math.max) },
        { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" }],
}));
