// One result as a three.js scene: its parts, a lamp that follows the camera, the picked point.

import {
  type Camera,
  Color,
  DirectionalLight,
  Mesh,
  MeshBasicMaterial,
  type Plane,
  Scene,
  SphereGeometry,
  Vector3,
} from "three";
import type { Axis, FrameData, Info, Part } from "../data/source";
import { OBSTACLE, SHELLS } from "./color-map";
import { type Box, emptyBox, faceToVertex, include } from "./mesh-math";
import { PartView, type Shading } from "./part-view";
import { pick, type Hit, type Vector } from "./pick";
import { Lighting, type ValueColors } from "./shading";
import { upVector } from "./views";

const AXES = { x: 0, y: 1, z: 2 } as const;

export class Stage {
  readonly scene = new Scene();
  readonly parts: PartView[];
  private readonly lamp = new DirectionalLight();
  private readonly lighting = new Lighting();
  private readonly marker: Mesh;
  private marked: number | null = null;
  private shading: Shading = "smooth";
  private hasShadows = false;
  /** The frame that is shown. */
  current: FrameData | null = null;

  constructor(
    readonly info: Info,
    readonly faces: Uint32Array,
    colors: ValueColors,
    private readonly planes: Plane[],
  ) {
    let shells = 0;
    this.parts = info.parts.map((part) => {
      const color = part.kind === "obstacle" ? OBSTACLE : SHELLS[shells++ % SHELLS.length];
      return new PartView(part, faces, color, colors, this.lighting, planes);
    });
    for (const part of this.parts) {
      this.scene.add(part.group);
    }
    this.lighting.up.set(...upVector(info.up_axis));
    this.lamp.shadow.bias = -0.002;
    const material = new MeshBasicMaterial({ color: 0xd81b60, depthTest: false, transparent: true });
    this.marker = new Mesh(new SphereGeometry(1, 16, 12), material);
    this.marker.renderOrder = 1;
    this.marker.visible = false;
    this.scene.add(this.lamp, this.lamp.target, this.marker);
  }

  /** Colours of what is behind the shells. */
  setBackground(color: string, obstacles: string): void {
    this.scene.background = new Color(color);
    for (const part of this.parts) {
      if (part.part.kind === "obstacle") {
        part.setColor(obstacles);
      }
    }
  }

  /** Shows a frame in the colours of `values`, or of the parts. */
  show(frame: FrameData, values: Float32Array | null, of: "vertices" | "faces"): void {
    if (frame !== this.current) {
      this.current = frame;
      for (const part of this.parts) {
        part.move(frame.positions);
      }
    }
    this.paint(values, of);
    this.placeMarker();
  }

  paint(values: Float32Array | null, of: "vertices" | "faces"): void {
    const averaged = values !== null && of === "faces" && this.shading === "smooth";
    const shown = averaged ? faceToVertex(values, this.faces, this.info.vertices) : values;
    for (const part of this.parts) {
      part.paint(shown, averaged ? "vertices" : of);
    }
  }

  setShading(shading: Shading): void {
    this.shading = shading;
    for (const part of this.parts) {
      part.setShading(shading);
    }
  }

  setShadows(shown: boolean): void {
    this.hasShadows = shown;
    this.lamp.castShadow = shown;
    for (const part of this.parts) {
      part.setShadows(shown);
    }
  }

  /** Leaves shadows out for a while. */
  allowShadows(allowed: boolean): void {
    this.lamp.castShadow = this.hasShadows && allowed;
  }

  setShadowSize(size: number): void {
    this.lamp.shadow.mapSize.set(size, size);
  }

  /** Puts the lamp above and to the left of the camera, so that shadows show what hides what. */
  light(camera: Camera, box: Box): void {
    const center = new Vector3(...middle(box));
    const radius = Math.max(radiusOf(box), 1e-9);
    const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    const back = new Vector3().setFromMatrixColumn(camera.matrixWorld, 2);
    const vertical = new Vector3(...upVector(this.info.up_axis));
    const from = back.addScaledVector(right, -0.5).addScaledVector(up, 0.5).addScaledVector(vertical, 0.9);
    this.lamp.target.position.copy(center);
    this.lighting.lamp.copy(from.normalize());
    this.lamp.position.copy(center).addScaledVector(from, 3 * radius);
    const lens = this.lamp.shadow.camera;
    lens.left = lens.bottom = -1.3 * radius;
    lens.right = lens.top = 1.3 * radius;
    lens.near = 0.5 * radius;
    lens.far = 6 * radius;
    // Some texels of the shadow map, so that surfaces do not shade themselves.
    this.lamp.shadow.normalBias = 0.012 * radius;
    lens.updateProjectionMatrix();
  }

  /** What the camera frames: all visible parts but floors. */
  bounds(frame: FrameData): Box {
    const box = emptyBox();
    for (const { part, group } of this.parts) {
      if (group.visible && !this.isFloor(part, frame.positions)) {
        include(box, frame.positions, part.vertices.start, part.vertices.end);
      }
    }
    return Number.isFinite(box.min[0]) ? box : { min: [-1, -1, -1], max: [1, 1, 1] };
  }

  /** A level rectangle: this is how an obstacle plane is shown. */
  private isFloor(part: Part, positions: Float32Array): boolean {
    if (part.kind !== "obstacle" || part.faces.end - part.faces.start !== 2) {
      return false;
    }
    const { start, end } = part.vertices;
    const axis = AXES[this.info.up_axis as Axis];
    for (let v = start + 1; v < end; v++) {
      if (Math.abs(positions[3 * v + axis] - positions[3 * start + axis]) > 1e-6) {
        return false;
      }
    }
    return true;
  }

  /** What a ray meets first among what is visible and not cut away. */
  pick(origin: Vector, direction: Vector): Hit | null {
    if (this.current === null) {
      return null;
    }
    const isKept = (point: Vector) =>
      this.planes.every((plane) => plane.distanceToPoint(new Vector3(...point)) >= 0);
    let best: Hit | null = null;
    for (const { part, group } of this.parts) {
      if (!group.visible) {
        continue;
      }
      const { start, end } = part.faces;
      const hit = pick(origin, direction, this.current.positions, this.faces, start, end, isKept);
      if (hit !== null && (best === null || hit.distance < best.distance)) {
        best = hit;
      }
    }
    return best;
  }

  /** Marks a vertex, in this and all frames to come. */
  mark(vertex: number | null, radius: number): void {
    this.marked = vertex;
    this.marker.scale.setScalar(radius);
    this.placeMarker();
  }

  private placeMarker(): void {
    this.marker.visible = this.marked !== null && this.current !== null;
    if (this.marked !== null && this.current !== null) {
      this.marker.position.fromArray(this.current.positions, 3 * this.marked);
    }
  }

  dispose(): void {
    for (const part of this.parts) {
      part.dispose();
    }
    this.lamp.dispose();
  }
}

export function middle(box: Box): [number, number, number] {
  return [0, 1, 2].map((k) => (box.min[k] + box.max[k]) / 2) as [number, number, number];
}

export function radiusOf(box: Box): number {
  return Math.hypot(...[0, 1, 2].map((k) => (box.max[k] - box.min[k]) / 2));
}
