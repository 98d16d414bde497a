// A browser, the program, and folders to show: what the browser tests and benches begin with.

import { type ChildProcess, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { type Browser, chromium, type Page } from "playwright-core";

/** Where a browser may be; the environment variable `KOITER_BROWSER` comes first. */
const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

export const PROGRAM = process.env.KOITER_PROGRAM ?? join("..", "target", "release", "koiter");

export async function openBrowser(): Promise<Browser> {
  const path = [process.env.KOITER_BROWSER, ...BROWSERS].find((found) => found && existsSync(found));
  if (path === undefined) {
    throw new Error("no Chromium: install it, or name it in KOITER_BROWSER");
  }
  return chromium.launch({
    executablePath: path,
    // Pictures without a graphics processor; containers have neither a sandbox nor much shared memory.
    args: ["--disable-gpu", "--enable-unsafe-swiftshader", "--no-sandbox", "--disable-dev-shm-usage"],
  });
}

export function temporaryFolder(): string {
  return mkdtempSync(join(tmpdir(), "koiter-viewer-"));
}

/** Where screenshots are kept. */
export function pictureFolder(): string {
  const folder = process.env.KOITER_PICTURES ?? join("..", "target", "viewer-pictures");
  mkdirSync(folder, { recursive: true });
  return folder;
}

export interface Served {
  url: string;
  stop(): void;
}

const running = new Set<ChildProcess>();

/** Ends all servers: one that a failed test left would keep the tests from ending. */
export function stopAll(): void {
  running.forEach(end);
}

/** `koiter view` of some results. */
export function serve(...shown: string[]): Promise<Served> {
  const process = spawn(PROGRAM, ["view", ...shown, "--no-open", "--json"], { stdio: ["ignore", "pipe", "inherit"] });
  running.add(process);
  return new Promise((resolve, reject) => {
    process.once("error", reject);
    process.once("exit", (code) => reject(new Error(`koiter view ended with status ${code}`)));
    process.stdout.once("data", (data: Buffer) => {
      const { url } = JSON.parse(data.toString()) as { url: string };
      resolve({ url, stop: () => end(process) });
    });
  });
}

export function end(process: ChildProcess): void {
  process.removeAllListeners("exit");
  running.delete(process);
  process.kill("SIGKILL");
}

export function remove(folder: string): void {
  rmSync(folder, { recursive: true, force: true });
}

/** A page that has drawn; what it complains about is an error of the test. */
export async function openPage(browser: Browser, url: string, size = { width: 1280, height: 720 }): Promise<Page> {
  // Tests look into the page by scripts that its policy would refuse.
  const page = await browser.newPage({ viewport: size, bypassCSP: true });
  page.setDefaultTimeout(20_000);
  page.on("pageerror", (error) => {
    throw error;
  });
  await page.goto(url);
  await page.waitForFunction("window.koiter !== undefined && window.koiter.viewport.drawn > 1");
  return page;
}

export interface Pixel {
  r: number;
  g: number;
  b: number;
}

/** Share of the pixels of the picture (without the panel) that a test on colours, written as JavaScript, holds for. */
export async function share(page: Page, test: string): Promise<number> {
  return page.evaluate(
    ([condition]) => {
      const { koiter } = window as unknown as { koiter: { compose(target: HTMLCanvasElement): void } };
      const target = document.createElement("canvas");
      koiter.compose(target);
      const context = target.getContext("2d") as CanvasRenderingContext2D;
      const { data } = context.getImageData(0, 0, target.width, target.height);
      const holds = new Function("r", "g", "b", `return ${condition};`) as (r: number, g: number, b: number) => boolean;
      let count = 0;
      for (let k = 0; k < data.length; k += 4) {
        count += holds(data[k], data[k + 1], data[k + 2]) ? 1 : 0;
      }
      return count / (data.length / 4);
    },
    [test] as const,
  );
}
