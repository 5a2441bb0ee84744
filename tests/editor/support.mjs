// What the tests in JavaScript have in common: the native program, its files, and checks.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const folder = mkdtempSync(join(tmpdir(), "orbifit-editor-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/** Runs the native program in the folder; its JSON, where --json is among the arguments. */
export function orbifit(...words) {
  const output = execFileSync(process.env.ORBIFIT, words, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 28,
                                                            stdio: ["ignore", "pipe", "ignore"] });
  return words.includes("--json") ? JSON.parse(output) : output;
}

let failures = 0;
export function check(holds, what) {
  console.log(`${holds ? "ok    " : "FAILED"} ${what}`);
  if (!holds) ++failures;
}
export function finish() {
  console.log(failures ? `${failures} failed` : "all passed");
  process.exit(failures ? 1 : 0);
}

/** Vertices of a PLY as the program writes it: binary little endian, x, y and z first, in double. */
export function plyVertices(bytes) {
  const text = Buffer.from(bytes).toString("latin1");
  const end = text.indexOf("end_header\n") + 11;
  const header = text.slice(0, end);
  const count = Number(/element vertex (\d+)/.exec(header)[1]);
  const properties = header.split("element face")[0].match(/property double \w+/g).length;
  const result = new Float64Array(3 * count);
  const view = new DataView(bytes.buffer, bytes.byteOffset + end);
  for (let v = 0; v < count; ++v) {
    for (let k = 0; k < 3; ++k) result[3 * v + k] = view.getFloat64(8 * (properties * v + k), true);
  }
  return result;
}
export const plyFile = name => plyVertices(readFileSync(join(folder, name)));

export function largestDifference(a, b) {
  if (a.length !== b.length) return Infinity;
  let most = 0;
  for (let i = 0; i < a.length; ++i) most = Math.max(most, Math.abs(a[i] - b[i]));
  return most;
}
export function diagonal(vertices) {
  let sum = 0;
  for (let k = 0; k < 3; ++k) {
    let low = Infinity, high = -Infinity;
    for (let i = k; i < vertices.length; i += 3) {
      low = Math.min(low, vertices[i]);
      high = Math.max(high, vertices[i]);
    }
    sum += (high - low) ** 2;
  }
  return Math.sqrt(sum);
}
