// A scan, and the mesh fitted to it.
import { Side } from "./core";
import type { Editor } from "./editor";

export interface FitReport { converged: boolean; rms: number; stopped_because: string; inlier_ratio: number }

export class ScanFit {
  scan: { name: string; data: Uint8Array; points: number } | null = null;
  report: FitReport | null = null;
  steps: { step: number; rms: number }[] = [];

  constructor(private readonly editor: Editor) {}

  open(name: string, data: Uint8Array): void {
    const { core, view } = this.editor;
    const points = core.readScan(name, data);
    this.scan = { name, data, points: points.length / 3 };
    this.report = null;
    this.steps = [];
    view.showScan(points);
    this.editor.onChange();
  }

  /** The mesh is then again what the handles make of it. */
  close(): void {
    this.forget();
    this.editor.handlesChanged();
  }

  forget(): void {
    this.scan = null;
    this.report = null;
    this.steps = [];
    this.editor.view.showScan(null);
  }

  /** \param place  whether the mesh is to be placed in the scan first */
  async run(place: boolean): Promise<void> {
    const { editor, scan } = this;
    const { core, view } = editor;
    if (!scan || editor.busy) return;
    this.steps = [];
    this.report = null;
    editor.setBusy("fitting");
    try {
      const answer = await editor.background.run(
        { kind: "fit", annotation: JSON.stringify(editor.active()), scanName: scan.name, scan: scan.data, place },
        step => {
          if (step.kind !== "fit-step") return;
          core.show(step.vertices);
          view.positionsChanged(Side.symmetric);
          this.steps.push({ step: step.step, rms: step.rms });
          editor.onChange();
        });
      core.show(answer.vertices);
      view.positionsChanged(Side.symmetric);
      this.report = JSON.parse(answer.report) as FitReport;
    } catch (error) {
      editor.failed(error);
    } finally {
      editor.setBusy("");
    }
  }
}
