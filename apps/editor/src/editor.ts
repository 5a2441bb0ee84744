// What is edited, and everything that can be done to it. The interface (panel.ts, input.ts) calls this and listens.
import { emptyAnnotation, without, type Annotation, type Region } from "./annotation";
import { Bases } from "./bases";
import { Core, Side, usualSampling, type Info, type Pick, type Sampling, type SolveRecord } from "./core";
import type { Background } from "./data";
import { moved, toJson, writeMotion } from "./handles";
import { add, length, sub, times, type Vec3 } from "./math";
import { RegionMarks } from "./region-marks";
import { Residuals } from "./residuals";
import { ScanFit } from "./scan-fit";
import { SymmetricShape } from "./symmetric-shape";
import { UndoHistory, type Snapshot } from "./undo-history";
import type { View } from "./view";

export const modes = ["fixed", "floating", "moving"] as const;

export class Editor {
  info!: Info;
  meshName = "mesh";
  sourceName = "mesh"; // of the user's file, for the command that replays
  state!: Snapshot;
  selected = -1;
  sampling: Sampling = usualSampling;
  radius = 0.05; // of new handles, fraction of the diagonal
  comparing = false;
  busy = "";
  readonly record: SolveRecord = { solve: 0, lift: 0, show: 0, handleError: 0 };
  readonly history = new UndoHistory();
  readonly marks = new RegionMarks(this);
  readonly residuals = new Residuals(this);
  readonly symmetric = new SymmetricShape(this);
  readonly fitting = new ScanFit(this);

  private meshData: Uint8Array = new Uint8Array();
  private readonly bases = new Bases(this);
  private kept: number[] = []; // ids of the regions in the core's order
  private motions = new Float64Array(0);
  private centroids: Vec3[] = [];
  private readonly motion = new Float64Array(12);
  private readonly freeRecord: SolveRecord = { solve: 0, lift: 0, show: 0, handleError: 0 };
  private stale = false;
  private handlesStale = false;
  private rebuilding = 0;
  private dragging = false;
  private iterationTook = 0; // ms, of both sides
  onChange: () => void = () => {};
  onSolved: () => void = () => {}; // the vertices or what is measured of them changed, nothing else
  onError: (message: string) => void = () => {};

  constructor(readonly core: Core, readonly view: View, readonly background: Background) {
    view.beforeFrame = () => this.solveNow();
  }

  // Mesh and annotation ------------------------------------------------------------------------------------------

  /** \param basis  prebuilt for the annotation, or null */
  async open(name: string, data: Uint8Array, annotation: Annotation | null, basis: Uint8Array | null, mode = 1): Promise<void> {
    this.core.readMesh(name, data); // refuses before anything is lost
    try {
      if (annotation) this.core.readAnnotation("annotation", JSON.stringify(annotation), true);
    } catch (error) {
      await this.reopen();
      throw error;
    }
    this.background.stop();
    this.background.setMesh(name, data);
    this.meshName = name;
    this.sourceName = name;
    this.meshData = data;
    this.info = this.core.info();
    this.history.clear();
    this.bases.clear();
    this.sampling = usualSampling;
    this.symmetric.forget();
    this.symmetric.report = [];
    this.comparing = false;
    this.view.setSplit(false);
    const taken = annotation ?? emptyAnnotation(this.info.vertices, this.info.faces, this.info.diagonal);
    this.state = { handles: [], alpha: 100, iterations: 10, mode, off: [], blend: 0, annotation: taken };
    this.selected = -1;
    if (basis) this.bases.set(this.basisKey(), { bytes: basis, annotation: JSON.stringify(taken) });
    this.view.setMesh(this.core);
    this.fitting.forget();
    this.view.showOrbit(null);
    this.marks.clear();
    this.view.frame();
    this.setBusy("reading the basis");
    // The mesh is seen first: what follows a frame's callbacks directly still comes before it is shown.
    await new Promise(shown => requestAnimationFrame(() => setTimeout(shown)));
    this.shownKey = "";
    await this.takeBasis();
    this.handlesChanged();
    this.background.prepareSoon();
  }

  /** Has the core take what is edited again, after it was given something else that was refused. */
  private async reopen(): Promise<void> {
    if (!this.meshData.length) return;
    this.core.readMesh(this.meshName, this.meshData);
    this.shownKey = "";
    this.symmetric.forget();
    await this.restored();
  }

  async openAnnotation(annotation: Annotation): Promise<void> {
    this.core.readAnnotation("annotation", JSON.stringify(annotation), true); // refuses one of another mesh
    this.shownKey = "";
    await this.change(state => { state.annotation = annotation; state.off = []; });
  }

  get regions(): Region[] { return this.state.annotation.regions; }

  /** The place of a region in the core's order; -1 where it is switched off. */
  coreNumber(id: number): number { return this.kept.indexOf(id); }
  idOf(number: number): number { return this.kept[number] ?? -1; }

  // Changes and undo ----------------------------------------------------------------------------------------------

  snapshot(): Snapshot {
    return { ...this.state, handles: structuredClone(this.state.handles), off: [...this.state.off] };
  }

