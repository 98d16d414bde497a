// The page in a real browser: it draws, plays, compares, picks, plots, and says what is wrong.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { frameName, height, makeResult } from "../bench/make-result";
import { openBrowser, openPage, pictureFolder, remove, serve, type Served, share, stopAll, temporaryFolder } from "./harness";

const CELLS = 40;
const FRAMES = 40;
const pictures = pictureFolder();
let folder: string;
let browser: Browser;
let single: Served;
let pair: Served;
let page: Page;

const waves = () => join(folder, "waves");

before(async () => {
  folder = temporaryFolder();
  makeResult({ folder: waves(), cells: CELLS, frames: FRAMES });
  makeResult({ folder: join(folder, "higher"), title: "Higher waves", cells: CELLS, frames: FRAMES, amplitude: 0.15 });
  browser = await openBrowser();
  [single, pair] = await Promise.all([serve(waves()), serve(waves(), join(folder, "higher"))]);
  page = await openPage(browser, single.url);
});

after(async () => {
  await browser?.close();
  stopAll();
  remove(folder);
});

/** Blue of the first shell, in any light. */
const IS_SHELL = "b > r + 25 && b > 60";

test("the sheet is drawn in its colour, on its floor, in the middle", async () => {
  await page.screenshot({ path: join(pictures, "first.png") });
  const shell = await share(page, IS_SHELL);
  assert.ok(shell > 0.1 && shell < 0.7, `${shell} of the picture is sheet`);
  const errors = await page.locator(".message").textContent();
  assert.equal(errors, "");
});

test("the timeline scrubs: vertices are where the file has them", async () => {
  await page.locator('input[aria-label="Frame"]').fill("25");
  await page.waitForFunction(() => document.querySelector("output")?.textContent?.includes("26 / 40"));
  const z = await page.evaluate(async () => {
    const { koiter } = window as any;
    await koiter.show();
    return koiter.results[0].stage.current.positions[3 * 100 + 2];
  });
  const side = CELLS + 1;
  const [x, y] = [(100 % side) / CELLS - 0.5, Math.floor(100 / side) / CELLS - 0.5];
  assert.ok(Math.abs(z - height(x, y, 25 / 60, 0.1)) < 1e-6);
});

test("keys play, step and turn", async () => {
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  assert.match((await page.locator("output").textContent()) ?? "", /2 \/ 40/);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => (window as any).koiter.player.time > 0.2);
  await page.keyboard.press("Space");
  assert.equal(await page.evaluate(() => (window as any).koiter.player.isPlaying), false);
  // From below the floor hides the sheet.
  await page.keyboard.press("6");
  await page.waitForTimeout(300);
  assert.ok((await share(page, IS_SHELL)) < 0.02);
  await page.keyboard.press("1");
});

test("fields have colours, a legend with unit, and a range that can be set", async () => {
  await page.locator("#coloring").selectOption("field:mean_curvature");
  await page.waitForFunction(() => (window as any).koiter.legend?.unit === "1/m");
  const legend = await page.evaluate(async () => {
    await (window as any).koiter.show();
    return (window as any).koiter.legend;
  });
  assert.deepEqual([legend.name, legend.map], ["mean curvature", "coolwarm"]);
  // 60 times the amplitude, but for the largest hundredth; on both sides of zero.
  assert.ok(legend.high > 5.5 && legend.high <= 6.01 && legend.low === -legend.high, JSON.stringify(legend));
  const red = await share(page, "r > b + 60");
  const blue = await share(page, "b > r + 60");
  assert.ok(red > 0.02 && blue > 0.02, `${red} red, ${blue} blue`);
  await page.screenshot({ path: join(pictures, "curvature.png") });
  // With a range that all values exceed there is no blue left.
  await page.evaluate(() => (window as any).koiter.setRange(-1000, -999));
  assert.ok((await share(page, "b > r + 60")) < 0.002);
  await page.evaluate(() => (window as any).koiter.fitRange());
});

test("facets, wireframe and a section change the picture", async () => {
  const whole = await share(page, "Math.abs(r - b) > 20");
  await page.keyboard.press("s");
  await page.keyboard.press("w");
  await page.locator("#section").selectOption("x");
  await page.waitForTimeout(500);
  await page.screenshot({ path: join(pictures, "section.png") });
  const half = await share(page, "Math.abs(r - b) > 20");
  assert.ok(half > 0.2 * whole && half < 0.75 * whole, `${half} after ${whole}`);
  await page.locator("#section").selectOption("");
  await page.keyboard.press("s");
  await page.keyboard.press("w");
});

