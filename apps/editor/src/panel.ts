// The panel beside the mesh: regions, sliders, files; messages and the readout.
import { faceCount, groupMarkup, without, type Region } from "./annotation";
import { modes, type Editor } from "./editor";

export const element = <Kind extends HTMLElement = HTMLElement>(id: string): Kind => document.getElementById(id) as Kind;

/** "0.012 %" of a fraction of the diagonal; powers of ten for what is left by rounding. */
export function share(fraction: number): string {
  if (fraction === 0) return "0";
  if (fraction < 1e-6) return `${fraction.toExponential(0).replace("e-", "·10⁻").replace(/\d+$/, digits =>
    [...digits].map(digit => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]).join(""))}`;
  return `${(100 * fraction).toPrecision(2)} %`;
}

export function showMessage(text: string): void {
  const box = element("message");
  box.querySelector("span")!.textContent = text;
  box.hidden = !text;
}

/** The options of `orbifit deform` that sample as the page does. */
function samplingWords({ sampling: { lift, radius, samples, sharp, radius_field } }: Editor): string {
  return (lift ? " --lift paper" : "") + (radius ? ` --radius ${radius}` : "") + (samples ? ` --samples ${samples}` : "") +
    (sharp ? " --sharp-features" : "") + (radius_field ? ` --radius-field ${radius_field.name}` : "");
}

/** Regions in order of importance (as listed, where it is not given), children under their parents. */
function ordered(regions: readonly Region[]): { region: Region; depth: number }[] {
  const result: { region: Region; depth: number }[] = [];
  const weight = (region: Region): number => region.importance ?? 0;
  const ids = new Set(regions.map(region => region.id));
  const visit = (parent: number | null, depth: number): void => {
    const children = regions.filter(region =>
      parent === null ? region.parent === null || !ids.has(region.parent) : region.parent === parent);
    const importance = children.some(region => region.importance !== undefined);
    children.sort((a, b) => importance ? weight(b) - weight(a) : faceCount(b) - faceCount(a));
    for (const region of children) {
      result.push({ region, depth });
      visit(region.id, depth + 1);
    }
  };
  visit(null, 0);
  return result;
}

export class Panel {
  private listed = "";
  private readonly frames = new Float64Array(256); // when the last ones were, in a ring
  private drawn = 0; // frames so far
  private readoutWaits = 0; // a timer's

  constructor(private readonly editor: Editor) {
    const slider = (id: string, use: (value: number) => void, done: () => void = () => {}): void => {
      const input = element<HTMLInputElement>(id);
      input.addEventListener("input", () => use(Number(input.value)));
      input.addEventListener("change", done);
    };
    let before = editor.snapshot.bind(editor);
    let remembered: ReturnType<typeof before> | null = null;
    const changing = (use: (value: number) => void) => (value: number): void => {
      remembered ??= before();
      use(value);
      editor.handlesChanged();
    };
    const changed = (): void => {
      if (remembered) editor.remember(remembered);
      remembered = null;
      this.update();
    };
    slider("alpha", changing(value => { editor.state.alpha = Math.round(10 ** value * 100) / 100; }), changed);
    slider("iterations", changing(value => { editor.state.iterations = value; }), changed);
    slider("radius", value => {
      const handle = editor.state.handles[editor.selected];
      editor.radius = value / 100;
      if (handle) changing(() => { handle.radius = editor.radius * editor.info.diagonal; })(value);
      this.update();
    }, changed);
    slider("blend", value => {
      remembered ??= before();
      void editor.setBlend(value);
    }, changed);
    element<HTMLSelectElement>("mode").addEventListener("change", event =>
      void editor.change(state => { state.mode = Number((event.target as HTMLSelectElement).value); }));
  }

