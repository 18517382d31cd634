// node tscn.mjs SCENE.tscn MODEL.glb [NAME…]: reads a scene by the grammar of Godot's text resources
// with a parser of its own, and checks that it is one that Godot loads, whose occluders bear these
// names, or the model's, and hold, bit for bit, the triangles and the notes of the model of the same
// run, and stand where its nodes do.
import { readFileSync } from "node:fs";
import { strict as assert } from "node:assert";

const [scenePath, modelPath, ...given] = process.argv.slice(2);

// Tokens as VariantParser::get_token knows them: a sign is only part of a number where a digit
// follows it, and a number without a point or exponent is an integer.
function* tokenize(text) {
    const pattern = /\s+|;[^\n]*\n|("(?:[^"\\]|\\[^])*")|(-?[0-9]+(?:\.[0-9]*)?(?:[eE][-+]?[0-9]+)?)|([A-Za-z_][A-Za-z_0-9]*)|([[\](){}:,=/])/y;
    while (pattern.lastIndex < text.length) {
        const from = pattern.lastIndex;
        const found = pattern.exec(text);
        assert(found, `an unknown sign: ${JSON.stringify(text.slice(from, from + 20))}`);
        const [, string, number, word, sign] = found;
        if (string !== undefined) {
            yield { kind: "string", value: string.slice(1, -1).replace(/\\(.)/gs, (_, c) => {
                assert('"\\'.includes(c), `an escape that nothing needs: \\${c}`);
                return c;
            }) };
        } else if (number !== undefined) {
            const isFloat = /[.eE]/.test(number);
            yield { kind: "number", isFloat, text: number,
                value: isFloat ? Number(number) : Number(BigInt(number)) };
        } else if (word !== undefined || sign !== undefined) {
            yield { kind: word === undefined ? "sign" : "word", value: word ?? sign };
        }
    }
}

const tokens = [...tokenize(readFileSync(scenePath, "utf8"))];
let at = 0;
const peek = (value) => tokens[at]?.kind !== "string" && tokens[at]?.value === value;
function take(kind, value = undefined) {
    const token = tokens[at++];
    assert.equal(token?.kind, kind);
    if (value !== undefined) assert.equal(token.value, value);
    return token.value;
}

function parseList(end, parseItem) {
    const items = [];
    while (!peek(end)) {
        if (items.length > 0) take("sign", ",");
        items.push(parseItem());
    }
    take("sign", end);
    return items;
}

function parseValue() {
    const token = tokens[at];
    if (peek("{")) {
        ++at;
        return new Map(parseList("}", () => {
            const key = take("string");
            take("sign", ":");
            return [key, parseValue()];
        }));
    }
    ++at;
    if (token.kind !== "word") {
        assert(token.kind === "string" || token.kind === "number", "a value");
        return token.value;
    }
    take("sign", "(");
    return { type: token.value, items: parseList(")", parseValue) };
}

// [NAME key=value …], then key/path = value until the next bracket.
function parseSection() {
    const section = { fields: {}, properties: {} };
    take("sign", "[");
    section.name = take("word");
    while (!peek("]")) {
        const key = take("word");
        assert(!(key in section.fields), `${key} is given once`);
        take("sign", "=");
        section.fields[key] = parseValue();
    }
    take("sign", "]");
    while (at < tokens.length && !peek("[")) {
        let key = take("word");
        while (peek("/")) {
            take("sign", "/");
            key += `/${take("word")}`;
        }
        take("sign", "=");
        assert(!(key in section.properties), `${key} is set once`);
        section.properties[key] = parseValue();
    }
    return section;
}

