// What is edited, and everything that can be done to it. The interface (panel.ts, input.ts) calls this and listens.
import {
  elementsOf, emptyAnnotation, extentOf, faceCount, isAnnotation, without, type Annotation, type Element, type Extent,
  type Region
} from "./annotation";
import {
  Core, ResidualKind, Side, usualSampling, type Info, type Pick, type RegionResidual, type Sampling, type SolveRecord
} from "./core";
import type { Background } from "./data";
import { moved, toJson, writeMotion, type Handle } from "./handles";
import { add, length, sub, times, type Vec3 } from "./math";
import type { View } from "./view";

export const modes = ["fixed", "floating", "moving"] as const;

/** What undo takes back. */
export interface Snapshot {
  handles: Handle[];
  alpha: number;
  iterations: number;
  mode: number;
  off: number[]; // ids of regions
  blend: number; // 0: the mesh as it is ... 1: the exactly symmetric one; not 0 without that one
  annotation: Annotation; // shared between snapshots where it is the same
}

/** Rms and largest residual of a region, fractions of the diagonal, of the mesh as it is and of the symmetric one. */
export interface SymmetryChange { id: number; before: [number, number]; after: [number, number] }
export interface FitReport { converged: boolean; rms: number; stopped_because: string; inlier_ratio: number }

