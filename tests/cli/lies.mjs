// node lies.mjs FOLDER: files that contradict themselves, one a row of the table below, and a list
// of them with the exit code and the text that the command owes to each.
import { writeFileSync } from "node:fs";

const folder = process.argv[2];
const positions = [];
for (let i = 0; i < 8; ++i) positions.push(i & 1, (i >> 1) & 1, i >> 2);
const indices = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
// The cube by Draco 1.5.5, by edges and without loss, as tests/unit/draco_encoder.cpp makes it.
const draco = Buffer.from(
    "RFJBQ08CAgEBAAAACAwBCwAAA19LFQEBEP8CNUECAAAA/wAAAQQJAQAAAAEACQMAAQAAAAAAAAAAAAAA" +
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACAPwAAgD8AAIA/AACAPwAAAAAAAIA/AACAPwAA" +
    "AAAAAIA/AAAAAAAAgD8AAIA/AAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAACAPwAAAAAAAAAAAAAAAA==",
    "base64");

// A cube twice, as two primitives: buffer views 0 and 1 are the first one's, 2 and 3 the second's.
function makeCubes() {
    const bytes = Buffer.concat([Buffer.from(new Float32Array(positions).buffer),
        Buffer.from(new Uint16Array(indices).buffer)]);
    const view = (byteOffset, byteLength) => ({ buffer: 0, byteOffset, byteLength });
    const places = (bufferView) => ({ bufferView, componentType: 5126, count: 8, type: "VEC3",
        min: [0, 0, 0], max: [1, 1, 1] });
    const corners = (bufferView) => ({ bufferView, componentType: 5123, count: 36,
        type: "SCALAR" });
    return {
        bytes: Buffer.concat([bytes, bytes]),
        asset: { version: "2.0" },
        scene: 0,
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0 }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 },
            { attributes: { POSITION: 2 }, indices: 3 }] }],
        bufferViews: [view(0, 96), view(96, 72), view(168, 96), view(264, 72)],
        accessors: [places(0), corners(1), places(2), corners(3)],
    };
}

// More bytes, in a buffer view of their own, whose number is returned.
function addView(file, bytes) {
    file.bufferViews.push({ buffer: 0, byteOffset: file.bytes.length, byteLength: bytes.length });
    file.bytes = Buffer.concat([file.bytes, bytes, Buffer.alloc(-bytes.length & 3)]);
    return file.bufferViews.length - 1;
}

function addAccessor(file, numbers, type, size) {
    const bufferView = addView(file, Buffer.from(new Float32Array(numbers).buffer));
    file.accessors.push({ bufferView, componentType: 5126, count: numbers.length / size, type });
    return file.accessors.length - 1;
}

// Some positions of the second cube are replaced by themselves.
function addSparse(file, places = [0, 2, 4, 6]) {
    const values = places.flatMap((place) => [0, 1, 2].map((k) => positions[3 * place + k] ?? 0));
    file.accessors[2].sparse = {
        count: places.length,
        indices: { bufferView: addView(file, Buffer.from(places)), componentType: 5121 },
        values: { bufferView: addView(file, Buffer.from(new Float32Array(values).buffer)) },
    };
    return file.accessors[2].sparse;
}

const instancing = "EXT_mesh_gpu_instancing";
function addInstances(file, attributes) {
    file.extensionsRequired = [instancing];
    file.nodes[0].extensions = { [instancing]: { attributes } };
}

const meshopt = "EXT_meshopt_compression";
function packView(file, change) {
    file.extensionsRequired = [meshopt];
    file.bufferViews[2].extensions = { [meshopt]: { buffer: 0, byteOffset: 0, byteLength: 96,
        byteStride: 12, count: 8, mode: "ATTRIBUTES", ...change } };
}

const dracoName = "KHR_draco_mesh_compression";
function addDraco(file, required = true) {
    file[required ? "extensionsRequired" : "extensionsUsed"] = [dracoName];
    const extension = { bufferView: addView(file, draco), attributes: { POSITION: 1 } };
    file.meshes[0].primitives[1].extensions = { [dracoName]: extension };
    if (required) {
        delete file.accessors[2].bufferView;
        delete file.accessors[3].bufferView;
    }
    return extension;
}

