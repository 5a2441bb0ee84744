// What is edited besides the mesh, as undo takes it back and redo brings it again.
import type { Annotation } from "./annotation";
import type { Handle } from "./handles";

export interface Snapshot {
  handles: Handle[];
  alpha: number;
  iterations: number;
  mode: number;
  off: number[]; // ids of regions
  blend: number; // 0: the mesh as it is ... 1: the exactly symmetric one; not 0 without that one
  annotation: Annotation; // shared between snapshots where it is the same
}

export class UndoHistory {
  private done: Snapshot[] = [];
  private undone: Snapshot[] = [];

  clear(): void {
    this.done = [];
    this.undone = [];
  }

  /** \param snapshot  as it was before a change */
  remember(snapshot: Snapshot): void {
    this.done.push(snapshot);
    if (this.done.length > 200) this.done.shift();
    this.undone = [];
  }

  /** What was remembered before a change that came to nothing. */
  forget(): Snapshot { return this.done.pop()!; }

  get canUndo(): boolean { return this.done.length > 0; }
  get canRedo(): boolean { return this.undone.length > 0; }

  /** \param now  for redo \return where to go, if there is one */
  undo(now: () => Snapshot): Snapshot | undefined { return UndoHistory.swap(this.done, this.undone, now); }
  redo(now: () => Snapshot): Snapshot | undefined { return UndoHistory.swap(this.undone, this.done, now); }

  private static swap(from: Snapshot[], to: Snapshot[], now: () => Snapshot): Snapshot | undefined {
    const snapshot = from.pop();
    if (snapshot !== undefined) to.push(now());
    return snapshot;
  }
}