test("parts are hidden and shown alone", async () => {
  await page.locator("#coloring").selectOption("parts");
  await page.locator('button:has-text("Only")').nth(1).click();
  await page.waitForTimeout(200);
  assert.ok((await share(page, IS_SHELL)) < 0.01);
  await page.locator('button:has-text("Only")').nth(1).click();
  await page.waitForTimeout(200);
  assert.ok((await share(page, IS_SHELL)) > 0.1);
});

test("a click picks a vertex and shows its history", async () => {
  const box = await page.locator("canvas").first().boundingBox();
  assert.ok(box);
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForSelector('canvas[aria-label^="History"]');
  const table = await page.locator("aside table").first().textContent();
  assert.match(table ?? "", /sheet/);
  assert.match(table ?? "", /strain/);
  await page.screenshot({ path: join(pictures, "picked.png") });
});

test("plots follow the figures, and a click on one goes to its time", async () => {
  await page.locator("#figure").selectOption("newton_iterations");
  const plot = page.locator('canvas[aria-label^="Newton"]');
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox();
  assert.ok(box);
  await page.mouse.click(box.x + 52 + 0.5 * (box.width - 60), box.y + 60);
  const time = await page.evaluate(() => (window as any).koiter.player.time);
  // The steps are at 1/60 to 39/60 s.
  assert.ok(Math.abs(time - 20 / 60) < 0.02, `${time}`);
});

test("two results stand side by side in sync, and one is coloured by its distance", async () => {
  const both = await openPage(browser, pair.url);
  await both.keyboard.press("End");
  await both.waitForTimeout(300);
  await both.screenshot({ path: join(pictures, "side-by-side.png") });
  const times = await both.evaluate(async () => {
    const { koiter } = window as any;
    await koiter.show();
    return koiter.results.map((result: any) => result.frameAt(koiter.player.time));
  });
  assert.deepEqual(times, [39, 39]);
  await both.locator("#coloring").selectOption("distance");
  await both.waitForFunction(() => (window as any).koiter.legend?.name === "distance");
  const { high } = await both.evaluate(() => (window as any).koiter.legend);
  // Amplitudes differ by 0.05 m.
  assert.ok(high > 0.045 && high <= 0.0501, `${high}`);
  await both.locator("#layout").selectOption("1");
  await both.waitForTimeout(400);
  await both.screenshot({ path: join(pictures, "distance.png") });
  assert.ok((await share(both, "g > 120 && r > b + 60")) > 0.005, "some of it is far away: yellow");
  await both.close();
});

test("light and dark", async () => {
  await page.evaluate(() => document.documentElement.dataset.theme === "dark" || document.getElementById("dark")?.click());
  await page.waitForTimeout(300);
  await page.screenshot({ path: join(pictures, "dark.png") });
  assert.ok((await share(page, "r + g + b < 120")) > 0.15);
});

test("a picture and a film are saved", async () => {
  const [picture] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("p")]);
  assert.equal(picture.suggestedFilename(), "waves.png");
  await page.locator("summary", { hasText: "Take away" }).click();
  const [film] = await Promise.all([page.waitForEvent("download"), page.locator("#film").click()]);
  assert.equal(film.suggestedFilename(), "waves.webm");
  const stream = await film.createReadStream();
  let bytes = 0;
  for await (const piece of stream) {
    bytes += (piece as Buffer).length;
  }
  assert.ok(bytes > 10_000, `${bytes} bytes of film`);
});

test("a damaged frame and an empty result say what is wrong", async () => {
  writeFileSync(frameName(waves(), 7), "nonsense");
  const fresh = await openPage(browser, single.url);
  await fresh.locator('input[aria-label="Frame"]').fill("7");
  await fresh.waitForFunction(() => document.querySelector(".message")?.textContent?.includes("00007.bin is broken"));
  await fresh.screenshot({ path: join(pictures, "broken.png") });
  await fresh.close();
  const empty = join(folder, "empty");
  makeResult({ folder: empty, cells: 2, frames: 0, ended: false });
  const served = await serve(empty);
  const nothing = await openPage(browser, served.url);
  const told = await nothing.locator(".message").textContent();
  assert.match(told ?? "", /nothing to show yet: it has no frames, and no run is writing/);
  await nothing.close();
  served.stop();
});

test("no request leaves the machine, and the page keeps to its policy", async () => {
  const watched = await browser.newPage();
  const hosts = new Set<string>();
  const complaints: string[] = [];
  watched.on("request", (request) => hosts.add(new URL(request.url()).host));
  watched.on("console", (message) => {
    if (message.type() === "error") {
      complaints.push(message.text());
    }
  });
  await watched.goto(single.url);
  await watched.locator("#coloring").selectOption("field:strain");
  await watched.locator("output").waitFor();
  hosts.delete("");
  assert.deepEqual([...hosts], [new URL(single.url).host]);
  assert.deepEqual(complaints, []);
  await watched.close();
});