const second = "meshes[0].primitives[1]";
const ofNode = `nodes[0].extensions.${instancing}`;
const ofView = `bufferViews[2].extensions.${meshopt}`;
const ofDraco = `${second}.extensions.${dracoName}`;
// Name, exit code, what stderr has to hold, and what is wrong. The first ones are true: they are
// read, which shows that each of the others is refused for its lie alone.
const table = [
    ["plain", 0, "", () => {}],
    ["sparse", 0, "", (f) => addSparse(f)],
    ["instances", 0, "", (f) => addInstances(f, {
        TRANSLATION: addAccessor(f, [0, 0, 0, 5, 0, 0], "VEC3", 3) })],
    ["draco", 0, "", (f) => addDraco(f)],
    ["draco_beside_plain", 0, "", (f) => addDraco(f, false)],
    ["quantized", 0, "", (f) => {
        f.extensionsRequired = ["KHR_mesh_quantization"];
        const shorts = positions.flatMap((p, i) => i % 3 === 2 ? [p, 0] : [p]);
        f.accessors[2].bufferView = addView(f, Buffer.from(new Int16Array(shorts).buffer));
        f.bufferViews[4].byteStride = 8;
        f.accessors[2].componentType = 5122;
    }],

    ["unknown_extension", 3, "ACME_cubes", (f) => { f.extensionsRequired = ["ACME_cubes"]; }],
    ["buffer_too_long", 2, "buffers[0].byteLength", (f) => { f.claim = 4000; }],
    ["view_too_long", 2, "bufferViews[2] reaches", (f) => { f.bufferViews[2].byteLength = 1000; }],
    ["view_behind_the_end", 2, "bufferViews[2] reaches",
        (f) => { f.bufferViews[2].byteOffset = 5000; }],
    ["stride_below_element", 2, "bufferViews[2].byteStride is 8",
        (f) => { f.bufferViews[2].byteStride = 8; }],
    ["stride_beyond_view", 2, "accessors[2] counts 8 elements of 12 bytes, 16 apart",
        (f) => { f.bufferViews[2].byteStride = 16; }],
    ["count_beyond_view", 2, "accessors[2] counts 9", (f) => { f.accessors[2].count = 9; }],
    ["count_negative", 2, "accessors[2].count is -8", (f) => { f.accessors[2].count = -8; }],
    ["count_without_data", 6, "accessors[2] counts 4000000000", (f) => {
        f.accessors[2].count = 4e9;
        f.accessors[2].bufferView = undefined;
    }],
    ["index_out_of_range", 2, `${second}.indices: element 5 (of accessors[3]) is 99`,
        (f) => f.bytes.writeUInt16LE(99, 264 + 10)],
    ["range_above", 2, `${second}.attributes.POSITION: element 2 has y = 1, but accessors[2].max`,
        (f) => { f.accessors[2].max = [1, 0.5, 1]; }],
    ["range_below", 2, `${second}.attributes.POSITION: element 0 has z = 0, but accessors[2].min`,
        (f) => { f.accessors[2].min = [0, 0, 0.1]; }],
    ["range_turned_round", 2, `${second}.attributes.POSITION: accessors[2].min[0] is 2`,
        (f) => { f.accessors[2].min = [2, 0, 0]; }],
    ["range_of_two_numbers", 2, `${second}.attributes.POSITION: accessors[2].max has 2 numbers`,
        (f) => { f.accessors[2].max = [1, 1]; }],
    ["range_of_words", 2, "accessors[2].max", (f) => { f.accessors[2].max = "large"; }],
    ["positions_quantized_in_secret", 2, `${second}.attributes.POSITION is a VEC3 of SHORT`,
        (f) => { f.accessors[2].componentType = 5122; }],
    ["positions_too_wide", 2, `${second}.attributes.POSITION is a VEC3 of UNSIGNED_INT`, (f) => {
        f.extensionsRequired = ["KHR_mesh_quantization"];
        f.accessors[2].componentType = 5125;
    }],
    ["positions_flat", 2, `${second}.attributes.POSITION is a VEC2`,
        (f) => { f.accessors[2].type = "VEC2"; }],
    ["indices_signed", 2, `${second}.indices are a SCALAR of SHORT`,
        (f) => { f.accessors[3].componentType = 5122; }],

    ["sparse_count", 2, "accessors[2].sparse.count is 9", (f) => { addSparse(f).count = 9; }],
    ["sparse_beyond_values", 2, "accessors[2].sparse.count is 5",
        (f) => { addSparse(f).count = 5; }],
    ["sparse_out_of_range", 2, "accessors[2].sparse: index 3 is 8",
        (f) => addSparse(f, [0, 2, 4, 8])],
    ["sparse_falling", 2, "accessors[2].sparse: index 2 is 1", (f) => addSparse(f, [0, 2, 1, 4])],
    ["sparse_float_index", 2, "accessors[2].sparse.indices.componentType is 5124",
        (f) => { addSparse(f).indices.componentType = 5124; }],
    ["sparse_without_view", 2, "accessors[2].sparse.values.bufferView is 77",
        (f) => { addSparse(f).values.bufferView = 77; }],

    ["instances_unequal", 2, `${ofNode}: its attributes have 2 and 1 elements`,
        (f) => addInstances(f, { TRANSLATION: addAccessor(f, [0, 0, 0, 5, 0, 0], "VEC3", 3),
            SCALE: addAccessor(f, [1, 1, 1], "VEC3", 3) })],
    ["instances_flat", 2, `${ofNode}.attributes.SCALE is a VEC2`,
        (f) => addInstances(f, { SCALE: addAccessor(f, [1, 1], "VEC2", 2) })],
    ["instances_nowhere", 2, `${ofNode}.attributes.ROTATION is 44`,
        (f) => addInstances(f, { ROTATION: 44 })],

    ["meshopt_damaged", 2, `${ofView}: the compressed data is damaged`, (f) => packView(f, {})],
    ["meshopt_count", 2, `${ofView}: 9 elements of 12 bytes`, (f) => packView(f, { count: 9 })],
    ["meshopt_stride", 2, `${ofView}: 16 elements of 6 bytes`,
        (f) => packView(f, { count: 16, byteStride: 6 })],
    ["meshopt_range", 2, `${ofView} reaches from byte 300 to 396`,
        (f) => packView(f, { byteOffset: 300 })],
    ["meshopt_mode", 2, `${ofView}.mode is "SQUEEZED"`, (f) => packView(f, { mode: "SQUEEZED" })],
    ["meshopt_filter", 2, `${ofView}: 8 elements of 12 bytes do not fit`,
        (f) => packView(f, { filter: "QUATERNION" })],

    ["draco_triangles", 2, `${ofDraco} says that it holds 12 triangles, but accessors[3] counts 33`,
        (f) => { addDraco(f); f.accessors[3].count = 33; }],
    ["draco_points", 2, `${ofDraco} holds 8 points and 12 triangles, but`,
        (f) => { addDraco(f); f.accessors[2].count = 9; }],
    ["draco_many_points", 6, ofDraco, (f) => {
        addDraco(f);
        f.accessors[2].count = 4e9;
        f.accessors[3].componentType = 5125;
    }],
    ["draco_range", 2, `${second}.attributes.POSITION: element`,
        (f) => { addDraco(f); f.accessors[2].max = [1, 0.5, 1]; }],
    ["draco_id", 2, `${ofDraco}.attributes.POSITION is 5`,
        (f) => { addDraco(f).attributes.POSITION = 5; }],
    ["draco_kind", 2, `${ofDraco}.attributes.POSITION: its data has 1 components`,
        (f) => { addDraco(f).attributes.POSITION = 0; }],
    ["draco_noise", 2, `${ofDraco}: its buffer view holds no Draco data`,
        (f) => { addDraco(f).bufferView = 0; }],
    ["draco_damaged", 2, `${ofDraco}: Draco refuses the data`, (f) => {
        addDraco(f);
        f.bytes.fill(0xff, f.bytes.length - 160, f.bytes.length - 140);
    }],
    ["draco_cut", 2, `${ofDraco}: Draco refuses the data`, (f) => {
        addDraco(f);
        f.bufferViews[4].byteLength = 100;
    }],
    ["draco_view", 2, "bufferViews[4] reaches", (f) => {
        addDraco(f);
        f.bufferViews[4].byteLength = 1e6;
    }],
];

const list = table.map(([name, exit, text, change]) => {
    const { bytes, claim, ...json } = ((file) => { change(file); return file; })(makeCubes());
    json.buffers = [{ byteLength: claim ?? bytes.length,
        uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }];
    writeFileSync(`${folder}/${name}.gltf`, JSON.stringify(json));
    return `${exit}\t${name}.gltf\t${text}\n`;
});
writeFileSync(`${folder}/list`, list.join(""));
