// How a mesh is drawn: lit from the camera's side, coloured by the marks of its vertices (orbit, region, handle, pin).
export const vertexShader = `
attribute vec4 marks;
varying vec3 vNormal;
varying vec3 vView;
varying vec4 vMarks;
void main() {
  vNormal = normalMatrix * normal;
  vMarks = marks;
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vView = -view.xyz;
  gl_Position = projectionMatrix * view;
}`;
export const fragmentShader = `
uniform vec3 base, orbitColour, regionColour, handleColour, pinColour;
uniform float regionShare;
varying vec3 vNormal;
varying vec3 vView;
varying vec4 vMarks;
void main() {
  vec3 view = normalize(vView);
  vec3 normal = dot(vNormal, vNormal) > 0.0 ? normalize(vNormal) : view;
  bool back = dot(normal, view) < 0.0;
  if (back) normal = -normal;
  vec3 colour = base;
  colour = mix(colour, regionColour, regionShare * smoothstep(0.4, 0.6, vMarks.y) * 0.75);
  colour = mix(colour, pinColour, smoothstep(0.4, 0.6, vMarks.w) * 0.8);
  colour = mix(colour, handleColour, smoothstep(0.4, 0.6, vMarks.z) * 0.55);
  colour = mix(colour, orbitColour, smoothstep(0.4, 0.6, vMarks.x) * 0.85);
  float key = max(dot(normal, normalize(vec3(0.45, 0.7, 0.75))), 0.0);
  float fill = max(dot(normal, normalize(vec3(-0.8, 0.1, 0.4))), 0.0);
  float sky = 0.5 + 0.5 * normal.y;
  float rim = pow(1.0 - max(dot(normal, view), 0.0), 3.0);
  float shine = pow(max(dot(reflect(-normalize(vec3(0.45, 0.7, 0.75)), normal), view), 0.0), 28.0);
  vec3 light = colour * (0.30 + 0.62 * key + 0.18 * fill + 0.16 * sky) + vec3(0.10 * shine + 0.06 * rim);
  if (back) light *= 0.8;
  gl_FragColor = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);
}`;
