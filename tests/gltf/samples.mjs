// Files that the test makes for the program: a cube with a look, alone and within nodes, skins and morph targets.
import { deflateSync } from "node:zlib";

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let k = 0; k < 8; ++k) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return ~crc >>> 0;
}

/** A PNG of colour. rows: lists of [red, green, blue]. */
export function png(rows) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type, "latin1"), data]);
    const ends = Buffer.alloc(8);
    ends.writeUInt32BE(data.length, 0);
    ends.writeUInt32BE(crc32(body), 4);
    return Buffer.concat([ends.subarray(0, 4), body, ends.subarray(4)]);
  };
  const header = Buffer.from([0, 0, 0, rows[0].length, 0, 0, 0, rows.length, 8, 2, 0, 0, 0]);
  const pixels = Buffer.from(rows.flatMap(row => [0, ...row.flat()]));
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", header),
                        chunk("IDAT", deflateSync(pixels)), chunk("IEND", Buffer.alloc(0))]);
}

/** The cube from -0.5 to 0.5, `cells` by `cells` squares a side: places, normals, texture coordinates, triangles. */
export function cube(cells) {
  const points = [], normals = [], uvs = [], faces = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      const first = points.length;
      for (let j = 0; j <= cells; ++j) {
        for (let i = 0; i <= cells; ++i) {
          const point = [0, 0, 0], normal = [0, 0, 0];
          point[axis] = 0.5 * side;
          point[(axis + 1) % 3] = side * (i / cells - 0.5);
          point[(axis + 2) % 3] = j / cells - 0.5;
          normal[axis] = side;
          points.push(point);
          normals.push(normal);
          uvs.push([i / cells, j / cells]);
        }
      }
      for (let j = 0; j < cells; ++j) {
        for (let i = 0; i < cells; ++i) {
          const a = first + j * (cells + 1) + i, b = a + cells + 1;
          faces.push([a, a + 1, b + 1], [a, b + 1, b]);
        }
      }
    }
  }
  return { points, normals, uvs, faces };
}

export function cubeObj({ points, normals, uvs, faces }) {
  const corner = v => `${v + 1}/${v + 1}/${v + 1}`;
  const half = faces.length / 2;
  return ["mtllib cube.mtl", ...points.map(p => `v ${p.join(" ")}`), ...uvs.map(t => `vt ${t.join(" ")}`),
          ...normals.map(n => `vn ${n.join(" ")}`), "o lower", "usemtl tiles",
          ...faces.slice(0, half).map(f => `f ${f.map(corner).join(" ")}`), "o upper", "usemtl glass",
          ...faces.slice(half).map(f => `f ${f.map(corner).join(" ")}`), ""].join("\n");
}

