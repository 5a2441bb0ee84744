// The core (core/editor.h) as the page and its worker call it.
import createModule from "editor-core";

/** What the WebAssembly module offers. */
interface Module {
  HEAPU8: Uint8Array;
  FS: {
    writeFile(file: string, data: Uint8Array | string): void;
    readFile(file: string): Uint8Array;
    unlink(file: string): void;
    analyzePath(file: string): { exists: boolean };
  };
  UTF8ToString(pointer: number): string;
  addFunction(call: (...numbers: number[]) => void, signature: string): number;
  removeFunction(pointer: number): void;
  [name: `_editor_${string}`]: (...numbers: number[]) => number;
}

export interface Info {
  vertices: number;
  faces: number;
  diagonal: number;
  centre: [number, number, number];
  regions: number;
  mode?: string;
  samples?: number;
  degrees_of_freedom?: number;
}

/** How a basis is sampled, as `orbifit edit` was told; 0 chooses. */
export interface Sampling {
  lift: number; // 0 orbit, 1 paper
  radius: number; // mesh units
  samples: number;
  sharp: boolean;
  radius_field?: { name: string; text: string }; // as `orbifit deform` reads it
}
export const usualSampling: Sampling = { lift: 0, radius: 0, samples: 0, sharp: false };

export interface SolveRecord {
  solve: number;
  lift: number;
  show: number;
  handleError: number;
}

export interface RegionResidual {
  rms: number;
  max: number;
}

export interface Pick {
  face: number;
  barycentric: [number, number, number];
  point: [number, number, number];
}

/** Why the core refused something, in its words. */
export class CoreError extends Error {}

export const enum Side { symmetric = 0, free = 1 }
export const enum ResidualKind { deformation = 0, free = 1, shape = 2 }

const scratchNumbers = 4096;
const noMemory = "not enough memory"; // in the core's words
export const tooLarge = (name: string): string =>
  `${name}: too large for the browser's memory; \`orbifit deform\` edits it without a browser`;

export class Core {
  private readonly session: number;
  private readonly scratch: number; // numbers to and fro
  private motionsAt = 0;
  private motionsRoom = 0;

  private constructor(private readonly module: Module) {
    this.session = module._editor_new();
    this.scratch = module._editor_allocate(8 * scratchNumbers);
    if (!this.session || !this.scratch) throw new CoreError("not enough memory");
  }

  static async create(wasm: Uint8Array): Promise<Core> {
    return new Core(await createModule({ wasmBinary: wasm }) as Module);
  }

  get memory(): ArrayBufferLike { return this.module.HEAPU8.buffer; }

  private checked(result: number): number {
    if (result < 0) throw new CoreError(this.module.UTF8ToString(this.module._editor_error()));
    return result;
  }

  private text(pointer: number): string {
    if (!pointer) throw new CoreError(this.module.UTF8ToString(this.module._editor_error()));
    return this.module.UTF8ToString(pointer);
  }

  private numbers(count: number, at = this.scratch): Float64Array {
    return new Float64Array(this.memory as ArrayBuffer, at, count);
  }

  private all = new Float64Array(0);
  /** The whole memory. */
  private doubles(): Float64Array {
    if (this.all.buffer !== this.memory) this.all = new Float64Array(this.memory as ArrayBuffer);
    return this.all;
  }

  /** Calls with a file's name as the second argument. */
  private withName(call: (session: number, name: number, ...rest: number[]) => number, file: string,
                   ...rest: number[]): number {
    const bytes = new TextEncoder().encode(file + "\0");
    const name = this.module._editor_allocate(bytes.length);
    this.module.HEAPU8.set(bytes, name);
    try {
      return call(this.session, name, ...rest);
    } finally {
      this.module._editor_release(name);
    }
  }

  /** A file that the core reads, under the name that its messages are to have. */
  private withFile<Result>(name: string, data: Uint8Array | string, use: (file: string) => Result): Result {
    const file = "/" + name.replace(/[/\\]/g, "_");
    try {
      this.module.FS.writeFile(file, data);
      return use(file);
    } catch (error) {
      if (error instanceof RangeError || (error instanceof CoreError && error.message === noMemory)) {
        throw new CoreError(tooLarge(name));
      }
      if (error instanceof CoreError) throw new CoreError(error.message.replaceAll(file, name));
      throw error;
    } finally {
      if (this.module.FS.analyzePath(file).exists) this.module.FS.unlink(file);
    }
  }