  update(): void {
    const { editor } = this;
    const { info, state } = editor;
    if (!info) return;
    element("mesh-name").textContent = element("mesh-name").title = editor.sourceName;
    element("mesh-facts").textContent =
      `${info.vertices.toLocaleString("en")} vertices, ${info.faces.toLocaleString("en")} faces` +
      (info.samples ? `; ${info.samples} samples, ${info.degrees_of_freedom} degrees of freedom` : "");
    element("alpha-value").textContent = String(state.alpha);
    element<HTMLInputElement>("alpha").value = String(Math.log10(state.alpha));
    element("iterations-value").textContent = String(state.iterations);
    element<HTMLInputElement>("iterations").value = String(state.iterations);
    const handle = state.handles[editor.selected];
    const radius = handle ? handle.radius / info.diagonal : editor.radius;
    element("radius-value").textContent = `${(100 * radius).toPrecision(2)} %`;
    element<HTMLInputElement>("radius").value = String(100 * radius);
    element<HTMLSelectElement>("mode").value = String(state.mode);
    element<HTMLInputElement>("blend").value = String(state.blend);
    element("blend-value").textContent = `${Math.round(100 * state.blend)} %`;
    element("command").textContent =
      `orbifit deform ${editor.sourceName} annotation.json --handles handles.json --mode ${modes[state.mode]}${samplingWords(editor)} -o edited.ply`;
    const button = (name: string): HTMLButtonElement => document.querySelector(`[data-do=${name}]`)!;
    button("undo").disabled = !editor.history.canUndo;
    button("redo").disabled = !editor.history.canRedo;
    button("remove").disabled = editor.selected < 0;
    button("compare").classList.toggle("on", editor.comparing);
    button("fit").disabled = !editor.fitting.scan || editor.busy !== "";
    button("stop-fit").disabled = editor.busy !== "fitting";
    button("clear-scan").disabled = !editor.fitting.scan;
    button("keep-blend").disabled = state.blend === 0;
    this.readout();
    this.regionList();
    this.blendTable();
    this.fit();
    const busy = element("busy");
    busy.hidden = !editor.busy;
    busy.querySelector("span")!.textContent = `${editor.busy} …`;
  }

  /** Frames of the last second. */
  frame(): void {
    this.frames[this.drawn++ % this.frames.length] = performance.now();
  }
  private framesOfLastSecond(): number {
    const since = performance.now() - 1000;
    let count = 0;
    for (let i = Math.max(0, this.drawn - this.frames.length); i < this.drawn; ++i) {
      if (this.frames[i % this.frames.length]! >= since) ++count;
    }
    return count;
  }

  /** The numbers that follow a drag: ten times a second, which is as often as one reads. */
  solved(): void {
    if (!this.readoutWaits) this.readoutWaits = window.setTimeout(this.readoutNow, 100);
  }
  private readonly readoutNow = (): void => {
    this.readoutWaits = 0;
    this.readout();
  };

  private readout(): void {
    const { editor } = this;
    const parts: string[] = [];
    const { solve, lift } = editor.record;
    const { handles, blend } = editor.state;
    if (blend > 0) {
      parts.push(`<b>${Math.round(100 * blend)} %</b> of the way to the symmetric mesh; handles act on the mesh as it is`);
    } else if (handles.length) {
      parts.push(`residual <b>${share(editor.residuals.symmetric)}</b>`);
      parts.push(`solve <b>${solve.toFixed(1)}</b> + lift <b>${lift.toFixed(1)}</b> ms`);
      const frames = this.framesOfLastSecond();
      if (frames > 1) parts.push(`<b>${frames}</b> frames/s`);
    } else {
      parts.push("no handles yet");
    }
    // Where nothing else is held a drag moves all of it: what one tries first must not look like a failure.
    const hint = handles.length === 1 && blend === 0 ? "<br>One handle alone moves all of it; pin another place (<kbd>P</kbd>)." : "";
    element("readout").innerHTML = parts.join(" &nbsp;·&nbsp; ") + hint;
    for (const id of ["divider", "label-left", "label-right"]) element(id).hidden = !editor.comparing;
    element("label-left-residual").textContent = share(editor.residuals.symmetric);
    element("label-right-residual").textContent = share(editor.residuals.free);
  }

  private regionList(): void {
    const { editor } = this;
    const { regions, state } = { regions: editor.regions, state: editor.state };
    const key = JSON.stringify([regions.map(region => [region.id, region.name, region.parent, region.group]), state.off]);
    if (key === this.listed) return;
    this.listed = key;
    const on = regions.length - state.off.filter(id => regions.some(region => region.id === id)).length;
    element("region-count").textContent = regions.length ? `${on} of ${regions.length} on` : "none";
    const list = element("regions");
    list.replaceChildren(...ordered(regions).map(({ region, depth }) => this.regionRow(region, depth)));
    if (!regions.length) list.textContent = "This mesh has no annotation: it moves as one free surface. Drop its annotation here.";
  }

