// Puts the page together.
import { annotationFrom, without, type Annotation } from "./annotation";
import { Core, CoreError, tooLarge, type Sampling } from "./core";
import { Background, coreBytes, download, embedded } from "./data";
import { Editor, modes } from "./editor";
import { fromJson } from "./handles";
import { Input, type Tool } from "./input";
import { element, Panel, showMessage } from "./panel";
import { View, type Theme } from "./view";

const themes: Record<"light" | "dark", Theme> = {
  light: { back: "#eef0f3", mesh: "#d8d2c6", orbit: "#f26b0f", region: "#2f7fd0", handle: "#e0521b", pin: "#2673c2", scan: "#0d8a6a" },
  dark: { back: "#15181d", mesh: "#b9b3a8", orbit: "#ff8a30", region: "#5aa9f0", handle: "#ff7a3c", pin: "#5aa9f0", scan: "#4fd6ae" }
};
const keys: [string, string][] = [
  ["Hover", "light up what moves together, and the planes and axes that hold it"],
  ["Click", "place a handle"], ["Drag a dot", "move it in the plane of the view; <kbd>X</kbd> <kbd>Y</kbd> <kbd>Z</kbd> keep an axis, <kbd>Shift</kbd> snaps, <kbd>Esc</kbd> cancels"],
  ["Left drag", "orbit; one finger"], ["Right drag, Shift drag", "pan; two fingers"], ["Wheel", "zoom; with <kbd>Alt</kbd> the radius of handles"],
  ["<kbd>W</kbd> <kbd>E</kbd> <kbd>R</kbd>", "move, rotate, scale with a gizmo; again: without it"], ["<kbd>P</kbd>", "pin what is under the cursor, or the next area clicked"],
  ["<kbd>Del</kbd>", "remove the handle"], ["<kbd>Ctrl Z</kbd>, <kbd>Ctrl Shift Z</kbd>", "undo, redo"], ["<kbd>F</kbd>", "frame the mesh"],
  ["<kbd>C</kbd>", "compare with an edit without symmetries"], ["<kbd>?</kbd>", "this list"]
];
const meshEndings = /\.(obj|off|ply|stl|gltf|glb)$/i;
const scanEndings = /\.(pcd|xyz|pts)$/i;
const report = (error: unknown): void => showMessage(error instanceof Error ? error.message : String(error));

function setTheme(view: View | null, dark: boolean): void {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  view?.setTheme(themes[dark ? "dark" : "light"]);
}

const stem = (name: string): string => name.replace(/\.[^.]*$/, "");

/** A PLY of vertices without faces is a scan. */
function isScan(name: string, data: Uint8Array): boolean {
  if (scanEndings.test(name)) return true;
  if (!/\.ply$/i.test(name)) return false;
  const header = new TextDecoder("latin1").decode(data.subarray(0, 4096)).split("end_header")[0]!;
  const faces = /element face (\d+)/.exec(header);
  return !faces || faces[1] === "0";
}

async function openFiles(editor: Editor, files: File[]): Promise<void> {
  showMessage("");
  const read = await Promise.all(files.map(async file => {
    try {
      return { name: file.name, data: new Uint8Array(await file.arrayBuffer()) };
    } catch (error) {
      if (error instanceof RangeError || (error as DOMException).name === "NotReadableError") throw new Error(tooLarge(file.name));
      throw error;
    }
  }));
  let annotation: Annotation | null = null;
  let replay: string | null = null;
  for (const { name, data } of read.filter(file => /\.json$/i.test(file.name))) {
    const text = new TextDecoder().decode(data);
    try {
      const value = JSON.parse(text) as { format?: string; handles?: unknown };
      if (value.format === "symmetry-annotation") annotation = annotationFrom(text);
      else if (value.handles) replay = text;
      else throw new Error("neither an annotation nor handles");
    } catch (error) {
      throw new Error(`${name}: ${error instanceof Error ? error.message : String(error)}`);
    }
  }
  const scan = read.find(file => isScan(file.name, file.data));
  const mesh = read.find(file => file !== scan && meshEndings.test(file.name));
  const unknown = read.find(file => file !== scan && file !== mesh && !/\.json$/i.test(file.name));
  if (unknown) throw new Error(`${unknown.name}: a mesh (OBJ, OFF, PLY, STL, glTF, GLB), a scan (PLY, PCD, XYZ, PTS), an annotation or handles (JSON) can be opened`);
  if (mesh) {
    await editor.open(mesh.name, mesh.data, annotation, null);
    if (!annotation) showMessage("The mesh came without its annotation: it moves as one free surface. `orbifit detect` finds its symmetries; drop the annotation here.");
  } else if (annotation) await editor.openAnnotation(annotation);
  if (scan) {
    editor.fitting.open(scan.name, scan.data);
    (element("fit-section") as HTMLDetailsElement).open = true;
  }
  if (replay) {
    const { handles, alpha, iterations } = fromJson(replay);
    await editor.change(state => Object.assign(state, { handles, alpha, iterations }));
  }
}

