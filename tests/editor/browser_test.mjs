// The page in Debian's Chromium, driven as a person would.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { check, diagonal, finish, folder, largestDifference, orbifit, plyFile, plyVertices } from "./support.mjs";

const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
if (!browserPath) {
  console.log("SKIPPED: there is no Chromium");
  process.exit(77);
}
const require = createRequire(join(process.env.EDITOR_MODULES, "package.json"));
const { chromium } = require("playwright-core");
const pictures = process.env.EDITOR_PICTURES; // a folder for screenshots, or none
if (pictures) mkdirSync(pictures, { recursive: true });

orbifit("generate", "chair", "-o", ".", "--quiet");
orbifit("detect", "chair.ply", "-o", "chair.json", "--quiet");
const made = orbifit("edit", "chair.ply", "chair.json", "-o", "chair.html", "--json", "--quiet");
check(made.bytes_without_mesh <= 1.5e6, `the page without a mesh has ${made.bytes_without_mesh} bytes`);
const rest = plyFile("chair.ply");
const size = diagonal(rest);

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--headless", "--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync"]
});
process.on("exit", () => { try { browser.process?.()?.kill(); } catch { /* gone */ } });
const context = await browser.newContext({ viewport: { width: 1300, height: 800 }, acceptDownloads: true });
const page = await context.newPage();
const complaints = [];
page.on("console", message => {
  // What drawing in software has to say of itself is not the page's.
  if (["error", "warning"].includes(message.type()) && !/GL Driver Message|swiftshader/i.test(message.text())) complaints.push(message.text());
});
page.on("pageerror", error => complaints.push(String(error)));

await page.goto(pathToFileURL(join(folder, "chair.html")).href);
await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 60000 });
check(complaints.length === 0, `opens from disk without errors or warnings ${complaints.join("; ")}`);

const picture = async name => {
  const bytes = await page.screenshot();
  if (pictures) writeFileSync(join(pictures, `${name}.png`), bytes);
  return bytes;
};
const settled = async () => {
  await page.waitForFunction(() => !globalThis.orbifit.editor.busy, null, { timeout: 60000 });
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
  await page.waitForFunction(() => globalThis.orbifit.editor.isMeasured, null, { timeout: 60000 });
};
/** What is chosen may have to wait for what the page is at: it is settled once it has been taken up. */
const takenUp = async name => {
  await page.waitForFunction(mode => globalThis.orbifit.editor.info.mode === mode, name, { timeout: 60000 });
  await settled();
};
const chooseMode = async (value, name) => {
  await page.selectOption("#mode", value);
  await takenUp(name);
};
/** All that is asked of the page's editor. */
const ask = (call, argument) => page.evaluate(call, argument);
const shown = async () => Float64Array.from(await ask(() => {
  const { editor } = globalThis.orbifit;
  return [...editor.core.vertices(0, editor.info.vertices)];
}));

// Not blank: many colours where the mesh is.
await settled();
const first = await picture("first");
const colours = await ask(() => {
  const { view } = globalThis.orbifit;
  view.render();
  const gl = view.renderer.getContext();
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const seen = new Set();
  for (let i = 0; i < pixels.length; i += 4) seen.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]);
  return seen.size;
});
check(colours > 50, `the picture is not blank: ${colours} colours, ${first.length} bytes`);

/** A point of the picture, looked for from the bottom or the top, whose orbit has so many points. */
const find = (fromTop, images) => ask(({ fromTop, images }) => {
  const { editor, view } = globalThis.orbifit;
  const box = document.getElementById("canvas").getBoundingClientRect();
  let best = null;
  for (let row = 40; row < box.height / 2 && !best; row += 6) {
    const y = fromTop ? box.top + row : box.bottom - row;
    for (let x = box.left + 40; x < box.right - 40 && !best; x += 6) {
      const pick = editor.core.pick(view.ray(x, y));
      if (pick && editor.core.orbit(pick, 0.02).length >= 3 * images) best = [x, y];
    }
  }
  editor.core.clearOrbit();
  return best;
}, { fromTop, images });

