// The canvas: one camera for all results that stand side by side, drawn only when something changed.

import { BasicShadowMap, PerspectiveCamera, Plane, Ray, Raycaster, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Axis } from "../data/source";
import type { Box } from "./mesh-math";
import type { Hit, Vector } from "./pick";
import { middle, radiusOf, type Stage } from "./stage";
import { fromDirection, type Preset, upVector } from "./views";

/** Vertical field of view [degrees], as in pictures: a long lens. */
const FIELD_OF_VIEW = 26;
/** Where pictures come slower than this while things move [ms], they are made simpler until things stand still. */
const SLOW = 40;
/** Steps to simpler pictures: the first leaves shadows out, each other draws fewer pixels, a third of each side at last. */
const MOST_SIMPLE = 6;
const COARSER = 1.25;
const FRAMES_A_STEP = 12;

export class Viewport {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  readonly section = new Plane(new Vector3(0, 0, -1), 0);
  readonly planes: Plane[] = [];
  private readonly renderer: WebGLRenderer;
  /** Pixels along the sides of what the lamp sees. */
  readonly shadowSize: number;
  private readonly controls: OrbitControls;
  private stages: Stage[] = [];
  private box: Box = { min: [-1, -1, -1], max: [1, 1, 1] };
  private isDirty = true;
  /** Steps taken to simpler pictures. */
  private simplicity = 0;
  private movedAt = 0;
  /** Since when so many frames were drawn, how long each took at the step before [ms], and whether steps still help. */
  private pace = { since: 0, frames: 0, before: Infinity, isSettled: false };
  private size = { width: 0, height: 0, ratio: 0 };
  /** Called after each picture. */
  onDrawn: () => void = () => {};
  /** Pictures drawn so far. */
  drawn = 0;
  /** Whether things move by themselves. */
  isPlaying = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    const isSoftware = rendersInSoftware();
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware });
    this.shadowSize = isSoftware ? 512 : 1024;
    this.renderer.localClippingEnabled = true;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = BasicShadowMap;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => {
      this.movedAt = performance.now();
      this.redraw();
    });
    new ResizeObserver(() => this.redraw()).observe(canvas);
    const loop = () => {
      requestAnimationFrame(loop);
      this.step();
    };
    requestAnimationFrame(loop);
  }

  setStages(stages: Stage[]): void {
    this.stages = stages;
    stages.forEach((stage) => stage.setShadowSize(this.shadowSize));
    this.redraw();
  }

  redraw(): void {
    this.isDirty = true;
  }

  /** Frames what is shown from a side. */
  look(preset: Preset, up: Axis, box: Box): void {
    this.box = box;
    this.camera.up.set(...upVector(up));
    const target = new Vector3(...middle(box));
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * Math.min(1, this.aspect());
    const distance = (1.08 * Math.max(radiusOf(box), 1e-9)) / Math.sin(Math.atan(half));
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(new Vector3(...fromDirection(preset, up)).normalize(), distance);
    this.controls.minDistance = distance / 200;
    this.controls.maxDistance = distance * 20;
    this.controls.update();
    this.redraw();
  }

  /** What lamps, shadows and the marker are sized by. */
  setBox(box: Box): void {
    this.box = box;
    this.redraw();
  }

  get radius(): number {
    return radiusOf(this.box);
  }

  /** Cuts off what lies beyond a share of the box along an axis. */
  cut(axis: Axis | null, share: number, flipped: boolean): void {
    this.planes.length = 0;
    if (axis !== null) {
      const k = { x: 0, y: 1, z: 2 }[axis];
      const at = this.box.min[k] + share * (this.box.max[k] - this.box.min[k]);
      const normal = new Vector3().setComponent(k, flipped ? 1 : -1);
      this.section.set(normal, flipped ? -at : at);
      this.planes.push(this.section);
    }
    this.redraw();
  }

  /** What lies under a point of the page, and in which result. */
  pick(x: number, y: number): { stage: number; hit: Hit } | null {
    const { ray, stage } = this.sight(x, y);
    const hit = this.stages[stage]?.pick(ray.origin.toArray(), ray.direction.toArray());
    return hit ? { stage, hit } : null;
  }

  /** The line of sight through a point of the page, and the result that it meets. */
  private sight(x: number, y: number): { ray: Ray; stage: number } {
    const rect = this.canvas.getBoundingClientRect();
    const count = Math.max(1, this.stages.length);
    const share = ((x - rect.left) / rect.width) * count;
    const stage = Math.min(count - 1, Math.max(0, Math.floor(share)));
    const point = new Vector2(2 * (share - stage) - 1, 1 - (2 * (y - rect.top)) / rect.height);
    const caster = new Raycaster();
    caster.setFromCamera(point, this.camera);
    return { ray: caster.ray, stage };
  }

  /** Whether dragging turns the camera. */
  setTurning(turns: boolean): void {
    this.controls.enabled = turns;
  }

  /** The point of the plane through `through` across the line of sight that lies under a point of the page. */
  under(x: number, y: number, through: Vector): [number, number, number] | null {
    const { ray } = this.sight(x, y);
    const normal = this.camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, new Vector3(...through));
    return ray.intersectPlane(plane, new Vector3())?.toArray() ?? null;
  }

  /** Draws at once, with all pixels: for pictures. */
  drawFully(): void {
    this.simplicity = 0;
    this.draw();
    this.isDirty = false;
  }

  private aspect(): number {
    const count = Math.max(1, this.stages.length);
    return Math.max(1, this.canvas.clientWidth) / count / Math.max(1, this.canvas.clientHeight);
  }

  private step(): void {
    const now = performance.now();
    const isMoving = this.isPlaying || now - this.movedAt < 250;
    if (!isMoving && this.simplicity > 0) {
      this.simplicity = 0;
      this.isDirty = true;
    }
    this.adapt(isMoving, now);
    if (this.isDirty) {
      this.isDirty = false;
      this.draw();
    }
  }

  /**
   * Browsers ask for the next frame when the last is drawn: this tells how long drawing takes. A step that does not help is
   * taken back, and no other is tried until things have stood still: then something else takes the time.
   */
  private adapt(isMoving: boolean, now: number): void {
    if (!isMoving) {
      this.pace = { since: now, frames: 0, before: Infinity, isSettled: false };
      return;
    }
    const { pace } = this;
    pace.frames += 1;
    if (pace.frames < FRAMES_A_STEP || pace.isSettled) {
      return;
    }
    const interval = (now - pace.since) / pace.frames;
    const hasHelped = interval < 0.9 * pace.before;
    if (!hasHelped) {
      this.simplicity -= 1;
      pace.isSettled = true;
    } else if (interval > SLOW && this.simplicity < MOST_SIMPLE) {
      this.simplicity += 1;
      pace.before = interval;
    }
    pace.since = now;
    pace.frames = 0;
  }

  private draw(): void {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    const ratio = Math.min(2, window.devicePixelRatio) / COARSER ** Math.max(0, this.simplicity - 1);
    const { size } = this;
    // Setting a size, even the same, makes a new canvas.
    if (size.width !== width || size.height !== height || size.ratio !== ratio) {
      this.size = { width, height, ratio };
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.aspect = this.aspect();
    this.camera.near = Math.max(distance - 8 * this.radius, distance / 200);
    this.camera.far = distance + 40 * this.radius;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const count = Math.max(1, this.stages.length);
    this.renderer.setScissorTest(count > 1);
    this.stages.forEach((stage, k) => {
      const left = Math.floor((k * width) / count);
      const right = Math.floor(((k + 1) * width) / count);
      this.renderer.setViewport(left, 0, right - left, height);
      this.renderer.setScissor(left, 0, right - left, height);
      stage.allowShadows(this.simplicity === 0);
      stage.light(this.camera, this.box);
      this.renderer.render(stage.scene, this.camera);
    });
    this.drawn += 1;
    this.onDrawn();
  }
}

/** Whether there is no graphics processor: smoothing of edges would take most of the time. */
function rendersInSoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  if (context === null) {
    throw new Error("this browser has no WebGL 2, by which the viewer draws");
  }
  const info = context.getExtension("WEBGL_debug_renderer_info");
  const name = String(context.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
