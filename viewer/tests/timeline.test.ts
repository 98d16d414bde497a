import assert from "node:assert/strict";
import test from "node:test";
import { decimals, frameAt, naturalPace, steadyTimes } from "../src/data/timeline";
import { Player } from "../src/player";

test("the last frame not later than a time is shown", () => {
  const times = [0, 0.1, 0.2, 0.2, 0.5];
  assert.equal(frameAt(times, -1), 0);
  assert.equal(frameAt(times, 0.19), 1);
  assert.equal(frameAt(times, 0.2), 3);
  assert.equal(frameAt(times, 9), 4);
  assert.equal(frameAt([], 1), -1);
});

test("frames that cannot be read stand between their neighbours", () => {
  assert.deepEqual(steadyTimes([0, null, null, 3]), [0, 1, 2, 3]);
  assert.deepEqual(steadyTimes([0, 1, null]), [0, 1, 2]);
  assert.deepEqual(steadyTimes([0, 2, 1, 4]), [0, 2, 3, 4]);
  assert.deepEqual(steadyTimes([]), []);
});

test("real time is kept where it can be watched", () => {
  const even = (count: number, dt: number) => Array.from({ length: count }, (_, k) => k * dt);
  assert.equal(naturalPace(even(121, 1 / 60)), 1);
  // A hundredth of a second in 91 frames takes three seconds.
  assert.ok(Math.abs(naturalPace(even(91, 1 / 9000)) - 300) < 1e-9);
  assert.equal(naturalPace([0]), 1);
});

test("times are told as exactly as they differ", () => {
  assert.equal(decimals([0, 0.04, 0.08]), 2);
  assert.equal(decimals([0, 8e-4]), 4);
  assert.equal(decimals([0]), 2);
});

test("the clock runs, goes round, and steps by frames", () => {
  let changes = 0;
  const player = new Player(() => {
    changes += 1;
  });
  player.setTimes([0, 1, 2, 3]);
  player.play();
  player.tick(1000);
  assert.equal(player.time, 0);
  player.tick(1100);
  assert.ok(Math.abs(player.time - 0.1) < 1e-12);
  player.seek(2.99);
  player.tick(1200);
  assert.equal(player.time, 0);
  player.stepFrames(2);
  assert.deepEqual([player.time, player.isPlaying], [2, false]);
  player.stepFrames(9);
  assert.equal(player.time, 3);
  player.seek(-4);
  assert.equal(player.time, 0);
  assert.ok(changes > 4);
});
