// Handles as the page keeps them, and what the core and handles.json make of them.
import { axisAngle, rotationMatrix, type Quaternion, type Vec3 } from "./math";

export interface Handle {
  name: string; // "pin ..." for pins
  pin: boolean;
  centre: Vec3; // at rest, mesh units
  radius: number;
  translation: Vec3;
  rotation: Quaternion;
  scale: number;
}

export const isMoved = (handle: Handle): boolean =>
  handle.translation.some(entry => entry !== 0) || Math.abs(handle.rotation[3]) !== 1 || handle.scale !== 1;

/** handles.json: `orbifit deform` does the same with it. */
export function toJson(handles: readonly Handle[], alpha: number, iterations: number): string {
  return JSON.stringify({
    alpha, iterations,
    handles: handles.map(handle => {
      const { axis, degrees } = axisAngle(handle.rotation);
      return {
        name: handle.name, centre: handle.centre, radius: handle.radius,
        ...(handle.scale !== 1 ? { scale: handle.scale } : {}),
        ...(degrees !== 0 ? { rotation: { axis, degrees } } : {}),
        ...(handle.translation.some(entry => entry !== 0) ? { translation: handle.translation } : {})
      };
    })
  }, null, 1) + "\n";
}

/** Scale and rotation are about the centroid of the handle's vertices. \param motion  3 by 4, by row */
export function writeMotion(handle: Handle, centroid: Vec3, motion: Float64Array, at: number): void {
  const rotation = rotationMatrix(handle.rotation);
  for (let row = 0; row < 3; ++row) {
    let moved = 0;
    for (let column = 0; column < 3; ++column) {
      const entry = handle.scale * rotation[3 * row + column]!;
      motion[at + 4 * row + column] = entry;
      moved += entry * centroid[column]!;
    }
    motion[at + 4 * row + 3] = centroid[row]! - moved + handle.translation[row]!;
  }
}

/** Where a motion takes a point. */
export function moved(motion: Float64Array, at: number, point: Vec3): Vec3 {
  return [0, 1, 2].map(row => motion[at + 4 * row]! * point[0] + motion[at + 4 * row + 1]! * point[1] +
    motion[at + 4 * row + 2]! * point[2] + motion[at + 4 * row + 3]!) as Vec3;
}

/** The handles of a handles.json that says centre and radius of each. \throw Error */
export function fromJson(text: string): { handles: Handle[]; alpha: number; iterations: number } {
  const file = JSON.parse(text) as {
    alpha?: number; iterations?: number;
    handles?: { name?: string; centre?: Vec3; radius?: number; translation?: Vec3; scale?: number;
                rotation?: { axis: Vec3; degrees: number; about?: Vec3 } }[];
  };
  if (!Array.isArray(file.handles)) throw new Error("there are no handles in it");
  const handles = file.handles.map((entry, number): Handle => {
    if (!entry.centre || !entry.radius) throw new Error(`handle ${number} has no centre and radius`);
    if (entry.rotation?.about) throw new Error(`handle ${number} turns about another point than its centroid`);
    const half = (entry.rotation?.degrees ?? 0) * Math.PI / 360;
    const axis = entry.rotation?.axis ?? [0, 0, 1];
    const size = Math.hypot(...axis);
    const sine = Math.sin(half) / size;
    const name = entry.name ?? `handle ${number + 1}`;
    return {
      name, pin: name.startsWith("pin"), centre: entry.centre, radius: entry.radius,
      translation: entry.translation ?? [0, 0, 0], scale: entry.scale ?? 1,
      rotation: [axis[0] * sine, axis[1] * sine, axis[2] * sine, Math.cos(half)]
    };
  });
  return { handles, alpha: file.alpha ?? 100, iterations: file.iterations ?? 10 };
}
