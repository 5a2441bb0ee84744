// The core in WebAssembly does what the native program does: the same mesh, annotation and handles give the same vertices.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { check, diagonal, finish, folder, largestDifference, orbifit, plyFile } from "./support.mjs";

const wasm = process.env.EDITOR_WASM;
const { default: createModule } = await import(pathToFileURL(join(wasm, "editor_core.mjs")).href);
const module = await createModule({ wasmBinary: readFileSync(join(wasm, "editor_core.wasm")) });

/** Calls with a string as the second argument. */
function withText(call, session, text, ...rest) {
  const bytes = Buffer.from(text + "\0");
  const at = module._editor_allocate(bytes.length);
  module.HEAPU8.set(bytes, at);
  const result = call(session, at, ...rest);
  module._editor_release(at);
  return result;
}
function withFile(call, session, name, data, ...rest) {
  module.FS.writeFile("/" + name, data);
  return withText(call, session, "/" + name, ...rest);
}
const expected = result => {
  if (result < 0) throw new Error(module.UTF8ToString(module._editor_error()));
  return result;
};

const models = [
  { name: "chair", mode: "floating", parameters: [],
    handles: [{ name: "seat", centre: [0, 0, 0.43], radius: 0.2, translation: [0, 0, 0.06] },
              { name: "one foot", centre: [0.23, 0.23, 0], radius: 0.08, translation: [0.02, 0.02, 0], scale: 1.2,
                rotation: { axis: [0, 0, 1], degrees: 20 } }] },
  { name: "chair", mode: "moving", parameters: [],
    handles: [{ name: "one foot", centre: [0.23, 0.23, 0], radius: 0.08, translation: [0.04, 0.02, 0] }] },
  { name: "wheel", mode: "fixed", parameters: [], handles: null }
];
const modes = ["fixed", "floating", "moving"];

for (const { name, mode, handles } of models) {
  orbifit("generate", name, "-o", ".", "--quiet");
  const mesh = `${name}.ply`;
  orbifit("detect", mesh, "-o", `${name}.json`, "--quiet");
  const rest = plyFile(mesh);
  const size = diagonal(rest);
  const list = handles ?? [{ name: "rim", centre: [...rest.slice(0, 3)], radius: 0.1 * size,
                             translation: [0.05 * size, 0, 0.02 * size] }];
  writeFileSync(join(folder, "handles.json"), JSON.stringify({ alpha: 100, iterations: 10, handles: list }));
  const native = orbifit("deform", mesh, `${name}.json`, "--handles", "handles.json", "--mode", mode, "-o", "out.ply",
                         "--json", "--quiet", "--threads", "1");
  const out = plyFile("out.ply");

  const session = module._editor_new();
  expected(withFile(module._editor_read_mesh, session, mesh, readFileSync(join(folder, mesh))));
  expected(withFile(module._editor_read_annotation, session, "a.json", readFileSync(join(folder, `${name}.json`)), 0));
  expected(module._editor_build_basis(session, modes.indexOf(mode), 0, 0, 0, 0, 0));
  expected(withFile(module._editor_set_handles, session, "handles.json", readFileSync(join(folder, "handles.json"))));
  const numbers = module._editor_allocate(8 * 1024);
  const motions = list.flatMap((handle, number) => {
    expected(module._editor_handle_centroid(session, number, numbers));
    const centroid = [...new Float64Array(module.HEAPU8.buffer, numbers, 3)];
    const angle = (handle.rotation?.degrees ?? 0) * Math.PI / 180;
    const scale = handle.scale ?? 1;
    const [c, s] = [scale * Math.cos(angle), scale * Math.sin(angle)]; // about z
    const rows = [[c, -s, 0], [s, c, 0], [0, 0, scale]];
    return rows.flatMap((row, k) => [...row, centroid[k] + (handle.translation?.[k] ?? 0) -
                                              row.reduce((sum, entry, j) => sum + entry * centroid[j], 0)]);
  });
  new Float64Array(module.HEAPU8.buffer, numbers, motions.length).set(motions);
  let best = Infinity;
  for (let i = 0; i < 5; ++i) {
    expected(module._editor_solve(session, 0, numbers, list.length, 10, 0, numbers + 4096));
    const [solve, lift] = new Float64Array(module.HEAPU8.buffer, numbers + 4096, 2);
    best = Math.min(best, solve + lift);
  }
  const shown = new Float64Array(module.HEAPU8.buffer, module._editor_vertices(session, 0), rest.length);
  const difference = largestDifference(shown, out) / size;
  check(largestDifference(rest, out) > 0.01 * size, `${name}, ${mode}: the edit moves the mesh`);
  check(difference < 1e-6, `${name}, ${mode}: the native program's vertices to ${difference.toExponential(1)} of the diagonal`);
  console.log(`       solve and lift: ${best.toFixed(2)} ms, native ${(native.milliseconds.solve + native.milliseconds.lift).toFixed(2)} ms (once)`);

  // A basis that the native program built.
  orbifit("subspace", mesh, `${name}.json`, "--mode", mode, "-o", "stored.basis", "--quiet");
  const read = withFile(module._editor_read_basis, session, "stored.basis", readFileSync(join(folder, "stored.basis")));
  check(read === 0, `${name}, ${mode}: reads a basis that the native program stored` +
        (read ? `: ${module.UTF8ToString(module._editor_error())}` : ""));
  module._editor_release(numbers);
  module._editor_free(session);
}

const session = module._editor_new();
check(withFile(module._editor_read_mesh, session, "no.ply", "this is no mesh") < 0 &&
      module.UTF8ToString(module._editor_error()).includes("no.ply"), "refuses what is no mesh, by its name");
finish();
