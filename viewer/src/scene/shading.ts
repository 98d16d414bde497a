// How surfaces are lit: a lamp with shadows and the light of the sky, computed at vertices.
//
// ```text
// colour shown = colour √(sky + shadow · sun),  sky = 0.35 + 0.13 n·up,  sun = 0.68 max(n·lamp, 0)
// ```
//
// The root stands for the curve of screens, so that colours need not be converted. Light at vertices instead of pixels takes a
// third of the time where there is no graphics processor, and meshes are fine enough for it.

import {
  Color,
  DataTexture,
  DoubleSide,
  LinearSRGBColorSpace,
  type Plane,
  ShaderMaterial,
  UniformsLib,
  UniformsUtils,
  Vector3,
} from "three";
import { colorBytes, type MapName } from "./color-map";

/** What colours of values mean, shared by all parts of all results. */
export class ValueColors {
  private readonly texture = new DataTexture(colorBytes("viridis", 256), 256, 1);
  readonly uniforms: Record<string, { value: unknown }>;

  constructor() {
    this.texture.needsUpdate = true;
    this.uniforms = {
      valueMap: { value: this.texture },
      valueLow: { value: 0 },
      valueScale: { value: 1 },
    };
  }

  set(map: MapName, low: number, high: number): void {
    (this.texture.image.data as Uint8Array).set(colorBytes(map, 256));
    this.texture.needsUpdate = true;
    this.uniforms.valueLow.value = low;
    this.uniforms.valueScale.value = high > low ? 1 / (high - low) : 1;
  }
}

/** Where light comes from, shared by the parts of a result. */
export class Lighting {
  readonly lamp = new Vector3(0, 0, 1);
  readonly up = new Vector3(0, 0, 1);
  readonly uniforms = { lampDirection: { value: this.lamp }, upDirection: { value: this.up } };
}

/** Stands for NaN, which graphics processors may treat as they like. */
export const NO_VALUE = -1e38;

const VERTEX = /* glsl */ `
#include <common>
#include <shadowmap_pars_vertex>
#include <clipping_planes_pars_vertex>
uniform vec3 lampDirection;
uniform vec3 upDirection;
varying vec4 vLight;
#ifdef USE_VALUE
attribute float value;
varying float vValue;
#endif
void main() {
  #include <beginnormal_vertex>
  #include <defaultnormal_vertex>
  #include <begin_vertex>
  #include <project_vertex>
  #include <worldpos_vertex>
  #include <shadowmap_vertex>
  #include <clipping_planes_vertex>
  float sky = 0.13 * dot(normal, upDirection);
  float sun = 0.68 * dot(normal, lampDirection);
  // Sky and sun in front, then behind.
  vLight = vec4(0.35 + sky, max(sun, 0.0), 0.35 - sky, max(-sun, 0.0));
  #ifdef USE_VALUE
  vValue = value;
  #endif
}`;

const FRAGMENT = /* glsl */ `
#include <common>
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
#include <clipping_planes_pars_fragment>
uniform vec3 baseColor;
varying vec4 vLight;
#ifdef USE_VALUE
varying float vValue;
uniform sampler2D valueMap;
uniform float valueLow;
uniform float valueScale;
#endif
void main() {
  #include <clipping_planes_fragment>
  vec2 light = gl_FrontFacing ? vLight.xy : vLight.zw;
  vec3 color = baseColor;
  #ifdef USE_VALUE
  float share = clamp((vValue - valueLow) * valueScale, 0.0, 1.0);
  color = vValue < -1e37 ? vec3(0.6) : texture2D(valueMap, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  #endif
  gl_FragColor = vec4(color * sqrt(light.x + light.y * getShadowMask()), 1.0);
}`;

/** The material of a part. */
export function surfaceMaterial(
  color: string,
  colors: ValueColors,
  lighting: Lighting,
  planes: Plane[],
): ShaderMaterial {
  const material = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: UniformsUtils.merge([UniformsLib.lights]),
    lights: true,
    clipping: true,
    clippingPlanes: planes,
    clipShadows: true,
    side: DoubleSide,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  Object.assign(material.uniforms, colors.uniforms, lighting.uniforms, { baseColor: { value: screenColor(color) } });
  return material;
}

/** A colour as it is shown, not as amounts of light. */
export function screenColor(color: string): Color {
  return new Color().setStyle(color, LinearSRGBColorSpace);
}
