// The exactly symmetric shape of the mesh, found in the worker when it is asked for.
import { ResidualKind, type RegionResidual } from "./core";
import type { Editor } from "./editor";

/** Rms and largest residual of a region, fractions of the diagonal, of the mesh as it is and of the symmetric one. */
export interface SymmetryChange { id: number; before: [number, number]; after: [number, number] }

export class SymmetricShape {
  report: SymmetryChange[] = [];
  private of = ""; // the regions that the core has the symmetric shape of
  private comes: Promise<boolean> | null = null;

  constructor(private readonly editor: Editor) {}

  /** The core has none any more. */
  forget(): void { this.of = ""; }

  /** Whether the core has that of the regions that are on. */
  get isKnown(): boolean { return this.of === this.editor.regionsKey(); }

  /** Has the core take it. \return whether it has it; the blend is 0 where it has not */
  async take(): Promise<boolean> {
    if (this.isKnown) return true;
    this.comes ??= this.find();
    const known = await this.comes;
    this.comes = null;
    if (!known) this.editor.state.blend = 0;
    return known;
  }

  private async find(): Promise<boolean> {
    const { editor } = this;
    const key = editor.regionsKey();
    editor.setBusy("looking for the symmetric shape");
    try {
      const answer = await editor.background.run({ kind: "symmetrize", annotation: JSON.stringify(editor.active()) });
      editor.core.setSymmetric(answer.vertices);
      this.report = (JSON.parse(answer.report) as { regions: SymmetryChange[] }).regions;
      this.of = key;
      return this.isKnown;
    } catch (error) {
      editor.failed(error);
      return false;
    } finally {
      editor.setBusy("");
    }
  }

  /** Residuals of the shape that is shown, by region. */
  residuals(): Map<number, RegionResidual> {
    const { core } = this.editor;
    return new Map(core.residuals(ResidualKind.shape).map((entry, number) => [this.editor.idOf(number), entry]));
  }
}
