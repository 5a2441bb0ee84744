// Mouse, touch, keys and dropped files.
import { Quaternion as ThreeQuaternion, Vector3 } from "three";

import type { Pick } from "./core";
import type { Editor } from "./editor";
import { add, sub, times, type Vec3 } from "./math";
import type { Snapshot } from "./undo-history";

const reach = 14; // pixels from a handle's dot
const fingerReach = 28;
const still = 4; // pixels that a click may move

export type Tool = "move" | "rotate" | "scale";

export class Input {
  pinNext = false;
  tool: Tool | null = null;
  private drag: { number: number; before: Snapshot; start: Vec3; from: Vec3; through: Vec3; moved: boolean; keep: number } | null = null;
  private pressed: { x: number; y: number; number: number } | null = null;
  private hover: { x: number; y: number } | null = null;
  private hovered: Pick | null = null;
  private gizmoBefore: Snapshot | null = null;
  private gizmoStart: { translation: Vec3; rotation: ThreeQuaternion; scale: number; position: Vec3 } | null = null;
  onTool: () => void = () => {};

  constructor(private readonly editor: Editor, private readonly canvas: HTMLCanvasElement) {
    // Before the camera's own listeners: a press on a handle is not theirs.
    canvas.addEventListener("pointerdown", event => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", event => this.move(event), { capture: true });
    window.addEventListener("pointerup", event => this.up(event), { capture: true });
    canvas.addEventListener("pointerleave", () => this.leave());
    canvas.addEventListener("wheel", event => this.wheel(event), { capture: true, passive: false });
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    window.addEventListener("keydown", event => this.key(event));
    this.gizmo();
  }

  private nearestHandle(x: number, y: number, within = reach): number {
    let best = -1, least = within;
    if (!this.editor.state || this.editor.state.blend > 0) return best; // they are not shown
    this.editor.state.handles.forEach((_, number) => {
      const [sx, sy] = this.editor.view.screen(this.editor.target(number));
      const distance = Math.hypot(sx - x, sy - y);
      if (distance < least) [best, least] = [number, distance];
    });
    return best;
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary) return;
    if (this.editor.view.gizmo.axis && this.tool) return; // the gizmo's
    const { editor } = this;
    const number = this.nearestHandle(event.clientX, event.clientY, event.pointerType === "touch" ? fingerReach : reach);
    this.pressed = { x: event.clientX, y: event.clientY, number };
    this.leave();
    if (number < 0) return;
    event.stopImmediatePropagation();
    editor.select(number);
    this.attachGizmo();
    const handle = editor.state.handles[number]!;
    const through = editor.target(number);
    this.canvas.setPointerCapture(event.pointerId);
    this.drag = { number, before: editor.snapshot(), start: [...handle.translation], moved: false, keep: -1, through,
                  from: editor.view.onViewPlane(event.clientX, event.clientY, through) };
  }

