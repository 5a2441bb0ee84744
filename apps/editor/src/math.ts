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

const matrix = new Float64Array(9);
/** The matrix of a unit quaternion, 9 numbers by row, which the next call overwrites. */
export function rotationMatrix(q: Quaternion): Float64Array {
  const x = q[0], y = q[1], z = q[2], w = q[3];
  matrix[0] = 1 - 2 * (y * y + z * z);
  matrix[1] = 2 * (x * y - z * w);
  matrix[2] = 2 * (x * z + y * w);
  matrix[3] = 2 * (x * y + z * w);
  matrix[4] = 1 - 2 * (x * x + z * z);
  matrix[5] = 2 * (y * z - x * w);
  matrix[6] = 2 * (x * z - y * w);
  matrix[7] = 2 * (y * z + x * w);
  matrix[8] = 1 - 2 * (x * x + y * y);
  return matrix;
}