// A point of a front leg that is seen, and of the back, which is held: with one handle alone the chair moves as a whole.
const seen = await find(false, 4);
const back = await find(true, 2);
check(seen !== null, "a foot is seen");
// The largest region that takes the leg to the others.
const id = await ask(([x, y]) => {
  const { editor, view } = globalThis.orbifit;
  const faces = region => region.faces.reduce((sum, run) => sum + run[1], 0);
  return editor.core.regionsOf(editor.core.pick(view.ray(x, y)).face)
    .map(number => editor.regions.find(region => region.id === editor.idOf(number)))
    .filter(region => region.elements.length >= 8).sort((a, b) => faces(b) - faces(a))[0].id;
}, seen);
await page.mouse.move(...seen);
await settled();
const hover = await ask(() => ({ dots: globalThis.orbifit.view.orbitDots.count, planes: globalThis.orbifit.view.overlay.children.length }));
check(hover.dots >= 2 && hover.planes >= 1, `hovering lights up the orbit: ${hover.dots} points, elements of ${hover.planes} regions`);
await picture("hover");

const handles = () => ask(() => structuredClone(globalThis.orbifit.editor.state.handles));
await page.mouse.move(...back);
await settled();
await page.keyboard.press("p");
await settled();
check((await handles()).length === 1 && (await handles())[0].pin, "P pins what is under the cursor");
await page.mouse.click(...seen);
await settled();
check((await handles()).length === 2, "a click places a handle");
const before = await shown();
const handleAt = await ask(() => globalThis.orbifit.view.screen(globalThis.orbifit.editor.target(1)));
const goal = [handleAt[0] + 70, handleAt[1] + 25];
await page.mouse.move(...handleAt);
await page.mouse.down();
await page.mouse.move(handleAt[0] + 30, handleAt[1] + 10, { steps: 3 });
await page.mouse.move(...goal, { steps: 3 });
await page.mouse.up();
await settled();
const reached = await ask(() => globalThis.orbifit.view.screen(globalThis.orbifit.editor.target(1)));
const missed = Math.hypot(reached[0] - goal[0], reached[1] - goal[1]);
check(missed < 3, `a drag takes the handle to ${missed.toFixed(2)} pixels from the cursor`);
const dragged = await shown();
check(largestDifference(before, dragged) > 0.01 * size, "the mesh follows");
const residual = await ask(() => globalThis.orbifit.editor.residuals.symmetric);
check(residual < 1e-6, `residual of what is shown: ${residual.toExponential(1)} of the diagonal`);
// Those that follow: far more vertices than the handle has, on all sides.
let followers = 0;
for (let i = 0; i < dragged.length; i += 3) {
  if (Math.hypot(dragged[i] - before[i], dragged[i + 1] - before[i + 1], dragged[i + 2] - before[i + 2]) > 0.01 * size) ++followers;
}
console.log(`       ${followers} vertices moved; ${JSON.stringify(await ask(() => globalThis.orbifit.editor.record))}`);
await picture("dragged");

await page.keyboard.press("Control+z");
await settled();
check(largestDifference(await shown(), before) === 0, "undo restores bit for bit");
await page.keyboard.press("Control+Shift+z");
await settled();
check(largestDifference(await shown(), dragged) === 0, "redo too");

// The export replays.
const download = async action => {
  const [file] = await Promise.all([page.waitForEvent("download"), page.click(`[data-do=${action}]`)]);
  return readFileSync(await file.path());
};
writeFileSync(join(folder, "handles.json"), await download("save-handles"));
orbifit("deform", "chair.ply", "chair.json", "--handles", "handles.json", "-o", "replayed.ply", "--quiet");
const replayed = largestDifference(plyFile("replayed.ply"), dragged) / size;
check(replayed < 1e-6, `orbifit deform replays handles.json to ${replayed.toExponential(1)} of the diagonal`);
const exported = plyVertices(await download("save-ply"));
check(largestDifference(exported, dragged) === 0, "the mesh that is exported is the one that is shown");
for (const [ending, near] of [["obj", 1e-9], ["glb", 1e-6]]) { // GLB holds single precision
  writeFileSync(join(folder, `out.${ending}`), await download(`save-${ending}`));
  orbifit("convert", `out.${ending}`, `${ending}.ply`, "--quiet");
  const off = largestDifference(plyFile(`${ending}.ply`), dragged) / size;
  check(off < near, `as ${ending.toUpperCase()} too, to ${off.toExponential(1)} of the diagonal`);
}