/** A glTF file while it is put together, its numbers in one buffer. */
export class Gltf {
  root = { asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [] }], nodes: [], meshes: [], accessors: [],
           bufferViews: [], buffers: [{ byteLength: 0 }] };
  data = Buffer.alloc(0);

  /** rows: numbers, or lists of 2, 3, 4 or 16. */
  accessor(rows, array = Float32Array, { target = 34962, bounds = false, ...more } = {}) {
    const width = rows[0].length ?? 1;
    const types = { 1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4" };
    const components = new Map([[Int8Array, 5120], [Uint8Array, 5121], [Int16Array, 5122], [Uint16Array, 5123],
                                [Uint32Array, 5125], [Float32Array, 5126]]);
    const size = width * array.BYTES_PER_ELEMENT, stride = target === 34962 ? Math.ceil(size / 4) * 4 : size;
    const bytes = Buffer.alloc(stride * rows.length);
    rows.forEach((row, r) => {
      const numbers = array.from(row.length ? row : [row]);
      Buffer.from(numbers.buffer).copy(bytes, r * stride);
    });
    const view = { buffer: 0, byteOffset: this.data.length, byteLength: bytes.length };
    if (target) view.target = target;
    if (stride !== size) view.byteStride = stride;
    this.data = Buffer.concat([this.data, bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    this.root.bufferViews.push(view);
    const entry = { bufferView: this.root.bufferViews.length - 1, componentType: components.get(array),
                    count: rows.length, type: types[width], ...more };
    if (bounds) {
      const columns = [...Array(width).keys()].map(k => rows.map(row => array.from([row[k]])[0]));
      entry.min = columns.map(c => c.reduce((a, b) => Math.min(a, b)));
      entry.max = columns.map(c => c.reduce((a, b) => Math.max(a, b)));
    }
    return this.root.accessors.push(entry) - 1;
  }

  primitive({ points, normals, uvs, faces }) {
    return { attributes: { POSITION: this.accessor(points, Float32Array, { bounds: true }),
                           NORMAL: this.accessor(normals), TEXCOORD_0: this.accessor(uvs) },
             indices: this.accessor(faces.flat(), Uint16Array, { target: 34963 }) };
  }

  mesh(primitive, more = {}) { return this.root.meshes.push({ primitives: [primitive], ...more }) - 1; }
  node(node, top = true) {
    const number = this.root.nodes.push(node) - 1;
    if (top) this.root.scenes[0].nodes.push(number);
    return number;
  }

  glb() {
    this.root.buffers[0].byteLength = this.data.length;
    const text = Buffer.from(JSON.stringify(this.root));
    const json = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, " ")]);
    const head = Buffer.alloc(20), between = Buffer.alloc(8);
    head.write("glTF");
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(28 + json.length + this.data.length, 8);
    head.writeUInt32LE(json.length, 12);
    head.write("JSON", 16);
    between.writeUInt32LE(this.data.length, 0);
    between.write("BIN\0", 4, "latin1");
    return Buffer.concat([head, json, between, this.data]);
  }

  /** The text of a .gltf whose numbers are in a file of their own. */
  text(uri) {
    this.root.buffers[0] = { byteLength: this.data.length, uri };
    return JSON.stringify(this.root);
  }
}

/** The cube's two nodes share a mesh that morphs; a third is skinned; one carries tangents, one colours. */
export function cubesOfAllKinds(shape, image) {
  const gltf = new Gltf();
  gltf.root.materials = [{ name: "tiles", pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
  gltf.root.textures = [{ source: 0 }];
  const imageView = gltf.root.bufferViews.push({ buffer: 0, byteOffset: 0, byteLength: image.length }) - 1;
  gltf.data = Buffer.concat([image, Buffer.alloc((4 - (image.length % 4)) % 4)]);
  gltf.root.images = [{ bufferView: imageView, mimeType: "image/png" }];

  const plain = gltf.primitive(shape);
  plain.material = 0;
  plain.targets = [{ POSITION: gltf.accessor(shape.points.map(p => [0, 0, 0.1 * p[2]]), Float32Array, { bounds: true }) }];
  const shared = gltf.mesh(plain, { name: "shared", weights: [0.5] });
  gltf.node({ mesh: shared, name: "left", translation: [-2.002, 0, 0] });
  gltf.node({ mesh: shared, name: "right", translation: [2, 0, 0], scale: [-1, 1, 1] });

  const skinned = gltf.primitive(shape);
  skinned.attributes.JOINTS_0 = gltf.accessor(shape.points.map(() => [0, 1, 0, 0]), Uint8Array);
  skinned.attributes.WEIGHTS_0 = gltf.accessor(shape.points.map(p => [0.5 - p[2], 0.5 + p[2], 0, 0]));
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const upper = gltf.node({ name: "upper bone", translation: [0, 0, 0.25] }, false);
  const lower = gltf.node({ name: "lower bone", children: [upper] });
  gltf.root.skins = [{ joints: [lower, upper], skeleton: lower,
                       inverseBindMatrices: gltf.accessor([identity, identity], Float32Array, { target: 0 }) }];
  gltf.node({ mesh: gltf.mesh(skinned), skin: 0, name: "skinned" });

  const tangents = gltf.primitive(shape);
  tangents.attributes.TANGENT = gltf.accessor(shape.normals.map(n => [n[1], n[2], n[0], 1]));
  tangents.attributes.COLOR_0 = gltf.accessor(shape.points.map(p => [0.5 + p[0], 0.5, 0.5 - p[1], 1]));
  const child = gltf.node({ mesh: gltf.mesh(tangents), name: "coloured" }, false);
  gltf.node({ name: "turned", children: [child], translation: [0, 3, 0],
              rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2] });
  return gltf;
}
