// The model in three dimensions: the original lit, the occluder laid over it, and where the occluder
// sticks out of the original's silhouette. Nothing moves unless the user does, so that a frame is
// drawn only when something has changed.
import {
    BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, EdgesGeometry, Group,
    HemisphereLight, KeepStencilOp, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
    MeshStandardMaterial, NotEqualStencilFunc, OrthographicCamera, ReplaceStencilOp, Scene,
    AlwaysStencilFunc, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const EDGE_DEGREES = 1;
const VIEW_SIZE = 1.9; // what the shorter side shows; the model's radius is 1

// Positions and indices: two counts, then floats, then indices, in base64.
function decodeMesh(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const [positionCount, triangleCount] = new Uint32Array(bytes.buffer, 0, 2);
    return {
        positions: new Float32Array(bytes.buffer, 8, 3 * positionCount),
        indices: new Uint32Array(bytes.buffer, 8 + 12 * positionCount, 3 * triangleCount),
    };
}

function makeGeometry(mesh) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(mesh.indices, 1));
    return geometry;
}

// A colour for each plane that triangles lie on, so that the panels can be told apart.
function paintPlanes(mesh) {
    const corners = mesh.indices.length;
    const positions = new Float32Array(3 * corners), colours = new Float32Array(3 * corners);
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    const planes = new Map();
    const colour = new Color();
    for (let t = 0; t < corners; t += 3) {
        [a, b, c].forEach((p, k) => p.fromArray(mesh.positions, 3 * mesh.indices[t + k]));
        const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
        const side = [normal.x, normal.y, normal.z].find((x) => Math.abs(x) > 1e-3) < 0 ? -1 : 1;
        const key = [...normal.toArray(), normal.dot(a)].map((x) => Math.round(200 * side * x)).join();
        if (!planes.has(key)) planes.set(key, planes.size);
        colour.setHSL((0.09 + 0.618034 * planes.get(key)) % 1, 0.75, 0.52);
        [a, b, c].forEach((p, k) => {
            p.toArray(positions, 3 * (t + k));
            colour.toArray(colours, 3 * (t + k));
        });
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    return geometry;
}

function wire(geometry, colour) {
    return new Mesh(geometry, new MeshBasicMaterial({
        color: colour, wireframe: true, transparent: true, opacity: 0.5,
    }));
}

// Four layers, drawn one after the other.
function makeOriginal(mesh) {
    const geometry = makeGeometry(mesh);
    const solid = new Mesh(geometry, new MeshStandardMaterial({
        color: 0xb9bcc2, roughness: 0.85, metalness: 0, flatShading: true, side: DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    const mask = new Mesh(geometry, new MeshBasicMaterial({
        side: DoubleSide, colorWrite: false, depthWrite: false, depthTest: false,
        stencilWrite: true, stencilRef: 1, stencilFunc: AlwaysStencilFunc,
        stencilZPass: ReplaceStencilOp,
    }));
    return { solid, mask, lines: wire(geometry, 0x333333) };
}

function makeOccluder(mesh) {
    const geometry = makeGeometry(mesh);
    const panels = new Mesh(paintPlanes(mesh), new MeshBasicMaterial({
        vertexColors: true, transparent: true, opacity: 0.6, side: DoubleSide,
    }));
    const edges = new LineSegments(new EdgesGeometry(panels.geometry, EDGE_DEGREES),
        new LineBasicMaterial({ color: 0x4a2500 }));
    const excess = new Mesh(geometry, new MeshBasicMaterial({
        color: 0x1e50e6, side: DoubleSide, depthTest: false, depthWrite: false,
        stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc,
        stencilZPass: KeepStencilOp,
    }));
    const whole = new Group();
    whole.add(panels, edges);
    return { whole, excess, lines: wire(geometry, 0x000000) };
}

export class Stage {
    constructor(element, originalText, occluderTexts) {
        this.element = element;
        this.renderer = new WebGLRenderer({ antialias: true, stencil: true,
            preserveDrawingBuffer: true });
        this.renderer.autoClear = false;
        this.renderer.setClearColor(0xffffff, 1);
        element.append(this.renderer.domElement);
        this.original = makeOriginal(decodeMesh(originalText));
        this.occluders = occluderTexts.map((text) => makeOccluder(decodeMesh(text)));
        this.chosen = 0;
        this.shown = { original: true, occluder: true, wireframe: false, excess: false };
        this.camera = new OrthographicCamera(-1, 1, 1, -1, -100, 100);
        this.lights = [new HemisphereLight(0xffffff, 0x8a8f98, 1.6),
            new DirectionalLight(0xffffff, 1.8)];
        this.controls = new OrbitControls(this.camera, this.renderer.domElement);
        this.controls.addEventListener("change", () => this.draw());
        new ResizeObserver(() => this.resize()).observe(element);
        this.look([-0.6, -0.35, -0.72]);
        this.resize();
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.element;
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.renderer.setSize(width, height, false);
        const size = VIEW_SIZE / 2 * Math.max(1, height / width);
        Object.assign(this.camera, {
            left: -size * width / height, right: size * width / height, top: size, bottom: -size,
        });
        this.camera.updateProjectionMatrix();
        this.draw();
    }

    // Along `direction`, as the evaluation does: y up, without roll.
    look(direction) {
        const along = new Vector3(...direction).normalize();
        // The controls turn around y and stop before the pole.
        this.camera.up.set(0, 1, 0);
        this.camera.zoom = 1;
        this.controls.target.set(0, 0, 0);
        this.camera.position.copy(along).multiplyScalar(-4);
        this.camera.updateProjectionMatrix();
        this.controls.update();
        this.draw();
    }

    pass(...objects) {
        const scene = new Scene();
        scene.add(...objects, ...this.lights);
        this.lights[1].position.copy(this.camera.position).add(new Vector3(1.5, 2.5, 0));
        this.renderer.render(scene, this.camera);
    }

    // The occluder lies within the original, so that it is drawn over it with depths of its own.
    draw() {
        const { original, shown } = this;
        const occluder = this.occluders[this.chosen];
        this.renderer.clear();
        if (shown.original) this.pass(original.solid);
        if (shown.original && shown.wireframe) this.pass(original.lines);
        this.renderer.clearDepth();
        if (shown.occluder) this.pass(occluder.whole);
        if (shown.occluder && shown.wireframe) this.pass(occluder.lines);
        if (shown.excess) {
            this.pass(original.mask);
            this.pass(occluder.excess);
        }
    }
}
