// What is written over the picture: title, time, legend. A canvas, so that it is part of pictures and films.

import { cssColor, type MapName } from "../scene/color-map";
import { readable, ticks } from "../scene/ticks";
import { themeColor } from "./dom";

export interface Legend {
  name: string;
  unit: string;
  map: MapName;
  low: number;
  high: number;
}

export interface Words {
  /** One a result, from left to right. */
  titles: string[];
  caption: string;
  legend: Legend | null;
}

const FONT = "system-ui, sans-serif";
const MARGIN = 16;
const BAR = { width: 16, height: 190 };

/** Writes on a canvas of this size in CSS pixels. */
export function writeOver(context: CanvasRenderingContext2D, width: number, height: number, words: Words): void {
  context.textBaseline = "alphabetic";
  context.textAlign = "left";
  context.font = `600 16px ${FONT}`;
  const column = width / Math.max(1, words.titles.length);
  words.titles.forEach((title, k) => {
    write(context, title, k * column + MARGIN, 28, column - 2 * MARGIN);
  });
  context.font = `15px ${FONT}`;
  write(context, words.caption, MARGIN, height - MARGIN);
  if (words.titles.length > 1) {
    context.fillStyle = themeColor("line");
    for (let k = 1; k < words.titles.length; k++) {
      context.fillRect(Math.floor(k * column), 0, 1, height);
    }
  }
  if (words.legend !== null) {
    drawLegend(context, words.legend, height);
  }
}

/** Text that is read in front of anything. */
function write(context: CanvasRenderingContext2D, text: string, x: number, y: number, width?: number): void {
  context.strokeStyle = themeColor("back");
  context.fillStyle = themeColor("text");
  context.lineWidth = 4;
  context.lineJoin = "round";
  context.strokeText(text, x, y, width);
  context.fillText(text, x, y, width);
}

function drawLegend(context: CanvasRenderingContext2D, legend: Legend, height: number): void {
  const barHeight = Math.min(BAR.height, height - 150);
  if (barHeight < 40) {
    return;
  }
  const bottom = height - 52;
  const top = bottom - barHeight;
  for (let y = 0; y < barHeight; y++) {
    context.fillStyle = cssColor(legend.map, 1 - y / (barHeight - 1));
    context.fillRect(MARGIN, top + y, BAR.width, 1.5);
  }
  context.strokeStyle = themeColor("faint");
  context.lineWidth = 1;
  context.strokeRect(MARGIN + 0.5, top + 0.5, BAR.width, barHeight);
  context.font = `14px ${FONT}`;
  const unit = legend.unit === "" ? "" : ` [${legend.unit}]`;
  write(context, legend.name + unit, MARGIN, top - 12);
  for (const tick of ticks(legend.low, legend.high, 5)) {
    const share = (tick - legend.low) / (legend.high - legend.low || 1);
    const y = bottom - share * barHeight;
    context.fillRect(MARGIN + BAR.width, Math.round(y), 4, 1);
    write(context, readable(tick), MARGIN + BAR.width + 8, y + 5);
  }
}