  private move(event: PointerEvent): void {
    const { editor, drag } = this;
    if (drag) {
      event.stopImmediatePropagation();
      if (!drag.moved && this.pressed && Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) < 1) return;
      drag.moved = true;
      let way = sub(editor.view.onViewPlane(event.clientX, event.clientY, drag.through), drag.from);
      if (drag.keep >= 0) way = way.map((entry, k) => k === drag.keep ? entry : 0) as Vec3;
      if (event.shiftKey) way = way.map(entry => Math.round(entry / 0.02) * 0.02) as Vec3; // of the diagonal
      const handle = editor.state.handles[drag.number]!;
      handle.translation = add(drag.start, times(editor.info.diagonal, way));
      if (handle.pin) handle.pin = false;
      editor.motionsChanged(true);
      return;
    }
    if (event.buttons === 0 && event.pointerType !== "touch") {
      if (!this.hover) requestAnimationFrame(() => this.look());
      this.hover = { x: event.clientX, y: event.clientY };
    }
  }

  private up(event: PointerEvent): void {
    const { editor, drag, pressed } = this;
    this.drag = null;
    this.pressed = null;
    if (drag) {
      if (drag.moved) {
        editor.remember(drag.before);
        editor.motionsChanged();
      }
      editor.onChange();
      return;
    }
    if (!pressed || event.target !== this.canvas || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > still) return;
    const pick = editor.core.pick(editor.view.ray(event.clientX, event.clientY));
    if (pick) {
      void editor.addHandle(pick, this.pinNext).then(() => this.attachGizmo());
      this.pinNext = false;
      this.onTool();
    } else {
      editor.select(-1);
      this.attachGizmo();
    }
  }

  /** The orbit of the point under the cursor, and the planes and axes that hold it. */
  private look(): void {
    const at = this.hover;
    this.hover = null;
    const { editor } = this;
    if (!at || !editor.info || editor.busy) return;
    if (this.nearestHandle(at.x, at.y) >= 0) {
      this.canvas.style.cursor = "grab";
      this.clear();
      return;
    }
    const pick = editor.core.pick(editor.view.ray(at.x, at.y));
    this.canvas.style.cursor = pick ? "crosshair" : "default";
    if (!pick) {
      this.clear();
      return;
    }
    this.hovered = pick;
    this.lookAt(pick);
  }

  private lookAt(pick: Pick): void {
    const { editor } = this;
    editor.view.showOrbit(editor.core.orbit(pick, editor.radius * editor.info.diagonal));
    editor.view.marksChanged();
    editor.marks.show(editor.core.regionsOf(pick.face).map(number => editor.idOf(number)));
  }

  private clear(): void {
    if (!this.hovered) return;
    this.hovered = null;
    this.editor.core.clearOrbit();
    this.editor.view.showOrbit(null);
    this.editor.view.marksChanged();
    this.editor.marks.show([]);
  }

  private leave(): void {
    this.hover = null;
    this.clear();
  }

  private wheel(event: WheelEvent): void {
    if (!event.altKey) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const { editor } = this;
    editor.radius = Math.min(0.3, Math.max(0.01, editor.radius * (event.deltaY < 0 ? 1.12 : 1 / 1.12)));
    const handle = editor.state.handles[editor.selected];
    if (handle) {
      editor.remember();
      handle.radius = editor.radius * editor.info.diagonal;
      editor.handlesChanged();
    }
    if (this.hovered) this.lookAt(this.hovered);
    editor.onChange();
  }

  cancel(): boolean {
    const before = this.drag?.before ?? this.gizmoBefore;
    if (!before) return false;
    this.editor.state = before;
    this.drag = this.gizmoBefore = this.gizmoStart = null;
    this.attachGizmo();
    this.editor.motionsChanged();
    return true;
  }

  setTool(tool: Tool | null): void {
    this.tool = this.tool === tool ? null : tool;
    this.attachGizmo();
    this.onTool();
  }

  removeSelected(): void {
    if (this.editor.selected >= 0) this.editor.removeHandle(this.editor.selected);
    this.attachGizmo();
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (target.matches("input[type=text]") || document.querySelector("dialog[open]")) return;
    const { editor } = this;
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey) {
      if (key === "z") {
        event.preventDefault();
        void (event.shiftKey ? editor.redo() : editor.undo()).then(() => this.attachGizmo());
      } else if (key === "y") {
        void editor.redo();
      }
      return;
    }
    const axis = ["x", "y", "z"].indexOf(key);
    if (axis >= 0) this.keepAxis(axis);
    else if (key === "f") editor.view.frame();
    else if (key === "w") this.setTool("move");
    else if (key === "e") this.setTool("rotate");
    else if (key === "r") this.setTool("scale");
    else if (key === "c") void editor.setComparing(!editor.comparing).catch(error => editor.onError(String(error)));
    else if (key === "p") this.pin();
    else if (key === "delete" || key === "backspace") this.removeSelected();
    else if (key === "escape") {
      if (!this.cancel()) {
        this.pinNext = false;
        editor.select(-1);
        this.attachGizmo();
        this.onTool();
      }
    } else if (key === "?") (document.getElementById("keys") as HTMLDialogElement).showModal();
  }

  /** Pins what is under the cursor, or else the next area that is clicked. */
  pin(): void {
    const { editor } = this;
    if (this.hovered) void editor.addHandle(this.hovered, true);
    else this.pinNext = !this.pinNext;
    this.onTool();
  }

  private keepAxis(axis: number): void {
    if (this.drag) {
      this.drag.keep = this.drag.keep === axis ? -1 : axis;
      return;
    }
    const { gizmo } = this.editor.view;
    const only = [gizmo.showX, gizmo.showY, gizmo.showZ].every((shown, k) => shown === (k === axis));
    gizmo.showX = only || axis === 0;
    gizmo.showY = only || axis === 1;
    gizmo.showZ = only || axis === 2;
    this.editor.view.draw();
  }

  // The gizmo moves an object of its own; what it did since it was grasped goes to the handle.

  attachGizmo(): void {
    const { editor } = this;
    const { gizmo, gizmoTarget } = editor.view;
    if (!this.tool || editor.selected < 0) {
      gizmo.detach();
      editor.view.draw();
      return;
    }
    gizmoTarget.quaternion.identity();
    gizmoTarget.scale.set(1, 1, 1);
    gizmoTarget.position.set(...editor.target(editor.selected));
    gizmo.setMode(this.tool === "move" ? "translate" : this.tool);
    gizmo.attach(gizmoTarget);
    editor.view.draw();
  }

  private gizmo(): void {
    const { editor } = this;
    const { gizmo, gizmoTarget, controls } = editor.view;
    gizmo.addEventListener("dragging-changed", event => {
      controls.enabled = !event.value;
      const handle = editor.state.handles[editor.selected];
      if (!handle) return;
      if (event.value) {
        this.gizmoBefore = editor.snapshot();
        this.gizmoStart = { translation: [...handle.translation], rotation: new ThreeQuaternion(...handle.rotation),
                            scale: handle.scale, position: editor.target(editor.selected) };
      } else {
        if (this.gizmoBefore) {
          editor.remember(this.gizmoBefore);
          editor.motionsChanged();
        }
        this.gizmoBefore = this.gizmoStart = null;
        this.attachGizmo();
        editor.onChange();
      }
    });
    gizmo.addEventListener("objectChange", () => {
      const handle = editor.state.handles[editor.selected];
      const start = this.gizmoStart;
      if (!handle || !start) return;
      if (this.tool === "move") {
        const way = sub(gizmoTarget.position.toArray() as Vec3, start.position);
        handle.translation = add(start.translation, times(editor.info.diagonal, way));
      } else if (this.tool === "rotate") {
        const turned = gizmoTarget.quaternion.clone().multiply(start.rotation).normalize();
        handle.rotation = [turned.x, turned.y, turned.z, turned.w];
      } else {
        const size = new Vector3().copy(gizmoTarget.scale);
        const factor = [size.x, size.y, size.z].reduce((most, entry) =>
          Math.abs(Math.log(Math.max(0.05, entry))) > Math.abs(Math.log(most)) ? Math.max(0.05, entry) : most, 1);
        handle.scale = Math.min(20, start.scale * factor);
      }
      editor.motionsChanged(true);
    });
    window.addEventListener("keydown", event => { if (event.key === "Shift") this.snap(true); });
    window.addEventListener("keyup", event => { if (event.key === "Shift") this.snap(false); });
  }

  private snap(on: boolean): void {
    const { gizmo } = this.editor.view;
    gizmo.setTranslationSnap(on ? 0.02 : null);
    gizmo.setRotationSnap(on ? Math.PI / 12 : null);
    gizmo.setScaleSnap(on ? 0.1 : null);
  }
}
