// One shell or obstacle as three.js draws it.

import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  type Plane,
  type ShaderMaterial,
  Sphere,
  Vector3,
} from "three";
import type { Part } from "../data/source";
import { cornerNormals, corners, edges, vertexNormals } from "./mesh-math";
import { type Lighting, NO_VALUE, screenColor, surfaceMaterial, type ValueColors } from "./shading";

/** Smooth: light and values run over edges. Faces: each face has its own, as computed. */
export type Shading = "smooth" | "faces";

export class PartView {
  readonly group = new Group();
  private readonly faces: Uint32Array;
  private readonly numVertices: number;
  private readonly positions: BufferAttribute;
  private surface: Mesh<BufferGeometry, ShaderMaterial>;
  private wires: LineSegments | null = null;
  private hasValues = false;
  private shading: Shading = "smooth";

  constructor(
    readonly part: Part,
    allFaces: Uint32Array,
    private color: string,
    private readonly colors: ValueColors,
    private readonly lighting: Lighting,
    private readonly planes: Plane[],
  ) {
    const offset = part.vertices.start;
    this.numVertices = part.vertices.end - offset;
    this.faces = allFaces.slice(3 * part.faces.start, 3 * part.faces.end).map((v) => v - offset);
    this.positions = dynamic(new Float32Array(3 * this.numVertices), 3);
    this.surface = this.makeSurface();
    this.group.add(this.surface);
  }

  /** Moves the vertices to those of a frame of the whole. */
  move(frame: Float32Array): void {
    const { start, end } = this.part.vertices;
    (this.positions.array as Float32Array).set(frame.subarray(3 * start, 3 * end));
    this.positions.needsUpdate = true;
    this.light();
  }

  /** Values at all vertices of the whole, or at all faces, or none. */
  paint(values: Float32Array | null, of: "vertices" | "faces"): void {
    const has = values !== null && this.part.kind === "shell";
    if (has) {
      const attribute = this.surface.geometry.getAttribute("value") as BufferAttribute;
      const target = attribute.array as Float32Array;
      const { start } = of === "vertices" ? this.part.vertices : this.part.faces;
      const at = this.valueIndex(of);
      for (let k = 0; k < target.length; k++) {
        const value = values[start + at(k)];
        target[k] = Number.isFinite(value) ? value : NO_VALUE;
      }
      attribute.needsUpdate = true;
    }
    if (has !== this.hasValues) {
      this.hasValues = has;
      this.surface.material.defines = has ? { USE_VALUE: "" } : {};
      this.surface.material.needsUpdate = true;
    }
  }

  setShading(shading: Shading): void {
    if (shading === this.shading) {
      return;
    }
    this.shading = shading;
    const { castShadow, receiveShadow } = this.surface;
    this.group.remove(this.surface);
    this.surface.geometry.dispose();
    this.surface.material.dispose();
    this.surface = this.makeSurface();
    this.hasValues = false;
    this.setShadows(castShadow || receiveShadow);
    this.group.add(this.surface);
    this.light();
  }

  setWireframe(shown: boolean, color: string): void {
    if (shown && this.wires === null) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", this.positions);
      geometry.setIndex(new BufferAttribute(edges(this.faces, this.numVertices), 1));
      geometry.boundingSphere = everywhere();
      const material = new LineBasicMaterial({ transparent: true, opacity: 0.45, clippingPlanes: this.planes });
      this.wires = new LineSegments(geometry, material);
      this.group.add(this.wires);
    }
    // Room for the lines in front. Without them it would let through what lies close behind steep faces.
    this.surface.material.polygonOffset = shown;
    if (this.wires !== null) {
      this.wires.visible = shown;
      (this.wires.material as LineBasicMaterial).color.set(color);
    }
  }

  setColor(color: string): void {
    this.color = color;
    this.surface.material.uniforms.baseColor.value = screenColor(color);
  }

  setShadows(shown: boolean): void {
    this.surface.castShadow = shown;
    this.surface.receiveShadow = shown;
  }

  dispose(): void {
    this.surface.geometry.dispose();
    this.surface.material.dispose();
    this.wires?.geometry.dispose();
    (this.wires?.material as LineBasicMaterial | undefined)?.dispose();
  }

  /** Which value of the part belongs to entry `k` of the drawn vertices. */
  private valueIndex(of: "vertices" | "faces"): (k: number) => number {
    if (this.shading === "smooth") {
      if (of === "faces") {
        throw new Error("values of faces are averaged at vertices before they are drawn smoothly");
      }
      return (k) => k;
    }
    return of === "vertices" ? (k) => this.faces[k] : (k) => (k / 3) | 0;
  }

  private light(): void {
    const geometry = this.surface.geometry;
    const position = geometry.getAttribute("position") as BufferAttribute;
    const normal = geometry.getAttribute("normal") as BufferAttribute;
    const source = this.positions.array as Float32Array;
    if (this.shading === "smooth") {
      vertexNormals(source, this.faces, normal.array as Float32Array);
    } else {
      corners(source, this.faces, position.array as Float32Array);
      cornerNormals(position.array as Float32Array, normal.array as Float32Array);
      position.needsUpdate = true;
    }
    normal.needsUpdate = true;
  }

  private makeSurface(): Mesh<BufferGeometry, ShaderMaterial> {
    const geometry = new BufferGeometry();
    const isSmooth = this.shading === "smooth";
    const count = isSmooth ? this.numVertices : this.faces.length;
    const position = isSmooth ? this.positions : dynamic(new Float32Array(3 * count), 3);
    geometry.setAttribute("position", position);
    geometry.setAttribute("normal", dynamic(new Float32Array(3 * count), 3));
    geometry.setAttribute("value", dynamic(new Float32Array(count), 1));
    if (isSmooth) {
      geometry.setIndex(new BufferAttribute(this.faces, 1));
    }
    geometry.boundingSphere = everywhere();
    const material = surfaceMaterial(this.color, this.colors, this.lighting, this.planes);
    material.polygonOffset = this.wires?.visible === true;
    return new Mesh(geometry, material);
  }
}

function dynamic(array: Float32Array, size: number): BufferAttribute {
  return new BufferAttribute(array, size).setUsage(DynamicDrawUsage);
}

/** Parts move every frame and are nearly always in view: they are always drawn. */
function everywhere(): Sphere {
  return new Sphere(new Vector3(), Infinity);
}