function actions(editor: Editor, input: Input, view: View): Record<string, () => unknown> {
  const chooseFiles = (): void => element<HTMLInputElement>("file").click();
  const tool = (name: Tool) => () => input.setTool(name);
  const save = (ending: string) => () =>
    download(`${stem(editor.meshName)}_edited.${ending}`, editor.core.writeMesh(ending, false));
  return {
    undo: () => editor.undo().then(() => input.attachGizmo()), redo: () => editor.redo().then(() => input.attachGizmo()),
    move: tool("move"), rotate: tool("rotate"), scale: tool("scale"), pin: () => input.pin(),
    remove: () => input.removeSelected(), frame: () => view.frame(),
    compare: () => editor.setComparing(!editor.comparing),
    theme: () => setTheme(view, document.documentElement.dataset.theme !== "dark"),
    keys: () => element<HTMLDialogElement>("keys").showModal(),
    hint: () => { element("hint").hidden = true; }, message: () => showMessage(""),
    "all-on": () => editor.change(state => { state.off = []; }),
    "keep-only": () => editor.change(state => {
      state.annotation = without(state.annotation, new Set(state.off));
      state.off = [];
    }),
    "save-annotation": () => download("annotation.json", JSON.stringify(
      without(editor.state.annotation, new Set(editor.state.off))) + "\n", "application/json"),
    reset: () => editor.change(state => { state.handles = []; }), replay: chooseFiles, open: chooseFiles,
    "open-scan": chooseFiles, "keep-blend": () => editor.keepBlend(),
    fit: () => editor.fitting.run(element<HTMLInputElement>("place").checked), "stop-fit": () => editor.background.stop(),
    "clear-scan": () => editor.fitting.close(),
    "save-obj": save("obj"), "save-ply": save("ply"), "save-glb": save("glb"),
    "save-handles": () => download("handles.json", editor.handlesJson(), "application/json")
  };
}

function wire(editor: Editor, input: Input, view: View, panel: Panel): void {
  const list = actions(editor, input, view);
  document.addEventListener("click", event => {
    const button = (event.target as HTMLElement).closest<HTMLElement>("[data-do]");
    if (!button) return;
    try {
      Promise.resolve(list[button.dataset.do!]?.()).catch(report);
    } catch (error) {
      report(error);
    }
  });
  element<HTMLInputElement>("file").addEventListener("change", event => {
    const chooser = event.target as HTMLInputElement;
    openFiles(editor, [...chooser.files ?? []]).catch(report);
    chooser.value = "";
  });
  const drop = element("drop");
  window.addEventListener("dragover", event => { event.preventDefault(); drop.hidden = false; });
  window.addEventListener("dragleave", event => { if (!event.relatedTarget) drop.hidden = true; });
  window.addEventListener("drop", event => {
    event.preventDefault();
    drop.hidden = true;
    openFiles(editor, [...event.dataTransfer?.files ?? []]).catch(report);
  });
  editor.onError = showMessage;
  editor.onChange = () => {
    panel.update();
    if (editor.state?.handles.length) element("hint").hidden = true;
  };
  editor.onSolved = () => panel.solved();
  view.onFrame = () => panel.frame();
  input.onTool = () => {
    for (const name of ["move", "rotate", "scale"]) {
      document.querySelector(`[data-do=${name}]`)!.classList.toggle("on", input.tool === name);
    }
    document.querySelector("[data-do=pin]")!.classList.toggle("on", input.pinNext);
  };
  element("key-table").innerHTML = keys.map(([key, text]) => `<tr><td>${key}</td><td>${text}</td></tr>`).join("");
}

async function start(): Promise<void> {
  const darkWanted = window.matchMedia("(prefers-color-scheme: dark)");
  setTheme(null, darkWanted.matches);
  let view: View;
  try {
    view = new View(element<HTMLCanvasElement>("canvas"), themes[darkWanted.matches ? "dark" : "light"]);
  } catch {
    showMessage("This browser cannot draw in 3D: it has no WebGL, or it is switched off. The mesh and its annotation are whole; `orbifit deform` edits them without a browser.");
    return;
  }
  darkWanted.addEventListener("change", event => setTheme(view, event.matches));
  const wasm = await coreBytes();
  const core = await Core.create(wasm);
  const editor = new Editor(core, view, new Background(wasm));
  const input = new Input(editor, element<HTMLCanvasElement>("canvas"));
  const panel = new Panel(editor);
  wire(editor, input, view, panel);
  // For tests, and for the curious at the console.
  Object.assign(window, { orbifit: { editor, view, input } });
  const mesh = embedded("mesh");
  if (!mesh) {
    element("hint").hidden = false;
    element("hint").lastChild!.textContent = " lists the keys. Drop a mesh and its annotation to begin.";
    return;
  }
  const annotation = embedded("annotation");
  const basis = embedded("basis");
  await editor.open(mesh.name, mesh.data,
                    annotation && annotationFrom(new TextDecoder().decode(annotation.data)), basis?.data ?? null,
                    Math.max(0, modes.indexOf((basis?.name ?? "floating") as (typeof modes)[number])));
  editor.sourceName = mesh.source;
  const sampling = embedded("sampling");
  if (sampling) editor.sampling = JSON.parse(new TextDecoder().decode(sampling.data)) as Sampling;
  panel.update();
  element("hint").hidden = false;
  document.documentElement.dataset.ready = "true";
}

start().catch(error => {
  if (!(error instanceof CoreError)) console.error(error);
  report(error);
});