  /** Remembers what is there, for undo. */
  remember(snapshot = this.snapshot()): void {
    this.history.remember(snapshot);
  }

  /** A change of anything, which undo takes back. */
  async change(edit: (state: Snapshot) => void): Promise<void> {
    this.remember();
    edit(this.state);
    if (await this.restored()) return;
    this.state = this.history.forget(); // there is no basis of what was asked for
    this.shownKey = "";
    await this.restored();
  }

  async undo(): Promise<void> { await this.goTo(this.history.undo(() => this.snapshot())); }
  async redo(): Promise<void> { await this.goTo(this.history.redo(() => this.snapshot())); }

  private async goTo(snapshot: Snapshot | undefined): Promise<void> {
    if (!snapshot) return;
    this.state = snapshot;
    await this.restored();
  }

  /** \return false where there is no basis */
  private async restored(): Promise<boolean> {
    if (this.selected >= this.state.handles.length) this.selected = -1;
    const known = await this.takeBasis();
    if (this.state.blend > 0) await this.symmetric.take();
    this.refresh();
    return known;
  }

  // The basis -----------------------------------------------------------------------------------------------------

  active(): Annotation { return without(this.state.annotation, new Set(this.state.off)); }

  private annotationKeys = new Map<Annotation, number>();
  regionsKey(): string {
    const { annotation, off } = this.state;
    if (!this.annotationKeys.has(annotation)) this.annotationKeys.set(annotation, this.annotationKeys.size);
    return `${this.annotationKeys.get(annotation)} ${[...off].sort((a, b) => a - b).join()}`;
  }
  private basisKey(): string { return `${this.state.mode} ${this.regionsKey()}`; }

  private shownKey = "";
  /** Has the core take the basis of the regions that are on, built in the worker where it is not known.
   *  \return false where it cannot be built */
  private async takeBasis(): Promise<boolean> {
    const key = this.basisKey();
    if (key === this.shownKey) return true;
    const turn = ++this.rebuilding;
    let basis = this.bases.get(key);
    if (!basis) {
      this.setBusy("rebuilding the basis");
      try {
        basis = await this.bases.build(key, JSON.stringify(this.active()), this.state.mode, this.sampling);
      } catch (error) {
        if (turn === this.rebuilding) this.setBusy("");
        this.failed(error);
        return turn !== this.rebuilding;
      }
    }
    if (turn !== this.rebuilding) return true; // another change has overtaken this one
    this.core.readAnnotation("annotation", basis.annotation, true);
    this.core.readBasis(basis.bytes);
    this.shownKey = key;
    this.kept = (JSON.parse(this.core.annotation()) as Annotation).regions.map(region => region.id);
    this.info = this.core.info();
    this.iterationTook = 0;
    if (this.comparing) {
      try {
        await this.takeFreeBasis();
      } catch (error) {
        this.failed(error);
        this.comparing = false;
        this.view.setSplit(false);
      }
    }
    if (turn === this.rebuilding) this.setBusy("");
    return true;
  }

  /** The same without symmetries: as many samples, in the same mode. */
  private async takeFreeBasis(): Promise<void> {
    const { vertices, faces, diagonal, samples } = this.info;
    const sampling = { ...usualSampling, samples: Math.max(4, samples ?? 0) };
    const key = `free ${this.state.mode} ${sampling.samples}`;
    const annotation = JSON.stringify(emptyAnnotation(vertices, faces, diagonal));
    const basis = this.bases.get(key) ?? await this.bases.build(key, annotation, this.state.mode, sampling);
    this.core.compare(basis.bytes);
  }

  failed(error: unknown): void {
    const message = error instanceof Error ? error.message : String(error);
    if (message !== "stopped") this.onError(message);
  }

  setBusy(what: string): void {
    this.busy = what;
    this.onChange();
  }

  // Handles -------------------------------------------------------------------------------------------------------

  async addHandle(pick: Pick, pin: boolean): Promise<void> {
    const centre = this.core.restPoint(pick.face, pick.barycentric);
    const corners = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(weights => this.core.restPoint(pick.face, weights));
    const nearest = Math.min(...corners.map(corner => length(sub(corner, centre))));
    const radius = Math.max(this.radius * this.info.diagonal, 1.0001 * nearest); // takes a vertex at least
    const count = this.state.handles.filter(handle => handle.pin === pin).length + 1;
    this.remember();
    this.state.handles.push({ name: `${pin ? "pin" : "handle"} ${count}`, pin, centre, radius, translation: [0, 0, 0],
                              rotation: [0, 0, 0, 1], scale: 1 });
    this.selected = this.state.handles.length - 1;
    this.handlesChanged();
  }

  removeHandle(number: number): void {
    this.remember();
    this.state.handles.splice(number, 1);
    this.selected = -1;
    this.handlesChanged();
  }

  select(number: number): void {
    this.selected = number;
    this.showHandles();
    this.onChange();
  }

  /** Their number, places, radii or weight changed: the system is factorised anew. */
  handlesChanged(): void {
    this.state.blend = 0;
    this.refresh();
  }
  private refresh(): void {
    this.handlesStale = true;
    this.stale = true;
    this.view.draw();
    this.onChange();
  }