function readModel(path) {
    const bytes = readFileSync(path);
    const jsonSize = bytes.readUInt32LE(12);
    const gltf = JSON.parse(bytes.subarray(20, 20 + jsonSize));
    const binary = bytes.subarray(28 + jsonSize);
    const kinds = { 5126: [4, "readFloatLE"], 5125: [4, "readUInt32LE"], 5123: [2, "readUInt16LE"] };
    const read = (index, width) => {
        const accessor = gltf.accessors[index];
        const [size, method] = kinds[accessor.componentType];
        const start = (gltf.bufferViews[accessor.bufferView].byteOffset ?? 0);
        return Array.from({ length: accessor.count * width }, (_, i) =>
            binary[method](start + size * i));
    };
    return gltf.scenes[gltf.scene].nodes.map((index) => {
        const node = gltf.nodes[index];
        const { attributes, indices } = gltf.meshes[node.mesh].primitives[0];
        assert(!node.children && !node.matrix);
        return { name: node.name, mesh: node.mesh, positions: read(attributes.POSITION, 3),
            indices: read(indices, 1), notes: node.extras?.paravent ?? {},
            transform: makeTransform(node) };
    });
}

// Translation, rotation and scale as Godot writes them: three rows, then the origin.
function makeTransform({ translation: t = [0, 0, 0], rotation = [0, 0, 0, 1], scale = [1, 1, 1] }) {
    const [x, y, z, w] = rotation;
    const rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]];
    return [...rows.flatMap((row) => row.map((value, i) => value * scale[i])), ...t];
}

const sections = [];
while (at < tokens.length) sections.push(parseSection());
const [head, ...rest] = sections;
assert.equal(head.name, "gd_scene");
assert.equal(head.fields.format, 3);
assert.deepEqual(head.properties, {});
const resources = rest.filter((section) => section.name === "sub_resource");
const [root, ...nodes] = rest.slice(resources.length);
// Godot reads resources before they are used, and counts one step for each and one for the scene.
assert(rest.slice(0, resources.length).every((section) => section.name === "sub_resource"));
assert.equal(head.fields.load_steps, resources.length + 1);
assert.equal(root.name, "node");
assert.equal(root.fields.type, "Node3D");
assert(!("parent" in root.fields), "the root has no parent");

const model = readModel(modelPath);
const names = given.length > 0 ? given :
    model.map(({ name }) => name.replace(/[.:@/"%]/g, "_"));
assert.equal(nodes.length, model.length);
assert.deepEqual(nodes.map((node) => node.fields.name), names);
assert.equal(new Set(names).size, names.length);
const used = new Set();
nodes.forEach((node, i) => {
    assert.equal(node.name, "node");
    assert.equal(node.fields.type, "OccluderInstance3D");
    assert.equal(node.fields.parent, ".");
    assert(!/[.:@/"%\p{Cc}]/u.test(node.fields.name) && node.fields.name !== "", "a valid name");
    assert.equal(node.properties.occluder.type, "SubResource");
    const resource = resources.find(({ fields }) => fields.id === node.properties.occluder.items[0]);
    assert(/^[A-Za-z0-9_]+$/.test(resource.fields.id), "an id that Godot keeps");
    used.add(resource.fields.id);
    assert.equal(resource.fields.type, "ArrayOccluder3D");
    const { vertices, indices } = resource.properties;
    assert.equal(vertices.type, "PackedVector3Array");
    assert.equal(indices.type, "PackedInt32Array");
    const { positions, indices: wanted, notes, transform } = model[i];
    const placed = node.properties.transform ??
        { type: "Transform3D", items: makeTransform({}) };
    assert.equal(placed.type, "Transform3D");
    assert.equal(placed.items.length, 12);
    const size = Math.max(...transform.map(Math.abs));
    placed.items.forEach((value, k) => assert(Math.abs(value - transform[k]) <= 1e-6 * size));
    assert(positions.length > 0 && wanted.length > 0);
    assert.deepEqual(vertices.items.map(Math.fround), positions);
    assert.deepEqual(indices.items, wanted);
    assert.deepEqual(Object.fromEntries(node.properties["metadata/paravent"] ?? []), notes);
});
assert.equal(used.size, resources.length);
assert.equal(used.size, new Set(model.map(({ mesh }) => mesh)).size);
