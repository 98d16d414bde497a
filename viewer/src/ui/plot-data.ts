// Which figures of a run there are to plot, and the curves of each.

import type { Columns } from "../data/source";

export interface Curve {
  name: string;
  x: (number | null)[];
  y: (number | null)[];
  /** Which colour, and which result. */
  color: number;
  result: number;
}

export interface Figure {
  key: string;
  title: string;
  unit: string;
  isLog: boolean;
}

const SINGLE: readonly [key: string, title: string, unit: string, isLog: boolean][] = [
  ["newton_iterations", "Newton iterations a step", "", false],
  ["contacts", "Contacts", "", false],
  ["min_gap", "Smallest gap", "m", true],
  ["smallest_fraction", "Shortest part of a Newton step", "", true],
  ["kappa", "Barrier stiffness", "J/m²", true],
  ["residual", "Residual", "m", true],
  ["load_factor", "Load factor", "", false],
];

const GROUPS: readonly [prefix: string, title: string, unit: string][] = [
  ["energies.", "Energies", "J"],
  ["seconds.", "Seconds a step, by part", "s"],
  ["contacts_by_bodies.", "Contacts, by bodies", ""],
];

/** The figures that these columns can show. */
export function figures(stats: Columns, probes: Columns): Figure[] {
  const names = Object.keys(stats);
  const found: Figure[] = [];
  for (const [prefix, title, unit] of GROUPS) {
    if (names.some((name) => name.startsWith(prefix))) {
      found.push({ key: prefix, title, unit, isLog: false });
    }
  }
  for (const [key, title, unit, isLog] of SINGLE) {
    if (stats[key]?.some((value) => value !== null && (!isLog || value > 0))) {
      found.push({ key, title, unit, isLog });
    }
  }
  for (const name of probeNames(probes)) {
    found.push({ key: `probe:${name}`, title: `Probe ${name}`, unit: "", isLog: false });
  }
  return found;
}

/** Probes without their components: `tip.x` and `tip.y` are one. */
function probeNames(probes: Columns): string[] {
  const columns = Object.keys(probes).filter((name) => name !== "time");
  return [...new Set(columns.map((name) => name.replace(/[._][xyz]$/, "")))];
}

/** The curves of a figure for one result. */
export function curves(figure: Figure, stats: Columns, probes: Columns, result: number): Curve[] {
  const isProbe = figure.key.startsWith("probe:");
  const columns = isProbe ? probes : stats;
  const key = isProbe ? figure.key.slice("probe:".length) : figure.key;
  const isGroup = GROUPS.some(([prefix]) => prefix === key);
  const names = Object.keys(columns).filter((name) =>
    isGroup ? name.startsWith(key) : name === key || (isProbe && name.replace(/[._][xyz]$/, "") === key),
  );
  const x = columns.time ?? [];
  const made = names.map((name, color) => ({
    name: (isGroup ? name.slice(key.length) : name).replaceAll("_", " "),
    x,
    y: columns[name],
    color,
    result,
  }));
  return isGroup ? largestFirst(made) : made;
}

/** Curves of groups in the order of their size; of many the largest. */
function largestFirst(made: Curve[]): Curve[] {
  const size = (curve: Curve) => curve.y.reduce<number>((most, y) => Math.max(most, Math.abs(y ?? 0)), 0);
  return made
    .filter((curve) => size(curve) > 0)
    .sort((a, b) => size(b) - size(a))
    .slice(0, 8)
    .map((curve, color) => ({ ...curve, color }));
}

/** Smallest and largest of what can be drawn. */
export function extent(values: (number | null)[][], isLog: boolean): [number, number] | null {
  let low = Infinity;
  let high = -Infinity;
  for (const list of values) {
    for (const value of list) {
      if (value !== null && Number.isFinite(value) && (!isLog || value > 0)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
  }
  if (low > high) {
    return null;
  }
  if (isLog) {
    return low === high ? [low / 10, high * 10] : [low, high];
  }
  const margin = low === high ? Math.abs(low) || 1 : 0.04 * (high - low);
  return [low - margin, high + margin];
}