// Keys. What they do is taken back, bit for bit.
const same = async what => check(largestDifference(await shown(), dragged) === 0, what);
const undo = async () => { await page.keyboard.press("Control+z"); await settled(); };
const handleNow = async () => (await handles())[1];
const place = () => ask(() => globalThis.orbifit.view.screen(globalThis.orbifit.editor.target(1)));
const start = await handleNow();
const drag = async (keys, press) => {
  const at = await place();
  await page.mouse.move(...at);
  await page.mouse.down();
  await page.mouse.move(at[0] + 5, at[1] - 5);
  for (const key of press) await page.keyboard.press(key);
  for (const key of keys) await page.keyboard.down(key);
  await page.mouse.move(at[0] + 40, at[1] - 60, { steps: 2 });
  const result = await handleNow();
  for (const key of keys) await page.keyboard.up(key);
  return result;
};
const way = handle => handle.translation.map((entry, k) => (entry - start.translation[k]) / size);
const kept = way(await drag([], ["z"]));
check(Math.abs(kept[0]) + Math.abs(kept[1]) === 0 && Math.abs(kept[2]) > 0.01, "Z keeps a drag to its axis");
await page.keyboard.press("Escape");
await page.mouse.up();
await settled();
await same("Esc cancels a drag");
const snapped = way(await drag(["Shift"], []));
await page.mouse.up();
await settled();
check(snapped.some(entry => Math.abs(entry) > 0.01) &&
      snapped.every(entry => Math.abs(entry / 0.02 - Math.round(entry / 0.02)) < 1e-9), "Shift snaps");
await undo();
await same("undo takes a drag back");

const gizmo = () => ask(() => {
  const { gizmo } = globalThis.orbifit.view;
  return { on: Boolean(gizmo.object), mode: gizmo.mode, axis: gizmo.axis };
});
await page.mouse.click(...await place());
for (const [key, mode] of [["e", "rotate"], ["r", "scale"], ["w", "translate"]]) {
  await page.keyboard.press(key);
  await settled();
  const now = await gizmo();
  check(now.on && now.mode === mode, `${key.toUpperCase()}: the gizmo is to ${mode}`);
  await picture(`gizmo-${mode}`);
}
/** Where along an axis from the handle the gizmo is grasped. */
const grasp = async axis => {
  for (let share = 0.02; share < 0.3; share += 0.01) {
    const at = await ask(({ axis, share }) => {
      const { editor, view } = globalThis.orbifit;
      const point = editor.target(1);
      point[axis] += share;
      return view.screen(point);
    }, { axis, share });
    await page.mouse.move(...at);
    if ((await gizmo()).axis === "XYZ"[axis]) return at;
  }
  return null;
};
const arrow = await grasp(0);
check(arrow !== null, "the gizmo's X is grasped");
if (arrow) {
  await page.mouse.down();
  await page.mouse.move(arrow[0] + 30, arrow[1] + 10, { steps: 3 });
  const along = way(await handleNow());
  check(Math.abs(along[0]) > 0.005 && Math.abs(along[1]) + Math.abs(along[2]) < 1e-12, "it moves the handle along x");
  await page.keyboard.press("Escape");
  await page.mouse.up();
  await settled();
  await same("Esc cancels that too");
}
await page.keyboard.press("w");
await page.mouse.click(...await place());
await page.keyboard.press("Delete");
await settled();
check((await handles()).length === 1, "Del removes a handle");
await undo();
await same("undo brings it back");
await page.keyboard.press("?");
check(await page.isVisible("#keys"), "? lists the keys");
await picture("keys");
await page.keyboard.press("Escape");

// Comparison.
await page.click("[data-do=compare]");
await settled();
const sides = await ask(() => ({ own: globalThis.orbifit.editor.residuals.symmetric, free: globalThis.orbifit.editor.residuals.free }));
check(sides.own < 1e-6 && sides.free > 1e-4, `compare: ${sides.own.toExponential(1)} with symmetries, ${sides.free.toExponential(1)} without`);
await picture("compare");
await page.click("[data-do=compare]");
await settled();

