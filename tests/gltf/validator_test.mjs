// Khronos' validator finds no error in the glTF files that the program writes. validator_test.mjs ORBIFIT FOLDER, which
// holds node_modules with gltf-validator.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";

import { cube, cubeObj, cubesOfAllKinds, Gltf, png } from "./samples.mjs";

const [program, modules] = process.argv.slice(2);
const { validateBytes } = createRequire(join(modules, "package.json"))("gltf-validator");
const folder = mkdtempSync(join(tmpdir(), "orbifit-gltf-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
let failures = 0;

function fail(text) {
  console.log(`FAILED ${text}`);
  ++failures;
}

function write(name, content) {
  mkdirSync(dirname(join(folder, name)), { recursive: true });
  writeFileSync(join(folder, name), content);
}

function orbifit(line) {
  const result = spawnSync(program, [...line.split(" "), "--quiet"], { cwd: folder, encoding: "utf8" });
  if (result.status !== 0) fail(`orbifit ${line} ended with ${result.status}: ${result.stderr}`);
  return result.status === 0;
}

/** The messages of a file's errors; what it names is looked for beside it. */
async function errorsOf(bytes, name) {
  const report = await validateBytes(new Uint8Array(bytes), {
    uri: name,
    maxIssues: 0,
    externalResourceFunction: uri => new Promise((resolve, reject) => {
      const file = join(dirname(join(folder, name)), decodeURIComponent(uri));
      existsSync(file) ? resolve(new Uint8Array(readFileSync(file))) : reject(new Error(`${uri} is missing`));
    })
  });
  return report.issues.messages.filter(message => message.severity === 0)
    .map(message => `${message.code} at ${message.pointer}: ${message.message}`);
}

/** Runs the program, and has what it writes validated; `known` are codes of errors that the input has as well. */
async function validate(line, name, known = []) {
  if (!orbifit(line)) return;
  const errors = (await errorsOf(readFileSync(join(folder, name)), name))
    .filter(error => !known.some(code => error.startsWith(code)));
  if (errors.length === 0) return console.log(`ok     ${line}`);
  fail(`${line}\n  ${errors.slice(0, 10).join("\n  ")}`);
}

/** What is made for the test has to be right itself. */
async function writeRight(name, content, files = {}) {
  for (const [file, bytes] of Object.entries(files)) write(file, bytes);
  write(name, content);
  for (const error of await errorsOf(Buffer.from(content), name)) fail(`the input ${name}: ${error}`);
}

/** An annotation of the whole mesh with the mirror plane x = 0. */
function mirrorAnnotation(name, mesh) {
  const info = spawnSync(program, ["info", mesh, "--json"], { cwd: folder, encoding: "utf8" });
  const { vertices, faces, diagonal } = JSON.parse(info.stdout);
  const mirror = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];
  write(name, JSON.stringify({
    format: "symmetry-annotation", version: 1, mesh: { vertices, faces, diagonal }, tolerance: 0.005,
    regions: [{ id: 0, name: "whole", group: "Cs", centre: [0, 0, 0], axis: [1, 0, 0], generators: [mirror],
                elements: [identity, mirror], faces: [[0, faces]], parent: null, residual: { rms: 0, max: 0 } }],
    patterns: []
  }));
}

const shape = cube(4);
const image = png([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 0]]]);
const library = "newmtl tiles\nKd 0.8 0.9 1\nmap_Kd tiles.png\nnewmtl glass\nKd 0.1 0.2 0.3\nd 0.5\n";
write("tiles.png", image);
write("cube.mtl", library);
write("cube.obj", cubeObj(shape));
mirrorAnnotation("cube.json", "cube.obj");
write("handles.json", JSON.stringify({ handles: [
  { name: "pulled", centre: [0.5, 0, 0.5], radius: 0.3, translation: [0.2, 0, 0.1] },
  { name: "held", centre: [0, 0, -0.5], radius: 0.3 }] }));

const wrong = new Gltf();
wrong.node({ mesh: wrong.mesh({ attributes: { POSITION: wrong.accessor([[0, 0, 0]]) } }) }); // without bounds
if ((await errorsOf(wrong.glb(), "wrong.glb")).length === 0) fail("the validator finds nothing wrong in a wrong file");

