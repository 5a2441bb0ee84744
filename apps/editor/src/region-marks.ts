// A region's faces marked, planes and axes of regions drawn.
import { elementsOf, extentOf, faceCount, type Element, type Extent, type Region } from "./annotation";
import type { Editor } from "./editor";

export class RegionMarks {
  private readonly shapes = new Map<string, { elements: Element[]; extent: Extent }>();

  constructor(private readonly editor: Editor) {}

  /** Of another mesh there are none yet. */
  clear(): void {
    this.shapes.clear();
    this.editor.view.showElements("", () => [], this.editor.info);
  }

  private shape(region: Region): { elements: Element[]; extent: Extent } {
    const key = `${region.id} ${faceCount(region)} ${region.group} ${region.centre.join()}`;
    let known = this.shapes.get(key);
    if (!known) {
      const corner = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
      known = { elements: elementsOf(region),
                extent: extentOf(region, face => corner.map(weights => this.editor.core.restPoint(face, weights))) };
      this.shapes.set(key, known);
    }
    return known;
  }

  /** Draws planes and axes of some regions. */
  show(ids: readonly number[]): void {
    const { editor } = this;
    const { handles } = editor.state;
    const turn = handles.length ? JSON.stringify(handles) : "";
    editor.view.showElements(ids.length ? ids.join() + turn : "", () => ids.flatMap(id => {
      const region = editor.regions.find(other => other.id === id);
      if (!region) return [];
      const carried = new Float64Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
      const number = editor.coreNumber(id);
      if (number >= 0) editor.core.carried(number, carried);
      return [{ ...this.shape(region), carried }];
    }), editor.info);
  }

  /** Marks one region's faces, or none's (-1), and draws its planes and axes. */
  mark(id: number): void {
    const number = id < 0 ? -1 : this.editor.coreNumber(id);
    this.editor.core.markRegion(number);
    this.editor.view.marksChanged();
    this.show(id < 0 ? [] : [id]);
  }
}