  private regionRow(region: Region, depth: number): HTMLElement {
    const { editor } = this;
    const row = document.createElement("div");
    row.className = "region";
    row.dataset.id = String(region.id);
    row.style.paddingLeft = `${4 + 14 * depth}px`;
    row.classList.toggle("off", editor.state.off.includes(region.id));
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = !editor.state.off.includes(region.id);
    box.title = "Keep this region's symmetries";
    box.addEventListener("change", () => void editor.change(state => {
      state.off = box.checked ? state.off.filter(id => id !== region.id) : [...state.off, region.id];
    }));
    const group = document.createElement("span");
    group.className = "group";
    group.innerHTML = groupMarkup(region.group);
    const name = document.createElement("button");
    name.className = "name";
    name.textContent = region.name || `region ${region.id}`;
    name.title = `${name.textContent}\nClick: on or off. Double click: rename`;
    let click = 0;
    name.addEventListener("click", event => { // not at once: it may be the first of two
      if (event.detail < 2) click = window.setTimeout(() => box.click(), event.detail === 1 ? 250 : 0);
    });
    name.addEventListener("dblclick", () => {
      clearTimeout(click);
      this.rename(region, name);
    });
    const value = document.createElement("span");
    value.className = "value";
    const importance = region.importance;
    value.textContent = importance !== undefined ? `${Math.round(100 * importance)} %`
      : `${Math.round(100 * faceCount(region) / editor.info.faces)} %`;
    value.title = importance !== undefined ? "Importance: the share of the area that follows from the rest"
      : "Share of the faces";
    const remove = document.createElement("button");
    remove.className = "plain delete";
    remove.textContent = "×";
    remove.title = "Delete the region";
    remove.addEventListener("click", () => void editor.change(state => {
      state.annotation = without(state.annotation, new Set([region.id]));
      state.off = state.off.filter(id => id !== region.id);
    }));
    row.addEventListener("mouseenter", () => editor.marks.mark(region.id));
    row.addEventListener("mouseleave", () => editor.marks.mark(-1));
    row.append(box, group, name, value, remove);
    return row;
  }

  private rename(region: Region, name: HTMLElement): void {
    const input = document.createElement("input");
    input.type = "text";
    input.value = region.name;
    name.replaceWith(input);
    input.focus();
    input.select();
    let over = false;
    const finish = (keep: boolean): void => {
      if (over) return;
      over = true;
      this.listed = "";
      if (!keep || input.value === region.name) {
        this.update();
        return;
      }
      const text = input.value;
      void this.editor.change(state => {
        state.annotation = { ...state.annotation, regions: state.annotation.regions.map(other =>
          other.id === region.id ? { ...other, name: text } : other) };
      });
    };
    input.addEventListener("blur", () => finish(true));
    input.addEventListener("keydown", event => {
      event.stopPropagation();
      if (event.key === "Enter") finish(true);
      if (event.key === "Escape") finish(false);
    });
  }

  private blendTable(): void {
    const { editor } = this;
    const table = element("blend-table");
    if (!editor.symmetric.report.length) {
      table.textContent = "";
      return;
    }
    const now = editor.state.blend > 0 || !editor.state.handles.length ? editor.symmetric.residuals() : new Map();
    const rows = editor.symmetric.report.map(entry => {
      const region = editor.regions.find(other => other.id === entry.id);
      if (!region) return "";
      const shown = now.get(entry.id);
      const name = document.createElement("span");
      name.textContent = region.name || `region ${region.id}`;
      return `<tr><td>${name.innerHTML}</td><td>${share(entry.before[1])}</td><td>${shown ? share(shown.max) : ""}</td><td>${share(entry.after[1])}</td></tr>`;
    });
    table.innerHTML = `<table><tr><th>largest residual</th><th>as it is</th><th>shown</th><th>symmetric</th></tr>${rows.join("")}</table>`;
  }

  private fit(): void {
    const { editor } = this;
    element("fit-none").hidden = editor.fitting.scan !== null;
    element("fit-text").hidden = editor.fitting.scan === null;
    document.getElementById("fit-curve")!.toggleAttribute("hidden", editor.fitting.steps.length < 2);
    if (!editor.fitting.scan) return;
    const report = editor.fitting.report;
    const last = editor.fitting.steps.at(-1);
    element("fit-text").textContent = `${editor.fitting.scan.name}: ${editor.fitting.scan.points.toLocaleString("en")} points. ` +
      (report ? `${report.converged ? "Fitted" : "Not converged"}: ${report.stopped_because}; ${share(report.rms)} rms, ${Math.round(100 * report.inlier_ratio)} % of the points within 1 %.`
        : last ? `Step ${last.step + 1}: ${share(last.rms)} rms.` : "");
    const curve = document.getElementById("fit-curve")! as unknown as SVGSVGElement;
    const logs = editor.fitting.steps.map(step => Math.log(Math.max(1e-6, step.rms)));
    const low = Math.min(...logs), high = Math.max(...logs, low + 1e-6);
    curve.querySelector("polyline")!.setAttribute("points", logs.map((value, i) =>
      `${240 * i / Math.max(1, logs.length - 1)},${4 + 52 * (high - value) / (high - low)}`).join(" "));
  }
}
