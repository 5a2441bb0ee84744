// What is drawn: one mesh, or two side by side, handles, planes and axes, the orbit under the cursor, a scan. Drawn when
// something changed.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";

import type { Core } from "./core";
import { Side } from "./core";
import type { Element, Extent } from "./annotation";
import type { Vec3 } from "./math";
import { fragmentShader, vertexShader } from "./shader";
import { addElement, dotTexture } from "./shapes";

export interface Theme { back: string; mesh: string; orbit: string; region: string; handle: string; pin: string; scan: string }

/** A colour in the shader's linear space. */
const linear = (colour: string): THREE.Color => new THREE.Color(colour);

export class View {
  readonly renderer: THREE.WebGLRenderer;
  readonly camera = new THREE.PerspectiveCamera(35, 1, 0.001, 100);
  readonly controls: OrbitControls;
  readonly gizmo: TransformControls;
  readonly gizmoTarget = new THREE.Object3D();
  private readonly scene = new THREE.Scene();
  private readonly freeScene = new THREE.Scene(); // the other half of a comparison
  private readonly overlay = new THREE.Group();
  private readonly sides: (THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null)[] = [null, null];
  private readonly material: THREE.ShaderMaterial;
  private readonly orbitDots: THREE.InstancedMesh;
  private readonly mostDots = 600;
  private readonly handleDots = new THREE.Group();
  private scan: THREE.Points | null = null;
  private elementsShown = "";
  private theme: Theme;
  private split = false;
  private pending = false;
  private core: Core | null = null;
  private readonly staleShape = [false, false]; // by side: what the card has of the core's memory
  private readonly staleMarks = [false, false];
  private readonly pinColour = new THREE.Color();
  private readonly handleColour = new THREE.Color();
  private readonly back = new THREE.Color();
  private readonly size = new THREE.Vector2();
  onFrame: () => void = () => {};
  beforeFrame: () => void = () => {};

