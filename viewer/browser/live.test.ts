// A run that goes on, followed and steered from the page; and a result that is exported.

import assert from "node:assert/strict";
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { existsSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import type { Browser } from "playwright-core";
import { end, openBrowser, openPage, pictureFolder, PROGRAM, remove, serve, share, stopAll, temporaryFolder } from "./harness";

const SCENE = `title = "Falling"
time = { end = 100, dt = 0.01 }
gravity = [0, 0, -0.02]

[[shell]]
name = "cloth"
material = "cotton"
mesh.grid = { size = [0.5, 0.5], cells = [12, 12] }
mesh.translate = [0, 0, 1]
`;

let folder: string;
let browser: Browser;
let run: ChildProcess | undefined;

before(async () => {
  folder = temporaryFolder();
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  stopAll();
  if (run !== undefined) {
    end(run);
  }
  remove(folder);
});

async function until(what: string, holds: () => boolean): Promise<void> {
  for (let tries = 0; tries < 300; tries++) {
    if (holds()) {
      return;
    }
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  throw new Error(`waited in vain: ${what}`);
}

test("a run is followed, paused, continued and stopped", async () => {
  const [scene, out] = [join(folder, "scene.toml"), join(folder, "out")];
  writeFileSync(scene, SCENE);
  run = spawn(PROGRAM, ["run", scene, "--out", out, "--no-film", "--quiet", "--threads", "1"], { stdio: "ignore" });
  const status = new Promise<number | null>((resolve) => run?.once("exit", resolve));
  await until("a first frame", () => existsSync(join(out, "frames", "00001.bin")));
  const served = await serve(out);
  const page = await openPage(browser, served.url);
  const frames = () => page.evaluate(() => (window as any).koiter.results[0].times.length as number);
  const before = await frames();
  await page.waitForFunction((count) => (window as any).koiter.results[0].times.length > count, before);
  await page.screenshot({ path: join(pictureFolder(), "live.png") });

  await page.locator('button:has-text("Pause")').click();
  await page.waitForSelector('button:has-text("Continue")');
  // The step that was being taken ends; then nothing comes.
  await page.waitForTimeout(1500);
  const paused = await frames();
  await page.waitForTimeout(2000);
  assert.equal(await frames(), paused);
  await page.locator('button:has-text("Continue")').click();
  await page.waitForFunction((count) => (window as any).koiter.results[0].times.length > count, paused);

  await page.locator('button:has-text("Stop")').click();
  assert.equal(await status, 1, "an interrupted run says so");
  run = undefined;
  await page.waitForFunction(() => document.querySelector("aside")?.textContent?.includes("can be resumed"));
  assert.ok(!existsSync(join(out, "request.txt")));
  assert.equal(JSON.parse(readFileSync(join(out, "summary.json"), "utf8")).interrupted, true);
  await page.close();
  served.stop();
});

for (const [kind, shell] of [
  ["a shell", '[[shell]]\nname = "cloth"\nmaterial = "cotton"\nmesh.grid = { size = [0.5, 0.5], cells = [8, 8] }'],
  [
    "a Bézier shell",
    '[contact]\nenabled = false\n[[bezier_shell]]\nname = "cloth"\nmaterial = { young = 1e6, poisson = 0.3, density = 500 }\nthickness = 1e-3\nmesh.grid = { size = [0.5, 0.5], cells = [4, 4] }',
  ],
]) {
  test(`${kind} is pulled with the mouse, and let go`, async () => {
    const [scene, out] = [join(folder, "pulled.toml"), join(folder, `pulled ${kind}`)];
    writeFileSync(scene, `title = "Pulled"\ntime = { end = 0.5, dt = 0.02 }\ngravity = [0, 0, 0]\n${shell}\n`);
    const options = ["--interactive", "--no-film", "--quiet", "--threads", "1"];
    run = spawn(PROGRAM, ["run", scene, "--out", out, ...options], { stdio: "ignore" });
    await until("a first frame", () => existsSync(join(out, "frames", "00001.bin")));
    const served = await serve(out);
    const page = await openPage(browser, served.url);
    await page.waitForSelector("#pull");
    await page.keyboard.press("g");
    /** The largest way that a vertex has gone since the first frame [m]. */
    const moved = () =>
      page.evaluate(async () => {
        const { koiter } = window as any;
        // A run that is played with is followed without being asked.
        await koiter.show();
        const { positions } = koiter.results[0].stage.current;
        const first = (await koiter.results[0].cache.get(0, null)).positions;
        return Math.max(...[...positions].map((x: number, k: number) => Math.abs(x - first[k])));
      });
    assert.ok((await moved()) < 1e-6, "nothing moves before it is pulled");
    const view = await page.evaluate(() => (window as any).koiter.viewport.camera.position.toArray());
    const box = (await page.locator("canvas").first().boundingBox())!;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y - 40, { steps: 5 });
    for (let tries = 0; tries < 100 && (await moved()) < 0.03; tries++) {
      await page.waitForTimeout(100);
    }
    await page.screenshot({ path: join(pictureFolder(), `pulled-${kind.replaceAll(" ", "-")}.png`) });
    assert.ok((await moved()) > 0.03, `${await moved()} m`);
    assert.match(readFileSync(join(out, "hand.txt"), "utf8"), /^\d+( [-\d.e]+){3}\n$/);
    await page.mouse.up();
    await until("the hand to let go", () => readFileSync(join(out, "hand.txt"), "utf8") === "released\n");
    assert.deepEqual(await page.evaluate(() => (window as any).koiter.viewport.camera.position.toArray()), view);

    const status = new Promise<number | null>((resolve) => run?.once("exit", resolve));
    await page.locator('button:has-text("Stop")').click();
    await status;
    run = undefined;
    assert.ok(!existsSync(join(out, "hand.txt")));
    await page.close();
    served.stop();
  });
}

test("an exported file shows the same without a server", async () => {
  const out = join(folder, "out");
  const file = join(folder, "falling.html");
  execFileSync(PROGRAM, ["export", out, "--to", "html", "-o", file]);
  assert.ok(statSync(file).size < 4e6, `${statSync(file).size} bytes`);
  const page = await openPage(browser, pathToFileURL(file).href);
  assert.ok((await share(page, "b > r + 25 && b > 60")) > 0.02);
  await page.keyboard.press("End");
  const last = await page.evaluate(async () => {
    const { koiter } = window as any;
    await koiter.show();
    const { stage, times } = koiter.results[0];
    return { z: stage.current.positions[2] as number, time: times[times.length - 1] as number };
  });
  // Free fall from 1 m by implicit Euler, on a small planet: 1 − g t (t + dt) / 2, to the sixteen bits of the file.
  const fallen = 1 - (0.02 * last.time * (last.time + 0.01)) / 2;
  assert.ok(Math.abs(last.z - fallen) < 1e-3 * Math.max(1, Math.abs(fallen)), `${last.z}, not ${fallen}`);
  await page.locator("#coloring").selectOption("displacement");
  await page.screenshot({ path: join(pictureFolder(), "exported.png") });
  await page.close();
});