// Regions off: what follows changes, and the edit of the rest is what the native program does without them.
const boxes = await page.$$(".region input[type=checkbox]");
check(boxes.length > 0, `${boxes.length} regions are listed`);
const row = page.locator(`.region[data-id="${id}"]`);
await row.hover();
await settled();
await picture("region");
await row.locator("input[type=checkbox]").click();
await settled();
const other = await shown();
check(largestDifference(other, dragged) > 0.003 * size, "switching a region off changes what follows");
const annotation = await download("save-annotation");
writeFileSync(join(folder, "kept.json"), annotation);
check(!JSON.parse(annotation).regions.some(region => region.id === id), "the annotation that is downloaded lacks it");
orbifit("deform", "chair.ply", "kept.json", "--handles", "handles.json", "-o", "without.ply", "--quiet");
const without = largestDifference(plyFile("without.ply"), other) / size;
check(without < 1e-6, `that replays too, to ${without.toExponential(1)} of the diagonal, from a basis built in the page`);
await page.keyboard.press("Control+z");
await settled();
check(largestDifference(await shown(), dragged) === 0, "undo switches it on again, bit for bit");


// Regions: rename, delete, keep only those that are on; a mode; a recorded edit.
const regions = () => ask(() => globalThis.orbifit.editor.regions.map(region => [region.id, region.name]));
const listed = await regions();
await row.locator(".name").dblclick();
await page.keyboard.type("four legs");
await page.keyboard.press("Enter");
await settled();
check((await regions()).some(([other, name]) => other === id && name === "four legs"), "a region is renamed");
check(JSON.parse(await download("save-annotation")).regions.some(region => region.name === "four legs"), "in the annotation too");
while (JSON.stringify(await regions()) !== JSON.stringify(listed)) await undo();
await same("undo gives it its name back");
await row.hover();
await row.locator(".delete").click();
await settled();
check((await regions()).length === listed.length - 1, "a region is deleted");
await undo();
await row.locator("input[type=checkbox]").click();
await settled();
await page.click("[data-do=keep-only]");
await settled();
check((await regions()).length === listed.length - 1, "those that are off are forgotten");
await undo();
await undo();
await same("undo brings all back");
await chooseMode("0", "fixed");
check(await ask(() => globalThis.orbifit.editor.info.mode) === "fixed", "groups are fixed");
await undo();

// Moving groups: a drag may take fewer iterations a frame, what is released not.
await chooseMode("2", "moving");
await drag([], []);
await page.mouse.up();
await settled();
writeFileSync(join(folder, "moving.json"), await download("save-handles"));
orbifit("deform", "chair.ply", "chair.json", "--handles", "moving.json", "--mode", "moving", "-o", "moving.ply", "--quiet");
const moving = largestDifference(plyFile("moving.ply"), await shown()) / size;
check(moving < 1e-6, `a drag with moving groups ends as orbifit deform does, to ${moving.toExponential(1)} of the diagonal`);
await undo();
await undo();
await same("undo takes the drag and the mode back");

// The symmetrise slider: one entry for undo a drag.
await page.click("summary:has-text('Symmetrise')");
const slide = value => ask(value => {
  const slider = document.getElementById("blend");
  slider.value = String(value);
  slider.dispatchEvent(new Event("input"));
}, value);
const blend = () => ask(() => globalThis.orbifit.editor.state.blend);
for (const value of [0.2, 0.6, 1]) await slide(value);
await settled();
await ask(() => document.getElementById("blend").dispatchEvent(new Event("change")));
check(await blend() === 1 && await page.isVisible("#blend-table table"), "the slider shows the symmetric mesh, and residuals");
check(largestDifference(await shown(), dragged) > 0.01 * size, "in the place of the edit");
await picture("symmetrise");
await undo();
check(await blend() === 0, "undo takes a drag of the slider back at once");
await same("and shows the edit again");
await page.keyboard.press("Control+Shift+z");
await settled();
check(await blend() === 1, "redo");
await undo();
await page.click("summary:has-text('Symmetrise')");

await page.click("[data-do=reset]");
await settled();
check(largestDifference(await shown(), rest) === 0, "reset shows the mesh as it is");

