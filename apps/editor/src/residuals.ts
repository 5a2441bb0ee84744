// How far what is shown is off its symmetries, measured when there is time for it.
import { ResidualKind, type RegionResidual } from "./core";
import type { Editor } from "./editor";

const worst = (list: RegionResidual[]): number => list.reduce((most, entry) => Math.max(most, entry.max), 0);

export class Residuals {
  symmetric = 0; // worst region's largest, of the deformation that was measured last
  free = 0; // the same on the side without symmetries
  private timer = 0;
  private measured = 0; // when
  private took = 0; // ms

  constructor(private readonly editor: Editor) {}

  /** Measures now, where that takes a tenth of the time at most, and in any case once nothing has moved for a while. */
  measureSoon(): void {
    clearTimeout(this.timer);
    this.timer = 0;
    const cheap = this.took < 8 && performance.now() - this.measured > 10 * this.took;
    if (cheap && this.measured > 0) this.measure();
    else this.timer = window.setTimeout(this.measureLater, 120);
  }

  get areMeasured(): boolean { return this.timer === 0; }

  private readonly measureLater = (): void => {
    try {
      this.measure();
    } catch (error) {
      this.editor.failed(error);
    }
  };
  private measure(): void {
    const { core, comparing } = this.editor;
    this.timer = 0;
    const start = performance.now();
    this.symmetric = worst(core.residuals(ResidualKind.deformation));
    this.free = comparing ? worst(core.residuals(ResidualKind.free)) : 0;
    this.measured = performance.now();
    this.took = this.measured - start;
    this.editor.onSolved();
  }
}
