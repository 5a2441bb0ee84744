// Things drawn beside the mesh: planes, axes and centres of groups, dots for handles.
import * as THREE from "three";

import type { Element, Extent } from "./annotation";

/** \param opacity  of a plane's sheet */
export function addElement(group: THREE.Group, element: Element, extent: Extent, colour: THREE.Color, opacity: number): void {
  const normal = new THREE.Vector3(...element.direction);
  const centre = new THREE.Vector3(...extent.centre);
  const point = new THREE.Vector3(...element.point);
  const radius = 1.12 * extent.radius;
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
  if (element.kind === "plane") {
    centre.addScaledVector(normal, normal.dot(point) - normal.dot(centre));
    const disc = new THREE.CircleGeometry(radius, 64);
    const sheet = new THREE.Mesh(disc, new THREE.MeshBasicMaterial(
      { color: colour, transparent: true, opacity, side: THREE.DoubleSide, depthWrite: false }));
    const rim = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(
      Array.from({ length: 96 }, (_, i) => new THREE.Vector3(radius * Math.cos(i * Math.PI / 48),
                                                             radius * Math.sin(i * Math.PI / 48), 0))),
                                   new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.8 }));
    for (const object of [sheet, rim]) {
      object.quaternion.copy(turn);
      object.position.copy(centre);
      group.add(object);
    }
  } else if (element.kind === "axis") {
    const middle = point.clone().addScaledVector(normal, normal.dot(centre) - normal.dot(point));
    const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.006 * radius, 0.006 * radius, 2.3 * radius, 10),
                               new THREE.MeshBasicMaterial({ color: colour }));
    rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), normal);
    rod.position.copy(middle);
    group.add(rod);
  } else {
    const dot = new THREE.Mesh(new THREE.SphereGeometry(0.03 * radius, 16, 12),
                               new THREE.MeshBasicMaterial({ color: colour }));
    dot.position.copy(point);
    group.add(dot);
  }
}

let texture: THREE.Texture | undefined;
/** A disc with a ring. */
export function dotTexture(): THREE.Texture {
  if (texture) return texture;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d")!;
  context.beginPath();
  context.arc(32, 32, 28, 0, 2 * Math.PI);
  context.fillStyle = "#ffffff";
  context.fill();
  context.lineWidth = 5;
  context.strokeStyle = "rgba(0,0,0,0.55)";
  context.stroke();
  texture = new THREE.CanvasTexture(canvas);
  return texture;
}
