// node masked.mjs within FILE.glb X0 Y0 Z0 X1 Y1 Z1: every position lies in the box.
// node masked.mjs score FILE.json KEY AT_LEAST AT_MOST: a number of the first occluder, such as
// uniform.precision, or of the original's, such as original.triangles.
// node masked.mjs image IN.glb OUT.glb URI: the same model, its image elsewhere.
import assert from "node:assert/strict";
import {readFileSync, writeFileSync} from "node:fs";

const [, , verb, path, ...rest] = process.argv;

function readGlb(file) {
    const bytes = readFileSync(file);
    const length = bytes.readUInt32LE(12);
    return {json: JSON.parse(bytes.subarray(20, 20 + length).toString()),
        binary: bytes.subarray(28 + length)};
}

const verbs = {
    within() {
        const {json, binary} = readGlb(path);
        const [low, high] = [rest.slice(0, 3).map(Number), rest.slice(3).map(Number)];
        for (const {primitives} of json.meshes) {
            for (const {attributes} of primitives) {
                const accessor = json.accessors[attributes.POSITION];
                const view = json.bufferViews[accessor.bufferView];
                const begin = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
                assert(accessor.count > 0);
                for (let i = 0; i < 3 * accessor.count; ++i) {
                    const value = binary.readFloatLE(begin + 4 * i);
                    assert(value >= low[i % 3] && value <= high[i % 3], `${i}: ${value}`);
                }
            }
        }
    },
    score() {
        const [key, least, most] = rest;
        const scores = JSON.parse(readFileSync(path, "utf8"));
        let value = key.startsWith("original.") ? scores : scores.occluders[0];
        for (const name of key.split(".")) value = value[name];
        assert(value >= Number(least) && value <= Number(most), `${key} is ${value}`);
    },
    image() {
        const [out, uri] = rest;
        const {json, binary} = readGlb(path);
        json.images = [{uri}];
        const text = Buffer.from(JSON.stringify(json));
        const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
        const words = (...numbers) => Buffer.from(new Uint32Array(numbers).buffer);
        writeFileSync(out, Buffer.concat([
            words(0x46546c67, 2, 28 + padded.length + binary.length, padded.length, 0x4e4f534a),
            padded, words(binary.length, 0x004e4942), binary]));
    },
};
verbs[verb]();