  /** Where they are to go changed. \param dragging  it will go on: few iterations may do */
  motionsChanged(dragging = false): void {
    this.dragging = dragging;
    this.state.blend = 0;
    this.stale = true;
    this.showHandles();
    this.view.draw();
  }

  toDisplay(point: Vec3): Vec3 { return times(1 / this.info.diagonal, sub(point, this.info.centre)); }
  toMesh(point: Vec3): Vec3 { return add(times(this.info.diagonal, point), this.info.centre); }

  /** Where a handle's centre is to be, in the display's frame. */
  target(number: number): Vec3 {
    const handle = this.state.handles[number]!;
    const motion = this.motion;
    writeMotion(handle, this.centroids[number] ?? handle.centre, motion, 0);
    return this.toDisplay(moved(motion, 0, handle.centre));
  }

  showHandles(): void {
    const { handles } = this.state;
    const shown = this.state.blend > 0 ? 0 : handles.length; // they do not act on what the slider shows
    this.view.showHandles(shown);
    for (let number = 0; number < shown; ++number) {
      this.view.showHandle(number, this.target(number), handles[number]!.pin, number === this.selected);
    }
    if (this.selected >= 0) this.view.gizmoTarget.position.set(...this.target(this.selected));
  }

  handlesJson(): string { return toJson(this.state.handles, this.state.alpha, this.state.iterations); }

  /** Called before each frame: at most one solve a frame. */
  solveNow(): void {
    if (!this.stale || this.busy) return;
    this.stale = false;
    try {
      this.solve();
    } catch (error) {
      this.failed(error);
    }
  }

  private solve(): void {
    const { handles, iterations } = this.state;
    if (this.handlesStale) {
      this.handlesStale = false;
      if (handles.length) this.core.setHandles(this.handlesJson());
      this.centroids = handles.map((_, number) => this.core.handleCentroid(number));
      this.motions = new Float64Array(12 * handles.length);
      this.view.marksChanged();
      this.showHandles();
    }
    if (this.state.blend > 0) {
      this.core.blend(this.state.blend);
    } else if (!handles.length) {
      this.core.rest();
      this.record.solve = this.record.lift = this.record.handleError = 0;
    } else {
      for (let number = 0; number < handles.length; ++number) {
        writeMotion(handles[number]!, this.centroids[number]!, this.motions, 12 * number);
      }
      const count = this.iterationsNow();
      this.core.solve(Side.symmetric, this.motions, count, count < iterations, this.record);
      this.iterationTook = this.record.solve / count;
      if (this.comparing) {
        this.core.solve(Side.free, this.motions, count, count < iterations, this.freeRecord);
        this.iterationTook += this.freeRecord.solve / count;
      }
    }
    this.view.positionsChanged(Side.symmetric);
    if (this.comparing) this.view.positionsChanged(Side.free);
    this.residuals.measureSoon();
    this.onSolved();
  }

  /** A drag keeps up with the pointer: where a full solve does not, each frame has as many iterations as go into it and
   *  starts from the last. What is released is solved for from rest, so that it does not depend on the way. */
  private iterationsNow(): number {
    const frame = 25; // ms
    const { iterations } = this.state;
    if (!this.dragging || this.iterationTook * iterations <= frame) return iterations;
    return Math.max(1, Math.min(iterations, Math.floor(frame / this.iterationTook)));
  }

  /** Whether the residuals are those of what is shown. */
  get isMeasured(): boolean { return this.residuals.areMeasured && !this.stale; }

  async setComparing(on: boolean): Promise<void> {
    if (on === this.comparing || this.busy) return;
    if (on) {
      this.setBusy("preparing the side without symmetries");
      try {
        await this.takeFreeBasis();
      } catch (error) {
        this.failed(error);
        return;
      } finally {
        this.setBusy("");
      }
    } else {
      this.core.stopComparing();
    }
    this.comparing = on;
    this.view.setSplit(on);
    this.refresh();
  }

  // Symmetrise ----------------------------------------------------------------------------------------------------

  /** Shows what lies between the mesh as it is (0) and the exactly symmetric one (1). */
  async setBlend(share: number): Promise<void> {
    this.state.blend = share;
    if (share > 0 && !(await this.symmetric.take())) return;
    this.stale = true;
    this.showHandles();
    this.solveNow(); // the table of residuals is that of what is shown
    this.view.draw();
    this.onChange();
  }

  /** Makes the shape that the slider shows the mesh that is edited. */
  async keepBlend(): Promise<void> {
    const { annotation, mode, blend } = this.state;
    if (blend === 0 || !this.symmetric.isKnown) return;
    this.core.keepBlend(blend);
    const name = this.meshName.replace(/\.[^.]*$/, "") + "_symmetric.ply";
    const mesh = this.core.writeMesh("ply", true);
    const changed = structuredClone(annotation);
    (changed.mesh as { diagonal: number }).diagonal = this.core.info().diagonal;
    this.shownKey = "";
    await this.open(name, mesh, changed, null, mode);
  }
}