// Bad input: a message, and nothing lost.
const drop = (name, text) => ask(({ name, text }) => {
  const data = new DataTransfer();
  data.items.add(new File([text], name));
  window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
}, { name, text });
await drop("handles.json", readFileSync(join(folder, "handles.json"), "utf8"));
await page.waitForFunction(() => globalThis.orbifit.editor.state.handles.length === 2, null, { timeout: 20000 });
await settled();
check(largestDifference(await shown(), dragged) / size < 1e-9, "a file of handles replays the edit");
await undo();
await undo();
await same("undo takes reset and replay back");
const refusal = async (name, text, pattern) => {
  await drop(name, text);
  await page.waitForFunction(() => !document.getElementById("message").hidden, null, { timeout: 20000 });
  const message = await ask(() => document.querySelector("#message span").textContent);
  check(pattern.test(message), `${name}: "${message}"`);
  check(largestDifference(await shown(), dragged) === 0, "nothing is lost");
  await page.click("[data-do=message]");
};
await refusal("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\nelement face 1\nend_header\n", /broken\.ply/);
await refusal("empty.obj", "", /empty\.obj/);
await refusal("noise.stl", "\u0001\u0002\u0003".repeat(99), /noise\.stl/);
await refusal("notes.txt", "hello", /notes\.txt/);
await refusal("cut.json", "{\"format\": \"symmetry-annotation\", ", /cut\.json/);
await refusal("scan.xyz", "0 0 here\n", /scan\.xyz/);
await refusal("handles.json", "{\"handles\": [{\"centre\": [0, 0, 0]}]}", /handle 0/);
orbifit("generate", "wheel", "-o", ".", "--quiet");
orbifit("detect", "wheel.ply", "-o", "wheel.json", "--quiet");
const foreign = readFileSync(join(folder, "wheel.json"), "utf8");
await refusal("wheel.json", foreign, /annotation|mesh|vertices|faces/);

// Another mesh with an annotation that is not its own, one that needs more memory than there is, one that is too large to
// be read at all: what was there is there, and goes on.
const dropped = async (what, pattern, names) => {
  await ask(({ names }) => globalThis.dropFiles(names), { names });
  await page.waitForFunction(() => !document.getElementById("message").hidden, null, { timeout: 20000 });
  await settled();
  const message = await ask(() => document.querySelector("#message span").textContent);
  check(pattern.test(message), `${what}: "${message}"`);
  check(largestDifference(await shown(), dragged) === 0, "nothing is lost");
  await page.click("[data-do=message]");
};
await ask(({ foreign, cube }) => {
  const grow = WebAssembly.Memory.prototype.grow;
  const files = {
    "cube.obj": () => new File([cube], "cube.obj"),
    "wheel.json": () => new File([foreign], "wheel.json"),
    "vast.obj": () => { // as it is where memory cannot grow
      WebAssembly.Memory.prototype.grow = () => { throw new RangeError("Maximum memory size exceeded"); };
      return new File(["v 0.123456789 0.5 0.25\n".repeat(4e6), "f 1 2 3\n"], "vast.obj");
    },
    "huge.ply": () => { // as a browser answers that cannot hold a file
      const file = new File(["ply"], "huge.ply");
      Object.defineProperty(file, "arrayBuffer", { value: () => Promise.reject(new DOMException("could not be read", "NotReadableError")) });
      return file;
    }
  };
  globalThis.dropFiles = names => {
    const list = names.map(name => files[name]());
    const event = new DragEvent("drop", { bubbles: true, cancelable: true });
    Object.defineProperty(event, "dataTransfer", { value: { files: list } });
    window.dispatchEvent(event);
  };
  globalThis.growAgain = () => { WebAssembly.Memory.prototype.grow = grow; };
}, { foreign, cube: "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n" });
await dropped("a mesh with an annotation of another", /annotation|mesh|vertices|faces/, ["cube.obj", "wheel.json"]);
await dropped("a mesh that memory does not hold", /vast\.obj: too large/, ["vast.obj"]);
await ask(() => globalThis.growAgain());
await dropped("a file that the browser cannot read", /huge\.ply: too large/, ["huge.ply"]);

