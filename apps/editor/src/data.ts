// What the page carries in itself, and files in and out.
import workerCode from "worker-code";
import type { Answer, Request, Task } from "./worker";

function bytesOf(base64: string): Uint8Array {
  const text = atob(base64.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** The block of data with this id, or null. */
export function embedded(id: string): { name: string; source: string; data: Uint8Array } | null {
  const element = document.getElementById(id);
  if (!element) return null;
  const data = bytesOf(element.textContent ?? "");
  element.textContent = "";
  const name = element.dataset.name ?? id;
  return { name, source: element.dataset.source || name, data };
}

/** What the element with this id has packed; of page.html. */
declare function unpacked(id: string): Promise<Response>;

export async function coreBytes(): Promise<Uint8Array> {
  if (!document.getElementById("core")) throw new Error("the page has no core: it was not built whole");
  return new Uint8Array(await (await unpacked("core")).arrayBuffer());
}

export function download(name: string, data: Uint8Array | string, type = "application/octet-stream"): void {
  const url = URL.createObjectURL(new Blob([data as BlobPart], { type }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Runs tasks in the worker, one after another. */
export class Background {
  private worker: Worker | null = null;
  private number = 0;
  private readonly waiting = new Map<number, (answer: Answer) => void>();
  private mesh: { name: string; data: Uint8Array } | null = null;
  private meshSent = false;

  constructor(private readonly wasm: Uint8Array) {}

  setMesh(name: string, data: Uint8Array): void {
    this.mesh = { name, data };
    this.meshSent = false;
  }

  /** \param each  every answer but the last, and errors \return the last answer of this kind */
  run<Kind extends Task["kind"]>(task: Task & { kind: Kind },
                                 each: (answer: Answer) => void = () => {}): Promise<Answer & { kind: Kind }> {
    const request = this.request();
    const { number } = request;
    request.task = task;
    return new Promise((resolve, reject) => {
      this.waiting.set(number, answer => {
        if (answer.kind !== task.kind && answer.kind !== "error") {
          each(answer);
          return;
        }
        this.waiting.delete(number);
        if (answer.kind === "error") reject(new Error(answer.message));
        else resolve(answer as Answer & { kind: Kind });
      });
      this.worker!.postMessage(request);
    });
  }

  private preparing = 0; // a timer's
  /** Starts the worker and gives it the mesh once the page is at rest: the first task then need not wait for that. */
  prepareSoon(): void {
    const atRest = 500; // ms
    clearTimeout(this.preparing);
    this.preparing = window.setTimeout(() => {
      if (this.worker && this.meshSent) return;
      const request = this.request();
      this.worker!.postMessage(request);
    }, atRest);
  }

  /** The next request, with what the worker lacks; there is a worker then. */
  private request(): Request {
    const request: Request = { number: ++this.number };
    if (!this.worker) {
      this.worker = new Worker(URL.createObjectURL(new Blob([workerCode], { type: "text/javascript" })));
      this.worker.addEventListener("message", (event: MessageEvent<Answer>) =>
        this.waiting.get(event.data.number)?.(event.data));
      request.wasm = this.wasm;
      this.meshSent = false;
    }
    if (!this.meshSent && this.mesh) {
      request.mesh = this.mesh;
      this.meshSent = true;
    }
    return request;
  }

  /** Gives up whatever runs. */
  stop(): void {
    this.worker?.terminate();
    this.worker = null;
    for (const [number, answer] of this.waiting) answer({ number, kind: "error", message: "stopped" });
    this.waiting.clear();
  }
}
