// Small vectors and motions, in double precision.
export type Vec3 = [number, number, number];
export type Quaternion = [number, number, number, number]; // x, y, z, w

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (s: number, a: Vec3): Vec3 => [s * a[0], s * a[1], s * a[2]];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vec3): number => Math.sqrt(dot(a, a));
export const unit = (a: Vec3): Vec3 => {
  const size = length(a);
  return size > 0 ? times(1 / size, a) : [0, 0, 1];
};

/** Axis and angle in degrees of a rotation, the angle in [0, 180]. */
export function axisAngle([x, y, z, w]: Quaternion): { axis: Vec3; degrees: number } {
  const sine = Math.hypot(x, y, z);
  if (sine < 1e-15) return { axis: [0, 0, 1], degrees: 0 };
  const sign = w < 0 ? -1 : 1;
  return {
    axis: [sign * x / sine, sign * y / sine, sign * z / sine],
    degrees: 2 * Math.atan2(sine, Math.abs(w)) * 180 / Math.PI
  };
}

/** The rotation's matrix, 9 numbers by row. */
export function rotationMatrix(axis: Vec3, degrees: number): number[] {
  const angle = degrees * Math.PI / 180;
  const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  const [x, y, z] = axis;
  return [t * x * x + c, t * x * y - s * z, t * x * z + s * y,
          t * x * y + s * z, t * y * y + c, t * y * z - s * x,
          t * x * z - s * y, t * y * z + s * x, t * z * z + c];
}
