// What the page takes for results of several sizes, in headless Chromium without a graphics processor, at 1280 × 720.

import { readdirSync, readFileSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import type { Browser, Page } from "playwright-core";
import { openBrowser, openPage, remove, serve, stopAll, temporaryFolder } from "../browser/harness";
import { makeResult } from "./make-result";

interface Case {
  name: string;
  cells: number;
  frames: number;
}

const CASES: Case[] = [
  { name: "40k", cells: 141, frames: 200 },
  { name: "160k", cells: 283, frames: 60 },
  { name: "10k-frames", cells: 20, frames: 10_000 },
];

/** How long it is played [ms]. */
const PLAYED = 5000;
const SCRUBS = 40;

/** Seconds from the address to the first picture. */
async function timeToOpen(browser: Browser, url: string): Promise<{ page: Page; seconds: number }> {
  const begin = performance.now();
  const page = await openPage(browser, url);
  return { page, seconds: (performance.now() - begin) / 1000 };
}

/** Different frames and pictures a second while it plays at 30 frames a second. */
async function play(page: Page): Promise<{ frames: number; pictures: number; pixels: number }> {
  return page.evaluate(async (played) => {
    const { koiter } = window as any;
    // A picture of all frames, whatever the clock of the run is.
    const { player, viewport } = koiter;
    player.seek(player.start);
    player.speed = 0.5;
    const seen: unknown[] = [];
    const drawn = viewport.onDrawn;
    viewport.onDrawn = () => {
      drawn();
      const { current } = koiter.results[0].stage;
      if (seen[seen.length - 1] !== current) {
        seen.push(current);
      }
    };
    const before = viewport.drawn;
    const begin = performance.now();
    player.play();
    await new Promise((resolve) => setTimeout(resolve, played));
    const seconds = (performance.now() - begin) / 1000;
    const pixels = viewport.canvas.width;
    player.pause();
    player.speed = 1;
    viewport.onDrawn = drawn;
    return { frames: seen.length / seconds, pictures: (viewport.drawn - before) / seconds, pixels };
  }, PLAYED);
}

/**
 * Processor time of the browser's processes so far [ms], where the system tells it (Linux). On a machine that does other things too
 * it says more than the clock: so many milliseconds of one core a picture takes.
 */
function processorTime(): number {
  let ticks = 0;
  try {
    for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
      const [, name, rest] = /^\d+ \((.*)\) (.*)$/s.exec(readStat(pid)) ?? [];
      if (name?.startsWith("chrom")) {
        const words = rest.split(" ");
        ticks += Number(words[11]) + Number(words[12]);
      }
    }
  } catch {
    return NaN;
  }
  return 10 * ticks;
}

/** Empty for a process that has just ended. */
function readStat(pid: string): string {
  try {
    return readFileSync(`/proc/${pid}/stat`, "utf8");
  } catch {
    return "";
  }
}

/** Median and slowest time from a move of the slider to the picture [ms]. */
async function scrub(page: Page): Promise<{ median: number; slowest: number }> {
  return page.evaluate(async (count) => {
    const { koiter } = window as any;
    const slider = document.querySelector<HTMLInputElement>('input[aria-label="Frame"]');
    const taken: number[] = [];
    for (let k = 0; k < count; k++) {
      const begin = performance.now();
      const drawn = koiter.viewport.drawn;
      // All over the run, and never near the frame before.
      (slider as HTMLInputElement).value = String(Math.floor(((k * 0.618) % 1) * Number(slider?.max)));
      slider?.dispatchEvent(new Event("input"));
      await koiter.show();
      while (koiter.viewport.drawn === drawn) {
        await new Promise(requestAnimationFrame);
      }
      taken.push(performance.now() - begin);
    }
    taken.sort((a, b) => a - b);
    return { median: taken[count >> 1], slowest: taken[count - 1] };
  }, SCRUBS);
}

/** Memory of the page's scripts and arrays [MB]. */
async function memory(page: Page): Promise<number> {
  const session = await page.context().newCDPSession(page);
  await session.send("HeapProfiler.collectGarbage");
  const { usedSize, backingStorageSize } = (await session.send("Runtime.getHeapUsage")) as {
    usedSize: number;
    backingStorageSize?: number;
  };
  return (usedSize + (backingStorageSize ?? 0)) / 1e6;
}

async function measure(browser: Browser, folder: string, wanted: Case): Promise<void> {
  const result = join(folder, wanted.name);
  const faces = makeResult({ folder: result, ...wanted });
  const served = await serve(result);
  const { page, seconds } = await timeToOpen(browser, served.url);
  // Shaders are compiled, frames read: the second time is what people see.
  await play(page);
  const before = processorTime();
  const played = await play(page);
  const processor = processorTime() - before;
  const scrubbed = await scrub(page);
  const megabytes = await memory(page);
  console.log(
    JSON.stringify({
      case: wanted.name,
      triangles: faces,
      frames: wanted.frames,
      open_seconds: Number(seconds.toFixed(2)),
      frames_a_second: Number(played.frames.toFixed(1)),
      pictures_a_second: Number(played.pictures.toFixed(1)),
      processor_ms_a_picture: Math.round(processor / Math.max(1, (played.pictures * PLAYED) / 1000)),
      pixels_across: played.pixels,
      scrub_median_ms: Math.round(scrubbed.median),
      scrub_slowest_ms: Math.round(scrubbed.slowest),
      page_megabytes: Math.round(megabytes),
    }),
  );
  await page.close();
  served.stop();
  remove(result);
}

function bundleSize(): void {
  const script = readFileSync(join("dist", "viewer.js"));
  const sizes = { bundle_bytes: script.length, compressed_bytes: gzipSync(script).length };
  console.log(JSON.stringify({ case: "bundle", ...sizes }));
}

const wanted = process.argv.slice(2);
const folder = temporaryFolder();
const browser = await openBrowser();
try {
  for (const one of CASES.filter(({ name }) => wanted.length === 0 || wanted.includes(name))) {
    await measure(browser, folder, one);
  }
} finally {
  await browser.close();
  stopAll();
  remove(folder);
}
bundleSize();
console.log(JSON.stringify({ case: "machine", load: loadavg().map((load) => Number(load.toFixed(1))) }));