  private written(name: string, write: (file: string) => number): Uint8Array {
    const file = "/" + name;
    this.checked(write(file));
    const bytes = this.module.FS.readFile(file);
    this.module.FS.unlink(file);
    return bytes;
  }

  readMesh(name: string, data: Uint8Array): void {
    this.withFile(name, data, file => this.checked(this.withName(this.module._editor_read_mesh!, file)));
  }
  /** \param consistent  it is one that annotation() gave */
  readAnnotation(name: string, text: string, consistent = false): void {
    this.withFile(name, text, file =>
      this.checked(this.withName(this.module._editor_read_annotation!, file, consistent ? 1 : 0)));
  }
  readBasis(data: Uint8Array): void {
    this.withFile("basis", data, file => this.checked(this.withName(this.module._editor_read_basis!, file)));
  }
  writeBasis(): Uint8Array {
    return this.written("written.basis", file => this.withName(this.module._editor_write_basis!, file));
  }
  writeMesh(ending: string, atRest: boolean): Uint8Array {
    return this.written("written." + ending,
                        file => this.withName(this.module._editor_write_mesh!, file, atRest ? 1 : 0));
  }
  buildBasis(mode: number, { lift, radius, samples, sharp, radius_field }: Sampling): void {
    const build = (field: number): number => this.checked(
      this.module._editor_build_basis!(this.session, mode, lift, radius, samples, sharp ? 1 : 0, field));
    if (!radius_field) build(0);
    else this.withFile(radius_field.name, radius_field.text, file => this.withName((_, name) => build(name), file));
  }
  annotation(): string { return this.text(this.module._editor_annotation!(this.session)); }
  info(): Info { return JSON.parse(this.text(this.module._editor_info!(this.session))) as Info; }

  displayVertices(): number { return this.module._editor_display_vertices!(this.session); }
  displayTriangles(): number { return this.module._editor_display_triangles!(this.session); }
  triangles(): Uint32Array {
    return new Uint32Array(this.memory as ArrayBuffer, this.module._editor_triangles!(this.session),
                           3 * this.displayTriangles());
  }
  positions(side: Side): Float32Array {
    return this.floats(side, this.module._editor_positions!(this.session, side), 3 * this.displayVertices());
  }
  normals(side: Side): Float32Array {
    return this.floats(2 + side, this.module._editor_normals!(this.session, side), 3 * this.displayVertices());
  }
  private readonly kept: Float32Array[] = [];
  /** A view of the memory, the same as the last with this number where that is still right: a frame makes none. */
  private floats(number: number, at: number, count: number): Float32Array {
    const known = this.kept[number];
    if (known?.buffer === this.memory && known.byteOffset === at && known.length === count) return known;
    return this.kept[number] = new Float32Array(this.memory as ArrayBuffer, at, count);
  }
  marks(): Uint8Array {
    return new Uint8Array(this.memory as ArrayBuffer, this.module._editor_marks!(this.session),
                          4 * this.displayVertices());
  }
  vertices(side: Side, count: number): Float64Array {
    return this.numbers(3 * count, this.module._editor_vertices!(this.session, side));
  }

  setHandles(json: string): number {
    return this.withFile("handles.json", json,
                         file => this.checked(this.withName(this.module._editor_set_handles!, file)));
  }
  handleCentroid(handle: number): [number, number, number] {
    this.checked(this.module._editor_handle_centroid!(this.session, handle, this.scratch));
    const [x, y, z] = this.numbers(3);
    return [x!, y!, z!];
  }
  /** \param onwards  from what was solved for last, and not from rest */
  solve(side: Side, motions: Float64Array, iterations: number, onwards: boolean, record: SolveRecord): void {
    if (motions.length > this.motionsRoom) {
      if (this.motionsAt) this.module._editor_release(this.motionsAt);
      this.motionsRoom = 2 * motions.length;
      this.motionsAt = this.module._editor_allocate(8 * this.motionsRoom);
    }
    this.doubles().set(motions, this.motionsAt / 8);
    this.checked(this.module._editor_solve!(this.session, side, this.motionsAt, motions.length / 12, iterations,
                                            onwards ? 1 : 0, this.scratch));
    const numbers = this.doubles();
    const at = this.scratch / 8;
    record.solve = numbers[at]!;
    record.lift = numbers[at + 1]!;
    record.show = numbers[at + 2]!;
    record.handleError = numbers[at + 3]!;
  }
  rest(): void { this.checked(this.module._editor_rest!(this.session)); }
  show(vertices: Float64Array): void {
    this.withNumbers(vertices, at => this.checked(this.module._editor_show!(this.session, at)));
  }
  /** \param basis  of an empty annotation: what the side without symmetries is edited with */
  compare(basis: Uint8Array): void {
    this.withFile("basis", basis, file => this.checked(this.withName(this.module._editor_compare!, file)));
  }
  stopComparing(): void { this.checked(this.module._editor_compare!(this.session, 0)); }