  constructor(private readonly canvas: HTMLCanvasElement, theme: Theme) {
    this.theme = theme;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // the shader has its own curve
    this.renderer.autoClear = false;
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(1.1, -1.5, 0.9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.mouseButtons = { LEFT: THREE.MOUSE.ROTATE, MIDDLE: THREE.MOUSE.PAN, RIGHT: THREE.MOUSE.PAN };
    this.controls.addEventListener("change", () => this.draw());
    this.gizmo = new TransformControls(this.camera, canvas);
    this.gizmo.setSize(0.75);
    this.gizmo.addEventListener("change", () => this.draw());
    this.material = new THREE.ShaderMaterial({
      vertexShader, fragmentShader, side: THREE.DoubleSide,
      uniforms: {
        base: { value: null }, orbitColour: { value: null }, regionColour: { value: null },
        handleColour: { value: null }, pinColour: { value: null }, regionShare: { value: 1 }
      }
    });
    this.orbitDots = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 12, 8), new THREE.MeshBasicMaterial(),
                                             this.mostDots);
    this.orbitDots.count = 0;
    this.orbitDots.frustumCulled = false;
    this.scene.add(this.overlay, this.orbitDots, this.handleDots, this.gizmoTarget, this.gizmo.getHelper());
    this.setTheme(theme);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const uniforms = this.material.uniforms;
    uniforms.base!.value = linear(theme.mesh);
    uniforms.orbitColour!.value = linear(theme.orbit);
    uniforms.regionColour!.value = linear(theme.region);
    uniforms.handleColour!.value = linear(theme.handle);
    uniforms.pinColour!.value = linear(theme.pin);
    (this.orbitDots.material as THREE.MeshBasicMaterial).color.setStyle(theme.orbit, THREE.LinearSRGBColorSpace);
    this.pinColour.setStyle(theme.pin, THREE.LinearSRGBColorSpace);
    this.handleColour.setStyle(theme.handle, THREE.LinearSRGBColorSpace);
    this.back.setStyle(theme.back, THREE.LinearSRGBColorSpace);
    if (this.scan) (this.scan.material as THREE.PointsMaterial).color.setStyle(theme.scan, THREE.LinearSRGBColorSpace);
    this.elementsShown = "";
    this.draw();
  }

  /** A new mesh in both halves. */
  setMesh(core: Core): void {
    this.core = core;
    for (const side of [Side.symmetric, Side.free]) {
      this.sides[side]?.geometry.dispose();
      this.sides[side]?.removeFromParent();
      const geometry = new THREE.BufferGeometry();
      const count = core.displayVertices();
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(core.triangles()), 1));
      for (const name of ["position", "normal"]) {
        const attribute = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
        attribute.setUsage(THREE.DynamicDrawUsage);
        geometry.setAttribute(name, attribute);
      }
      const marks = new THREE.BufferAttribute(new Uint8Array(4 * count), 4, true);
      geometry.setAttribute("marks", marks);
      geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 10);
      const mesh = new THREE.Mesh(geometry, this.material);
      mesh.frustumCulled = false;
      this.sides[side] = mesh;
      (side === Side.symmetric ? this.scene : this.freeScene).add(mesh);
    }
    this.positionsChanged(Side.symmetric);
    this.positionsChanged(Side.free);
    this.marksChanged();
  }

  positionsChanged(side: Side): void {
    this.staleShape[side] = true;
    this.draw();
  }

  marksChanged(): void {
    this.staleMarks.fill(true);
    this.draw();
  }

  /** Hands a side's arrays to the card, from the core's memory, without a copy between: just before they are drawn, since
      that memory is another when it has grown. */
  private upload(side: Side): void {
    const { core } = this;
    const geometry = this.sides[side]?.geometry;
    if (!core || !geometry) return;
    if (this.staleShape[side]) {
      View.hand(geometry.attributes.position as THREE.BufferAttribute, core.positions(side));
      View.hand(geometry.attributes.normal as THREE.BufferAttribute, core.normals(side));
      this.staleShape[side] = false;
    }
    if (this.staleMarks[side]) {
      View.hand(geometry.attributes.marks as THREE.BufferAttribute, core.marks());
      this.staleMarks[side] = false;
    }
  }
  private static hand(attribute: THREE.BufferAttribute, array: THREE.TypedArray): void {
    attribute.array = array;
    attribute.needsUpdate = true;
  }

  showOrbit(points: Float32Array | null): void {
    const count = points ? Math.min(this.mostDots, points.length / 3) : 0;
    const { matrix, point } = this.scratch;
    for (let i = 0; i < count; ++i) {
      const [x, y, z] = [points![3 * i]!, points![3 * i + 1]!, points![3 * i + 2]!];
      const size = 0.0035 * this.camera.position.distanceTo(point.set(x, y, z)) * (i === 0 ? 1.5 : 1);
      matrix.makeScale(size, size, size).setPosition(x, y, z);
      this.orbitDots.setMatrixAt(i, matrix);
    }
    this.orbitDots.count = count;
    this.orbitDots.instanceMatrix.needsUpdate = true;
    this.draw();
  }

  /** Planes and axes, each with the motion that carries it. \param frame  to the display's: (x - centre) / diagonal */
  showElements(key: string, list: () => { elements: Element[]; extent: Extent; carried: Float64Array }[],
               frame: { centre: Vec3; diagonal: number }): void {
    if (key === this.elementsShown) return;
    this.elementsShown = key;
    for (const child of [...this.overlay.children]) {
      child.removeFromParent();
      child.traverse(object => (object as THREE.Mesh).geometry?.dispose());
    }
    const toDisplay = new THREE.Matrix4().makeScale(1 / frame.diagonal, 1 / frame.diagonal, 1 / frame.diagonal)
      .multiply(new THREE.Matrix4().makeTranslation(-frame.centre[0], -frame.centre[1], -frame.centre[2]));
    const shown = key ? list() : [];
    const colour = new THREE.Color().setStyle(this.theme.region, THREE.LinearSRGBColorSpace);
    const regions = shown.length; // the more sheets lie over one another, the fainter each is
    for (const { elements, extent, carried } of shown) {
      const group = new THREE.Group();
      group.matrixAutoUpdate = false;
      const m = carried;
      group.matrix.set(m[0]!, m[1]!, m[2]!, m[3]!, m[4]!, m[5]!, m[6]!, m[7]!, m[8]!, m[9]!, m[10]!, m[11]!, 0, 0, 0, 1)
        .premultiply(toDisplay);
      const planes = elements.filter(element => element.kind === "plane").length;
      const opacity = Math.min(0.1, 0.2 / (planes * regions));
      for (const element of elements) addElement(group, element, extent, colour, opacity);
      this.overlay.add(group);
    }
    this.draw();
  }

  private readonly dots: THREE.Sprite[] = [];
  /** How many handles there are; showHandle() says where. */
  showHandles(count: number): void {
    while (this.dots.length < count) {
      const sprite = new THREE.Sprite(new THREE.SpriteMaterial({
        map: dotTexture(), sizeAttenuation: false, depthTest: false, transparent: true
      }));
      sprite.renderOrder = 10;
      this.dots.push(sprite);
      this.handleDots.add(sprite);
    }
    this.dots.forEach((dot, number) => { dot.visible = number < count; });
    this.draw();
  }
  /** \param point  in the display's frame */
  showHandle(number: number, point: Vec3, pin: boolean, selected: boolean): void {
    const dot = this.dots[number]!;
    const size = (selected ? 0.030 : 0.022) / this.camera.zoom; // the same on the screen, whatever is in sight
    dot.scale.set(size, size, 1);
    dot.position.set(point[0], point[1], point[2]);
    dot.material.color.copy(pin ? this.pinColour : this.handleColour);
  }

  showScan(points: Float32Array | null): void {
    this.scan?.geometry.dispose();
    this.scan?.removeFromParent();
    this.scan = null;
    if (points) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
      this.scan = new THREE.Points(geometry, new THREE.PointsMaterial({
        size: 2.2, sizeAttenuation: false, color: new THREE.Color().setStyle(this.theme.scan, THREE.LinearSRGBColorSpace)
      }));
      this.scan.frustumCulled = false;
      this.scene.add(this.scan);
    }
    this.draw();
  }

  /** Looks at what lies within a sphere, in the display's frame. */
  frame(centre: Vec3 = [0, 0, 0], radius = 0.52): void {
    const half = Math.tan(this.camera.fov * Math.PI / 360); // of the shorter side
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.controls.target.set(...centre);
    this.camera.position.copy(this.controls.target).addScaledVector(direction, radius / half * 1.1 + radius * 0.3);
    this.controls.update();
    this.draw();
  }

  setSplit(on: boolean): void {
    this.split = on;
    this.resize();
  }

  resize(): void {
    const parent = this.canvas.parentElement!;
    const width = Math.max(1, parent.clientWidth), height = Math.max(1, parent.clientHeight);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = (this.split ? width / 2 : width) / height;
    this.camera.zoom = Math.min(1, this.camera.aspect); // what was framed stays in sight, in half the width too
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Pixel to device coordinates of the half that it lies in. */
  device(x: number, y: number): THREE.Vector2 {
    const box = this.canvas.getBoundingClientRect();
    const width = this.split ? box.width / 2 : box.width;
    const left = x - box.left;
    return this.scratch.device.set((left % width) / width * 2 - 1, 1 - (y - box.top) / box.height * 2);
  }

  private readonly scratch = { plane: new THREE.Plane(), normal: new THREE.Vector3(), point: new THREE.Vector3(),
                               device: new THREE.Vector2(), matrix: new THREE.Matrix4() };
  private readonly caster = new THREE.Raycaster();
  private readonly rayNumbers = new Float64Array(6);
  /** Origin and unit direction in the display's frame. */
  ray(x: number, y: number): Float64Array {
    this.caster.setFromCamera(this.device(x, y), this.camera);
    const { origin, direction } = this.caster.ray;
    this.rayNumbers.set([origin.x, origin.y, origin.z, direction.x, direction.y, direction.z]);
    return this.rayNumbers;
  }

  /** Where a point is on the screen, in pixels; of the left half where there are two. */
  screen(point: Vec3): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    const width = this.split ? box.width / 2 : box.width;
    const seen = this.scratch.point.set(point[0], point[1], point[2]).project(this.camera);
    return [box.left + (seen.x + 1) / 2 * width, box.top + (1 - seen.y) / 2 * box.height];
  }

  /** The point on the plane through `through`, parallel to the screen, that is seen at a pixel. */
  onViewPlane(x: number, y: number, through: Vec3): Vec3 {
    const { plane, normal, point } = this.scratch;
    point.set(through[0], through[1], through[2]);
    plane.setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(normal), point);
    this.caster.setFromCamera(this.device(x, y), this.camera);
    this.caster.ray.intersectPlane(plane, point);
    return [point.x, point.y, point.z];
  }

  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(this.drawNow);
  }
  private readonly drawNow = (): void => {
    this.pending = false;
    this.beforeFrame();
    this.render();
    this.onFrame();
  };

  render(): void {
    const { renderer } = this;
    const size = renderer.getSize(this.size);
    this.upload(Side.symmetric);
    if (this.split) this.upload(Side.free);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, size.x, size.y);
    renderer.setClearColor(this.back);
    renderer.clear();
    if (!this.split) {
      renderer.render(this.scene, this.camera);
      return;
    }
    renderer.setScissorTest(true);
    renderer.setViewport(0, 0, size.x / 2, size.y);
    renderer.setScissor(0, 0, size.x / 2, size.y);
    renderer.render(this.scene, this.camera);
    renderer.setViewport(size.x / 2, 0, size.x / 2, size.y);
    renderer.setScissor(size.x / 2, 0, size.x / 2, size.y);
    renderer.clearDepth();
    renderer.render(this.freeScene, this.camera);
    renderer.setScissorTest(false);
  }
}