interface Basis { bytes: Uint8Array; annotation: string }

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
  residual = 0; // worst region's largest, of the deformation that was measured last
  freeResidual = 0;
  fitSteps: { step: number; rms: number }[] = [];
  fitted = false;

  private meshData: Uint8Array = new Uint8Array();
  private undone: Snapshot[] = [];
  private done: Snapshot[] = [];
  private bases = new Map<string, Basis>();
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
  private extents = new Map<string, { elements: Element[]; extent: Extent }>();
  private symmetricOf = ""; // the regions that the core has the symmetric shape of
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
    this.done = [];
    this.undone = [];
    this.bases.clear();
    this.extents.clear();
    this.sampling = usualSampling;
    this.symmetricOf = "";
    this.symmetryReport = [];
    this.fitted = false;
    this.comparing = false;
    this.view.setSplit(false);
    const taken = annotation ?? emptyAnnotation(this.info.vertices, this.info.faces, this.info.diagonal);
    this.state = { handles: [], alpha: 100, iterations: 10, mode, off: [], blend: 0, annotation: taken };
    this.selected = -1;
    if (basis) this.bases.set(this.basisKey(), { bytes: basis, annotation: JSON.stringify(taken) });
    this.view.setMesh(this.core);
    this.scan = null;
    this.fitReport = null;
    this.fitSteps = [];
    this.view.showScan(null);
    this.view.showOrbit(null);
    this.view.showElements("", () => [], this.info);
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
    this.shownKey = this.symmetricOf = "";
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

  shape(region: Region): { elements: Element[]; extent: Extent } {
    const key = `${region.id} ${faceCount(region)} ${region.group} ${region.centre.join()}`;
    let known = this.extents.get(key);
    if (!known) {
      const corner = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
      known = { elements: elementsOf(region),
                extent: extentOf(region, face => corner.map(weights => this.core.restPoint(face, weights))) };
      this.extents.set(key, known);
    }
    return known;
  }

  /** Draws planes and axes of some regions. */
  showRegions(ids: readonly number[]): void {
    const turn = this.state.handles.length ? JSON.stringify(this.state.handles) : "";
    this.view.showElements(ids.length ? ids.join() + turn : "", () => ids.flatMap(id => {
      const region = this.regions.find(other => other.id === id);
      if (!region) return [];
      const carried = new Float64Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
      const number = this.coreNumber(id);
      if (number >= 0) this.core.carried(number, carried);
      return [{ ...this.shape(region), carried }];
    }), this.info);
  }

  markRegion(id: number): void {
    const number = id < 0 ? -1 : this.coreNumber(id);
    this.core.markRegion(number);
    this.view.marksChanged();
    this.showRegions(id < 0 ? [] : [id]);
  }

  // Changes and undo ----------------------------------------------------------------------------------------------

  snapshot(): Snapshot {
    return { ...this.state, handles: structuredClone(this.state.handles), off: [...this.state.off] };
  }

  /** Remembers what is there, for undo. */
  remember(snapshot = this.snapshot()): void {
    this.done.push(snapshot);
    if (this.done.length > 200) this.done.shift();
    this.undone = [];
  }

  /** A change of anything, which undo takes back. */
  async change(edit: (state: Snapshot) => void): Promise<void> {
    this.remember();
    edit(this.state);
    if (await this.restored()) return;
    this.state = this.done.pop()!; // there is no basis of what was asked for
    this.shownKey = "";
    await this.restored();
  }

  async undo(): Promise<void> { await this.swap(this.done, this.undone); }
  async redo(): Promise<void> { await this.swap(this.undone, this.done); }
  get canUndo(): boolean { return this.done.length > 0; }
  get canRedo(): boolean { return this.undone.length > 0; }

  private async swap(from: Snapshot[], to: Snapshot[]): Promise<void> {
    const snapshot = from.pop();
    if (!snapshot) return;
    to.push(this.snapshot());
    this.state = snapshot;
    await this.restored();
  }

  /** \return false where there is no basis */
  private async restored(): Promise<boolean> {
    if (this.selected >= this.state.handles.length) this.selected = -1;
    const known = await this.takeBasis();
    if (this.state.blend > 0) await this.takeSymmetric();
    this.refresh();
    return known;
  }

  // The basis -----------------------------------------------------------------------------------------------------

  private active(): Annotation { return without(this.state.annotation, new Set(this.state.off)); }

  private annotationKeys = new Map<Annotation, number>();
  private regionsKey(): string {
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
        const answer = await this.background.run(
          { kind: "basis", annotation: JSON.stringify(this.active()), mode: this.state.mode, sampling: this.sampling });
        basis = { bytes: answer.basis, annotation: answer.annotation };
        this.bases.set(key, basis);
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
    let basis = this.bases.get(key);
    if (!basis) {
      const annotation = JSON.stringify(emptyAnnotation(vertices, faces, diagonal));
      const answer = await this.background.run({ kind: "basis", annotation, mode: this.state.mode, sampling });
      basis = { bytes: answer.basis, annotation };
      this.bases.set(key, basis);
    }
    this.core.compare(basis.bytes);
  }

  private failed(error: unknown): void {
    const message = error instanceof Error ? error.message : String(error);
    if (message !== "stopped") this.onError(message);
  }

  private setBusy(what: string): void {
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
    this.fitted = false;
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
    this.measureSoon();
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

  private measuring = 0; // a timer's
  private measured = 0; // when
  private measuringTook = 0; // ms
  /** Measures now, where that takes a tenth of the time at most, and in any case once nothing has moved for a while. */
  private measureSoon(): void {
    clearTimeout(this.measuring);
    this.measuring = 0;
    const cheap = this.measuringTook < 8 && performance.now() - this.measured > 10 * this.measuringTook;
    if (cheap && this.measured > 0) this.measure();
    else this.measuring = window.setTimeout(this.measureNow, 120);
  }

  /** Whether the residuals are those of what is shown. */
  get isMeasured(): boolean { return this.measuring === 0 && !this.stale; }

  private readonly measureNow = (): void => {
    try {
      this.measure();
    } catch (error) {
      this.failed(error);
    }
  };
  private measure(): void {
    this.measuring = 0;
    const worst = (list: RegionResidual[]): number => list.reduce((most, entry) => Math.max(most, entry.max), 0);
    const start = performance.now();
    this.residual = worst(this.core.residuals(ResidualKind.deformation));
    this.freeResidual = this.comparing ? worst(this.core.residuals(ResidualKind.free)) : 0;
    this.measured = performance.now();
    this.measuringTook = this.measured - start;
    this.onSolved();
  }

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

  symmetryReport: SymmetryChange[] = [];
  /** Shows what lies between the mesh as it is (0) and the exactly symmetric one (1). */
  async setBlend(share: number): Promise<void> {
    this.state.blend = share;
    if (share > 0 && !(await this.takeSymmetric())) return;
    this.stale = true;
    this.showHandles();
    this.solveNow(); // the table of residuals is that of what is shown
    this.view.draw();
    this.onChange();
  }

  private symmetricComes: Promise<boolean> | null = null;
  /** \return whether the core has the symmetric shape of the regions that are on; the blend is 0 where it has not */
  private async takeSymmetric(): Promise<boolean> {
    if (this.symmetricOf === this.regionsKey()) return true;
    this.symmetricComes ??= this.findSymmetric();
    const known = await this.symmetricComes;
    this.symmetricComes = null;
    if (!known) this.state.blend = 0;
    return known;
  }
  private async findSymmetric(): Promise<boolean> {
    const key = this.regionsKey();
    this.setBusy("looking for the symmetric shape");
    try {
      const answer = await this.background.run({ kind: "symmetrize", annotation: JSON.stringify(this.active()) });
      this.core.setSymmetric(answer.vertices);
      this.symmetryReport = (JSON.parse(answer.report) as { regions: SymmetryChange[] }).regions;
      this.symmetricOf = key;
      return key === this.regionsKey();
    } catch (error) {
      this.failed(error);
      return false;
    } finally {
      this.setBusy("");
    }
  }

  shapeResiduals(): Map<number, RegionResidual> {
    return new Map(this.core.residuals(ResidualKind.shape).map((entry, number) => [this.idOf(number), entry]));
  }

  /** Makes the shape that the slider shows the mesh that is edited. */
  async keepBlend(): Promise<void> {
    const { annotation, mode, blend } = this.state;
    if (blend === 0 || this.symmetricOf !== this.regionsKey()) return;
    this.core.keepBlend(blend);
    const name = this.meshName.replace(/\.[^.]*$/, "") + "_symmetric.ply";
    const mesh = this.core.writeMesh("ply", true);
    const changed = structuredClone(annotation);
    (changed.mesh as { diagonal: number }).diagonal = this.core.info().diagonal;
    this.shownKey = "";
    await this.open(name, mesh, changed, null, mode);
  }

  // Fit -----------------------------------------------------------------------------------------------------------

  scan: { name: string; data: Uint8Array; points: number } | null = null;
  fitReport: FitReport | null = null;

  openScan(name: string, data: Uint8Array): void {
    const points = this.core.readScan(name, data);
    this.scan = { name, data, points: points.length / 3 };
    this.fitReport = null;
    this.fitSteps = [];
    this.view.showScan(points);
    this.onChange();
  }

  /** The mesh is then again what the handles make of it. */
  closeScan(): void {
    this.scan = null;
    this.fitReport = null;
    this.fitSteps = [];
    this.view.showScan(null);
    this.handlesChanged();
  }

  async fit(place: boolean): Promise<void> {
    if (!this.scan || this.busy) return;
    this.fitSteps = [];
    this.fitReport = null;
    this.setBusy("fitting");
    try {
      const answer = await this.background.run(
        { kind: "fit", annotation: JSON.stringify(this.active()), scanName: this.scan.name, scan: this.scan.data, place },
        step => {
          if (step.kind !== "fit-step") return;
          this.core.show(step.vertices);
          this.view.positionsChanged(Side.symmetric);
          this.fitSteps.push({ step: step.step, rms: step.rms });
          this.onChange();
        });
      this.core.show(answer.vertices);
      this.view.positionsChanged(Side.symmetric);
      this.fitReport = JSON.parse(answer.report) as FitReport;
      this.fitted = true;
    } catch (error) {
      this.failed(error);
    } finally {
      this.setBusy("");
    }
  }

  get originalMesh(): Uint8Array { return this.meshData; }
  readAnnotationText(text: string): Annotation {
    const value: unknown = JSON.parse(text);
    if (!isAnnotation(value)) throw new Error("no symmetry annotation");
    return value;
  }
}
