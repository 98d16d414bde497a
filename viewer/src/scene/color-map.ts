// Colours for numbers, the same as in pictures of `koiter render`: 17 colours of each map, linear between.

export type MapName = "viridis" | "cividis" | "coolwarm";

export const MAPS: Record<MapName, string> = {
  viridis: "Viridis",
  cividis: "Cividis",
  coolwarm: "Blue to red",
};

const VIRIDIS = [
  [68, 1, 84], [72, 24, 106], [71, 45, 123], [66, 64, 134], [59, 82, 139],
  [51, 99, 141], [44, 114, 142], [38, 130, 142], [33, 145, 140], [31, 160, 136],
  [40, 174, 128], [63, 188, 115], [94, 201, 98], [132, 212, 75], [173, 220, 48],
  [216, 226, 25], [253, 231, 37],
] as const;
const CIVIDIS = [
  [0, 34, 78], [0, 46, 106], [26, 56, 111], [50, 67, 109], [67, 78, 108],
  [83, 90, 109], [97, 101, 111], [111, 112, 115], [125, 124, 120], [140, 136, 120],
  [155, 148, 118], [171, 160, 114], [188, 174, 108], [205, 187, 99], [222, 201, 88],
  [240, 216, 70], [254, 232, 56],
] as const;
const COOLWARM = [
  [59, 76, 192], [78, 104, 216], [98, 130, 234], [119, 154, 247], [141, 176, 254],
  [163, 194, 254], [185, 208, 249], [204, 217, 237], [221, 220, 220], [236, 211, 197],
  [245, 196, 172], [247, 176, 147], [244, 152, 122], [235, 125, 98], [221, 95, 75],
  [202, 59, 55], [180, 4, 38],
] as const;

const TABLES: Record<MapName, readonly (readonly number[])[]> = {
  viridis: VIRIDIS,
  cividis: CIVIDIS,
  coolwarm: COOLWARM,
};

/** Colour of what has no value. */
export const NO_VALUE: readonly [number, number, number] = [153, 153, 153];

export function isMap(name: string): name is MapName {
  return name in TABLES;
}

/** The colour at `t` from 0 to 1, as three numbers up to 255. */
export function colorAt(map: MapName, t: number): [number, number, number] {
  if (Number.isNaN(t)) {
    return [...NO_VALUE];
  }
  const table = TABLES[map];
  const position = Math.min(Math.max(t, 0), 1) * (table.length - 1);
  const index = Math.min(Math.floor(position), table.length - 2);
  const share = position - index;
  const mix = (k: number) => table[index][k] + share * (table[index + 1][k] - table[index][k]);
  return [mix(0), mix(1), mix(2)];
}

export function cssColor(map: MapName, t: number): string {
  return `rgb(${colorAt(map, t)
    .map((c) => Math.round(c))
    .join(",")})`;
}

/** The map as `count` colours of four bytes. */
export function colorBytes(map: MapName, count: number): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(4 * count);
  for (let k = 0; k < count; k++) {
    bytes.set([...colorAt(map, k / (count - 1)).map(Math.round), 255], 4 * k);
  }
  return bytes;
}

/** Colours for parts and curves that red-green blind people tell apart (Okabe and Ito 2008). */
export const CURVES: readonly string[] = [
  "#0072b2",
  "#d55e00",
  "#009e73",
  "#cc79a7",
  "#e69f00",
  "#56b4e9",
  "#8c8c8c",
  "#b59f00",
];

/** Of shells, as in pictures. */
export const SHELLS: readonly string[] = ["#5c8ac4", "#e3ab52", "#cc5c54", "#73a880", "#997dbd"];
export const OBSTACLE = "#c9c7c2";