// A scan, and the fit.
orbifit("scan", "replayed.ply", "--views", "2", "-o", "scan.ply", "--quiet");
orbifit("convert", "scan.ply", "scan.xyz", "--quiet");
await drop("scan.xyz", readFileSync(join(folder, "scan.xyz"), "utf8"));
await settled();
await page.click("[data-do=fit]");
await page.waitForFunction(() => globalThis.orbifit.editor.fitting.report !== null, null, { timeout: 120000 });
await settled();
const fit = await ask(() => ({ report: globalThis.orbifit.editor.fitting.report, steps: globalThis.orbifit.editor.fitting.steps }));
check(fit.report.converged && fit.steps.length > 10 && fit.steps.at(-1).rms < fit.steps[0].rms,
      `the fit converges, seen in ${fit.steps.length} steps: rms ${fit.steps[0].rms.toExponential(1)} to ${fit.report.rms.toExponential(1)}`);
await picture("fit");

// Another mesh with its annotation.
await page.evaluate(({ mesh, annotation }) => {
  const data = new DataTransfer();
  data.items.add(new File([Uint8Array.from(atob(mesh), letter => letter.charCodeAt(0))], "wheel.ply"));
  data.items.add(new File([annotation], "wheel.json"));
  window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
}, { mesh: readFileSync(join(folder, "wheel.ply")).toString("base64"),
     annotation: readFileSync(join(folder, "wheel.json"), "utf8") });
await page.waitForFunction(() => globalThis.orbifit.editor.meshName === "wheel.ply" &&
                                 globalThis.orbifit.editor.regions.length > 0, null, { timeout: 60000 });
await settled();
check(largestDifference(await shown(), plyFile("wheel.ply")) === 0, "another mesh is opened with its annotation");
const middle = await find(true, 3);
if (middle) {
  await page.mouse.move(...middle);
  await settled();
}
await picture("wheel");

// Other sizes and colours.
if (pictures) {
  await page.click("[data-do=theme]");
  await settled();
  await picture("dark");
  await page.setViewportSize({ width: 820, height: 1180 });
  await settled();
  await picture("tablet");
  await page.setViewportSize({ width: 1280, height: 720 });
  await settled();
  await picture("laptop");
}
check(complaints.length === 0, `no errors or warnings until the end ${complaints.join("; ")}`);

// A radius field: a basis that the page builds is sampled as the native program's.
writeFileSync(join(folder, "field.json"), JSON.stringify({ areas: [{ centre: [0, 0.2, 0.9], radius: 0.15, factor: 0.5 }] }));
const field = ["--radius-field", "field.json", "--samples", "400"];
orbifit("edit", "chair.ply", "chair.json", ...field, "-o", "field.html", "--quiet");
const native = orbifit("subspace", "chair.ply", "chair.json", ...field, "--mode", "fixed", "--json", "--quiet");
await page.goto(pathToFileURL(join(folder, "field.html")).href);
await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 60000 });
// Asked for while the worker is being made ready: it waits for that.
await ask(() => {
  const { background } = globalThis.orbifit.editor;
  background.stop();
  const request = background.request();
  background.worker.postMessage(request);
  const mode = document.getElementById("mode");
  mode.value = "0";
  mode.dispatchEvent(new Event("change"));
});
await takenUp("fixed");
const built = await ask(() => globalThis.orbifit.editor.info);
check(built.mode === "fixed" && built.samples === native.samples && built.degrees_of_freedom === native.degrees_of_freedom,
      `the page samples by the radius field: ${built.samples} samples, ${built.degrees_of_freedom} degrees of freedom`);
check(/--radius-field field\.json/.test(await page.textContent("#command")), "and names it in the command that replays");

// Without WebGL there is a message.
const bare = await browser.newContext();
await bare.addInitScript(() => { HTMLCanvasElement.prototype.getContext = () => null; });
const plain = await bare.newPage();
await plain.goto(pathToFileURL(join(folder, "chair.html")).href);
await plain.waitForFunction(() => !document.getElementById("message").hidden, null, { timeout: 30000 });
check(/WebGL/.test(await plain.textContent("#message")), "without WebGL the page says so");
check(await plain.evaluate(() => document.getElementById("mesh").textContent.length > 1000), "and keeps the mesh");

await browser.close();
finish();