// From other formats.
await validate("convert cube.obj textured.glb", "textured.glb");
await validate("convert textured.glb again.glb", "again.glb");
mkdirSync(join(folder, "other"));
if (orbifit("convert textured.glb other/cube.obj")) await validate("convert other/cube.obj back.glb", "back.glb");
await validate("deform cube.obj cube.json --handles handles.json -o deformed.glb", "deformed.glb");
await validate("symmetrize cube.obj cube.json -o remeshed.glb --remesh", "remeshed.glb");
await validate("convert cube.json regions.glb --mesh cube.obj", "regions.glb");
await validate("convert cube.json instances.glb --mesh cube.obj --as instances", "instances.glb");
for (const format of ["ply", "stl", "off"]) {
  if (orbifit(`convert cube.obj cube.${format}`)) await validate(`convert cube.${format} of-${format}.glb`, `of-${format}.glb`);
}
write("bare/cube.mtl", library);
write("bare/cube.obj", cubeObj(shape));
await validate("convert bare/cube.obj missing.glb", "missing.glb", ["IO_ERROR"]); // names the texture that is missing
write("points.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvn 0 0 0\nvn 3 0 0\nf 1//1 2//2 3//2\nf 1//2 3//2 2//2\n");
await validate("convert points.obj points.glb", "points.glb");
if (orbifit("generate desk_fan -o .")) {
  await validate("convert desk_fan.annotation.json fan.glb --mesh desk_fan.ply --as instances", "fan.glb");
  await validate("convert desk_fan.annotation.json fan-regions.glb --mesh desk_fan.ply", "fan-regions.glb");
}

// Edits of a glTF file in place: the left cube is not quite the mirror image of the right one.
const edits = [["deform", "--handles handles.json"], ["symmetrize", ""]];
await writeRight("kinds.glb", cubesOfAllKinds(shape, image).glb());
const separate = cubesOfAllKinds(shape, image);
await writeRight("kinds.gltf", separate.text("numbers.bin"), { "numbers.bin": separate.data });
for (const ending of ["glb", "gltf"]) {
  mirrorAnnotation(`${ending}.json`, `kinds.${ending}`);
  for (const [command, options] of edits) {
    const output = `${command}.${ending}`;
    await validate(`${command} kinds.${ending} ${ending}.json -o ${output} ${options}`.trim(), output);
  }
  await validate(`convert kinds.${ending} flat-${ending}.glb`, `flat-${ending}.glb`);
}

// Numbers in other than single precision: floats take their place.
const quantised = new Gltf();
quantised.root.extensionsUsed = quantised.root.extensionsRequired = ["KHR_mesh_quantization"];
const scaled = quantised.primitive({ points: [[0, 0, 0]], normals: [[0, 0, 1]], uvs: [[0, 0]], faces: shape.faces });
scaled.attributes = {
  POSITION: quantised.accessor(shape.points.map(p => p.map(x => Math.round(x * 2 * 32767))), Int16Array,
                               { bounds: true, normalized: true }),
  NORMAL: quantised.accessor(shape.normals.map(n => n.map(x => 127 * x)), Int8Array, { normalized: true })
};
quantised.node({ mesh: quantised.mesh(scaled), scale: [0.5, 0.5, 0.5] });
await writeRight("quantised.glb", quantised.glb());
mirrorAnnotation("quantised.json", "quantised.glb");
await validate("deform quantised.glb quantised.json --handles handles.json -o edited-quantised.glb", "edited-quantised.glb");
await validate("convert quantised.glb flat-quantised.glb", "flat-quantised.glb");

// What is written plainly: instances as nodes, sparse accessors filled.
const instanced = new Gltf();
instanced.root.extensionsUsed = instanced.root.extensionsRequired = ["EXT_mesh_gpu_instancing"];
instanced.node({ name: "row", mesh: instanced.mesh(instanced.primitive(shape)), extensions: { EXT_mesh_gpu_instancing: {
  attributes: { TRANSLATION: instanced.accessor([[-3, 0, 0], [0, 0, 0], [3, 0, 0]], Float32Array, { target: 0 }),
                ROTATION: instanced.accessor([[0, 0, 0, 32767], [0, 0, 23170, 23170], [0, 0, 0, 32767]], Int16Array,
                                             { target: 0, normalized: true }) } } } });
const sparse = new Gltf();
const partly = sparse.primitive(shape);
for (const [accessor, value] of [[partly.attributes.POSITION, [0, 0, 0.4]], [partly.attributes.NORMAL, [1, 0, 0]]]) {
  const numbers = [sparse.accessor([7], Uint16Array, { target: 0 }), sparse.accessor([value], Float32Array, { target: 0 })]
    .map(number => sparse.root.accessors[number].bufferView);
  sparse.root.accessors[accessor].sparse = { count: 1, indices: { bufferView: numbers[0], componentType: 5123 },
                                             values: { bufferView: numbers[1] } };
}
sparse.node({ mesh: sparse.mesh(partly) });
for (const [name, gltf] of [["instanced", instanced], ["sparse", sparse]]) {
  await writeRight(`${name}.glb`, gltf.glb());
  mirrorAnnotation(`${name}.json`, `${name}.glb`);
  await validate(`deform ${name}.glb ${name}.json --handles handles.json -o edited-${name}.glb`, `edited-${name}.glb`);
  await validate(`convert ${name}.glb flat-${name}.glb`, `flat-${name}.glb`);
}

console.log(failures ? `${failures} failed` : "all passed");
process.exit(failures ? 1 : 0);
