// Bundles the page: node build.mjs WASM-FOLDER OUT. WASM-FOLDER has editor_core.mjs and editor_core.wasm; OUT becomes the
// page without a mesh. The same sources give the same bytes.
import { readFileSync, mkdirSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";
import { gzip } from "pako";

const here = dirname(fileURLToPath(import.meta.url));
const [folder, out] = process.argv.slice(2).map(argument => resolve(argument));
const source = name => join(here, "src", name);

const options = {
  bundle: true, minify: true, write: false, target: "es2022", charset: "utf8", legalComments: "none", logLevel: "warning",
  absWorkingDir: here, alias: { "editor-core": join(folder, "editor_core.mjs") },
  define: { "import.meta.url": '"file:///"' } // where the module's file would be; the page carries it in itself
};
const bundled = async (entry, more) => {
  const result = await build({ ...options, ...more, entryPoints: [source(entry)] });
  return result.outputFiles[0].text;
};

const worker = await bundled("worker.ts", { format: "iife" });
const workerCode = {
  name: "worker-code",
  setup(setup) {
    setup.onResolve({ filter: /^worker-code$/ }, () => ({ path: "worker-code", namespace: "worker-code" }));
    setup.onLoad({ filter: /.*/, namespace: "worker-code" }, () => ({ contents: worker, loader: "text" }));
  }
};
// As page.html's unpacked() reads it.
const packed = bytes => {
  const zipped = Buffer.from(gzip(bytes, { level: 9, memLevel: 9 }));
  const rest = (4 - zipped.length % 4) % 4;
  const whole = Buffer.concat([zipped, Buffer.alloc(rest)]);
  const letter = digit => String.fromCharCode(digit + 35 === 60 ? 120 : digit + 35);
  const letters = [letter(rest)];
  for (let i = 0; i < whole.length; i += 4) {
    let value = whole.readUInt32BE(i);
    const five = [];
    for (let k = 0; k < 5; ++k, value = Math.floor(value / 85)) five.unshift(letter(value % 85));
    letters.push(...five);
  }
  return letters.join("");
};
const script = packed(Buffer.from(await bundled("main.ts", { format: "iife", plugins: [workerCode] })));
const style = (await bundled("style.css", {})).trim();
const core = packed(readFileSync(join(folder, "editor_core.wasm")));

// Functions, since a text with $ in it would be taken for a pattern.
const page = readFileSync(source("page.html"), "utf8")
  .replace("/*STYLE*/", () => style)
  .replace("/*CORE*/", () => core)
  .replace("/*SCRIPT*/", () => script);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
console.log(`${out}: ${page.length} bytes, of which core ${core.length}, script ${script.length}`);
