// What takes long: a session of its own beside the page's, which builds bases, symmetric shapes and fits.
import { Core, Side, type Sampling } from "./core";

export type Task =
  | { kind: "basis"; annotation: string; mode: number; sampling: Sampling }
  | { kind: "symmetrize"; annotation: string }
  | { kind: "fit"; annotation: string; scanName: string; scan: Uint8Array; place: boolean };
export interface Request {
  number: number;
  wasm?: Uint8Array; // with the first
  mesh?: { name: string; data: Uint8Array }; // when it is another
  task?: Task; // none: to be ready for the next
}
export type Answer =
  | { number: number; kind: "error"; message: string }
  | { number: number; kind: "basis"; basis: Uint8Array; annotation: string; milliseconds: number }
  | { number: number; kind: "symmetrize"; report: string; vertices: Float64Array }
  | { number: number; kind: "fit-step"; step: number; rms: number; stiffness: number; vertices: Float64Array }
  | { number: number; kind: "fit"; report: string; vertices: Float64Array };

let core: Core | undefined;
let vertexCount = 0;

const answer = (message: Answer, transfer: Transferable[] = []) =>
  (self as unknown as { postMessage(message: Answer, transfer: Transferable[]): void }).postMessage(message, transfer);

function shownVertices(session: Core): Float64Array<ArrayBuffer> {
  return new Float64Array(session.vertices(Side.symmetric, vertexCount));
}

function run(session: Core, number: number, task: Task): void {
  session.readAnnotation("annotation.json", task.annotation);
  if (task.kind === "basis") {
    const start = performance.now();
    session.buildBasis(task.mode, task.sampling);
    const basis = session.writeBasis();
    answer({ number, kind: "basis", basis, annotation: session.annotation(),
             milliseconds: performance.now() - start }, [basis.buffer]);
  } else if (task.kind === "symmetrize") {
    answer({ number, kind: "symmetrize", ...session.symmetrize() });
  } else {
    const report = session.fit(task.scanName, task.scan, task.place, (step, rms, stiffness) => {
      const vertices = shownVertices(session);
      answer({ number, kind: "fit-step", step, rms, stiffness, vertices }, [vertices.buffer]);
    });
    answer({ number, kind: "fit", report, vertices: shownVertices(session) });
  }
}

async function serve({ number, wasm, mesh, task }: Request): Promise<void> {
  try {
    if (wasm) core = await Core.create(wasm);
    if (!core) throw new Error("the core is missing");
    if (mesh) {
      core.readMesh(mesh.name, mesh.data);
      vertexCount = core.info().vertices;
    }
    if (task) run(core, number, task);
  } catch (error) {
    answer({ number, kind: "error", message: error instanceof Error ? error.message : String(error) });
  }
}

// One after another: the core is made asynchronously, and what comes meanwhile waits for it.
let served = Promise.resolve();
self.addEventListener("message", (event: MessageEvent<Request>) => {
  served = served.then(() => serve(event.data));
});
