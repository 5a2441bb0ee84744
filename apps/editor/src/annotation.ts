// The annotation as the page edits it, and the planes and axes of its groups.
import { add, dot, length, sub, times, unit, type Vec3 } from "./math";

export interface Region {
  id: number;
  name: string;
  group: string;
  centre: Vec3;
  axis?: Vec3;
  elements: number[][][]; // 3 by 4 motions
  faces: [number, number][]; // runs
  parent: number | null;
  residual: { rms: number; max: number };
  importance?: number;
  [key: string]: unknown;
}
export interface Annotation {
  format: string;
  version: number;
  tolerance: number;
  regions: Region[];
  patterns: { id: number; name: string; kind: string; instances: unknown[]; [key: string]: unknown }[];
  [key: string]: unknown;
}

const isAnnotation = (value: unknown): value is Annotation =>
  typeof value === "object" && value !== null && (value as Annotation).format === "symmetry-annotation";

export function annotationFrom(text: string): Annotation {
  const value: unknown = JSON.parse(text);
  if (!isAnnotation(value)) throw new Error("no symmetry annotation");
  return value;
}

export const emptyAnnotation = (vertices: number, faces: number, diagonal: number): Annotation => ({
  format: "symmetry-annotation", version: 1, mesh: { vertices, faces, diagonal }, tolerance: 0.005, regions: [],
  patterns: []
});

export const faceCount = (region: Region): number => region.faces.reduce((sum, run) => sum + run[1], 0);

/** The annotation without some regions; children of one that is gone go to its parent. */
export function without(annotation: Annotation, ids: ReadonlySet<number>): Annotation {
  const parents = new Map(annotation.regions.map(region => [region.id, region.parent]));
  const kept = (id: number | null): number | null => {
    let parent = id;
    while (parent !== null && ids.has(parent)) parent = parents.get(parent) ?? null;
    return parent;
  };
  return {
    ...annotation,
    regions: annotation.regions.filter(region => !ids.has(region.id))
      .map(region => ({ ...region, parent: kept(region.parent) }))
  };
}

export interface Element {
  kind: "plane" | "axis" | "centre";
  point: Vec3; // mesh units, at rest
  direction: Vec3; // the plane's normal, or along the axis
  order: number; // of the axis; 0: any angle
}

const matrixOf = (motion: number[][]): number[] =>
  [0, 1, 2].flatMap(row => [motion[row]![0]!, motion[row]![1]!, motion[row]![2]!]);

function determinant(m: number[]): number {
  return m[0]! * (m[4]! * m[8]! - m[5]! * m[7]!) - m[1]! * (m[3]! * m[8]! - m[5]! * m[6]!) +
    m[2]! * (m[3]! * m[7]! - m[4]! * m[6]!);
}

/** Axis of a rotation by `angle`, from its matrix: of R + R^T - (trace - 1) 1, the largest column. */
function axisOf(m: number[]): Vec3 {
  const trace = m[0]! + m[4]! + m[8]!;
  const columns: Vec3[] = [0, 1, 2].map(k => [0, 1, 2].map(row =>
    m[3 * row + k]! + m[3 * k + row]! - (row === k ? trace - 1 : 0)) as Vec3);
  return unit(columns.reduce((best, column) => length(column) > length(best) ? column : best));
}

const most = 6; // planes, and axes beside the main one, that are drawn

/** All where they are few; of many some, evenly: what a wheel of 36 mirrors has to say its axis says. */
function spread(elements: Element[]): Element[] {
  if (elements.length <= most) return elements;
  return Array.from({ length: most }, (_, i) => elements[Math.floor(i * elements.length / most)]!);
}

/** Mirror planes and rotation axes of a region's group, the main axis first; of a large group some. */
export function elementsOf(region: Region): Element[] {
  const point = region.centre;
  const found: Element[] = [];
  const note = (kind: "plane" | "axis", direction: Vec3, order: number): void => {
    const known = found.find(other => other.kind === kind && Math.abs(dot(other.direction, direction)) > 0.9999);
    if (!known) found.push({ kind, point, direction, order });
    else if (kind === "axis" && order > known.order) known.order = order;
  };
  for (const motion of region.elements) {
    const m = matrixOf(motion);
    const proper = determinant(m) > 0;
    const sign = proper ? 1 : -1;
    const trace = sign * (m[0]! + m[4]! + m[8]!); // of the rotation in it
    const angle = Math.acos(Math.min(1, Math.max(-1, (trace - 1) / 2)));
    if (angle < 1e-6) continue; // the identity or the inversion
    const axis = axisOf(m.map(entry => sign * entry));
    if (proper) note("axis", axis, Math.round(2 * Math.PI / angle));
    else if (Math.abs(angle - Math.PI) < 1e-6) note("plane", axis, 0);
  }
  if (region.elements.length === 0 && region.axis) {
    found.push({ kind: "axis", point, direction: unit(region.axis), order: 0 });
    if (/h$/.test(region.group)) found.push({ kind: "plane", point, direction: unit(region.axis), order: 0 });
  }
  if (found.length === 0) found.push({ kind: "centre", point, direction: [0, 0, 1], order: 0 });
  const main = found.filter(element => element.kind === "axis").sort((a, b) => b.order - a.order)[0];
  const rest = found.filter(element => element !== main);
  const across = main === undefined ? [] : rest.filter(element =>
    element.kind === "plane" && Math.abs(dot(element.direction, main.direction)) > 0.9999);
  return [...(main ? [main] : []), ...across,
          ...spread(rest.filter(element => element.kind === "plane" && !across.includes(element))),
          ...spread(rest.filter(element => element.kind === "axis")), ...rest.filter(element => element.kind === "centre")];
}

export interface Extent { centre: Vec3; radius: number }

/** A sphere about the centre of a region's bounding box that holds it. \param corner  of a face: its vertices */
export function extentOf(region: Region, corners: (face: number) => Vec3[]): Extent {
  const low: Vec3 = [Infinity, Infinity, Infinity], high: Vec3 = [-Infinity, -Infinity, -Infinity];
  const count = faceCount(region);
  const step = Math.max(1, Math.floor(count / 4000));
  let number = 0;
  for (const [first, length] of region.faces) {
    for (let face = first; face < first + length; ++face) {
      if (number++ % step !== 0) continue;
      for (const corner of corners(face)) {
        for (let k = 0; k < 3; ++k) {
          low[k] = Math.min(low[k]!, corner[k]!);
          high[k] = Math.max(high[k]!, corner[k]!);
        }
      }
    }
  }
  return { centre: times(0.5, add(low, high)), radius: length(sub(high, low)) / 2 };
}

/** "C4v" as people write it. */
export function groupMarkup(group: string): string {
  const [, letter, rest] = /^([A-Z])(.*)$/.exec(group) ?? ["", group, ""];
  return rest ? `${letter}<sub>${rest!.replace("inf", "∞")}</sub>` : letter!;
}
