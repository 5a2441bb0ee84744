// Bases, built in the worker and kept: undo and regions switched on again come back to them.
import type { Sampling } from "./core";
import type { Editor } from "./editor";

export interface Basis { bytes: Uint8Array; annotation: string }

export class Bases {
  private readonly known = new Map<string, Basis>();

  constructor(private readonly editor: Editor) {}

  clear(): void { this.known.clear(); }
  get(key: string): Basis | undefined { return this.known.get(key); }
  set(key: string, basis: Basis): void { this.known.set(key, basis); }

  /** \param key  by which it is found again \param annotation  as text */
  async build(key: string, annotation: string, mode: number, sampling: Sampling): Promise<Basis> {
    const answer = await this.editor.background.run({ kind: "basis", annotation, mode, sampling });
    const basis = { bytes: answer.basis, annotation: answer.annotation };
    this.known.set(key, basis);
    return basis;
  }
}