  residuals(kind: ResidualKind): RegionResidual[] {
    const count = this.checked(this.module._editor_residuals!(this.session, kind, this.scratch));
    const numbers = this.numbers(2 * count);
    return Array.from({ length: count }, (_, r) => ({ rms: numbers[2 * r]!, max: numbers[2 * r + 1]! }));
  }
  /** 3 by 4, by row; written into `motion`. */
  carried(region: number, motion: Float64Array): void {
    this.checked(this.module._editor_carried!(this.session, region, this.scratch));
    motion.set(this.numbers(12));
  }

  pick(ray: ArrayLike<number>): Pick | null {
    this.numbers(6).set(ray);
    const face = this.module._editor_pick!(this.session, this.scratch, this.scratch + 48);
    if (face === -1) return null;
    if (face < 0) this.checked(face);
    const [x, y, z, a, b, c] = this.numbers(6, this.scratch + 48);
    return { face, point: [x!, y!, z!], barycentric: [a!, b!, c!] };
  }
  orbit(pick: { face: number; barycentric: ArrayLike<number> }, radius: number): Float32Array {
    this.numbers(3).set(pick.barycentric);
    const count = this.checked(this.module._editor_orbit!(this.session, pick.face, this.scratch, radius));
    return new Float32Array(this.memory as ArrayBuffer, this.module._editor_orbit_points!(this.session), 3 * count);
  }
  clearOrbit(): void { this.checked(this.module._editor_clear_orbit!(this.session)); }
  restPoint(face: number, barycentric: ArrayLike<number>): [number, number, number] {
    this.numbers(3).set(barycentric);
    this.checked(this.module._editor_rest_point!(this.session, face, this.scratch, this.scratch + 24));
    const [x, y, z] = this.numbers(3, this.scratch + 24);
    return [x!, y!, z!];
  }
  regionsOf(face: number): number[] {
    const most = 256;
    const count = this.checked(this.module._editor_regions_of!(this.session, face, this.scratch, most));
    return Array.from(new Int32Array(this.memory as ArrayBuffer, this.scratch, count));
  }
  markRegion(region: number): void { this.checked(this.module._editor_mark_region!(this.session, region)); }

  symmetrize(): { report: string; vertices: Float64Array } {
    const report = this.text(this.module._editor_symmetrize!(this.session));
    const count = this.info().vertices;
    return { report, vertices: this.numbers(3 * count, this.module._editor_symmetric!(this.session)).slice() };
  }
  setSymmetric(vertices: Float64Array): void {
    this.withNumbers(vertices, at => this.checked(this.module._editor_set_symmetric!(this.session, at)));
  }
  blend(share: number): void { this.checked(this.module._editor_blend!(this.session, share)); }
  keepBlend(share: number): void { this.checked(this.module._editor_keep_blend!(this.session, share)); }

  readScan(name: string, data: Uint8Array): Float32Array {
    const count = this.withFile(name, data,
                                file => this.checked(this.withName(this.module._editor_read_scan!, file)));
    return new Float32Array(this.memory as ArrayBuffer, this.module._editor_scan_points!(this.session),
                            3 * count).slice();
  }
  fit(name: string, data: Uint8Array, place: boolean,
      step: (number: number, rms: number, stiffness: number) => void): string {
    const call = this.module.addFunction(step, "vidd");
    try {
      return this.withFile(name, data, file =>
        this.text(this.withName(this.module._editor_fit!, file, place ? 1 : 0, call)));
    } finally {
      this.module.removeFunction(call);
    }
  }

  private withNumbers(numbers: Float64Array, use: (at: number) => void): void {
    const at = this.module._editor_allocate!(8 * numbers.length);
    if (!at) throw new CoreError("not enough memory");
    try {
      this.numbers(numbers.length, at).set(numbers);
      use(at);
    } finally {
      this.module._editor_release!(at);
    }
  }
}
