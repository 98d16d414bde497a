// Camera presets, the same as those of `koiter render --camera`.

import type { Axis } from "../data/source";

export type Preset = "front" | "side" | "top" | "iso" | "back" | "below";

/** Azimuth about the up axis and elevation above the horizon [degrees]. */
const ANGLES: Record<Preset, [number, number]> = {
  front: [0, 0],
  side: [90, 0],
  top: [0, 90],
  iso: [35, 28],
  back: [180, 0],
  below: [0, -90],
};

export const PRESETS: readonly Preset[] = ["iso", "front", "side", "top", "back", "below"];

/** The direction from what is looked at to the camera. Azimuth 0 looks along +y where z is up. */
export function fromDirection(preset: Preset, up: Axis): [number, number, number] {
  const [azimuth, elevation] = ANGLES[preset].map((degrees) => (degrees * Math.PI) / 180);
  const flat = Math.cos(elevation);
  // Straight down is told from up by a little, so that +y is up in the picture.
  const tilt = Math.abs(flat) < 1e-6 ? 1e-4 : flat;
  const [x, y, z] = [tilt * Math.sin(azimuth), -tilt * Math.cos(azimuth), Math.sin(elevation)];
  // The axes turn in their order, so that hands stay hands.
  return up === "z" ? [x, y, z] : up === "x" ? [z, x, y] : [y, z, x];
}

export function upVector(up: Axis): [number, number, number] {
  return [up === "x" ? 1 : 0, up === "y" ? 1 : 0, up === "z" ? 1 : 0];
}
