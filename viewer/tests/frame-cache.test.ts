import assert from "node:assert/strict";
import test from "node:test";
import { FrameCache } from "../src/data/frame-cache";

function frames(fetched: number[]) {
  return async (index: number) => {
    fetched.push(index);
    return { positions: new Float32Array(25).fill(index), values: null };
  };
}

test("frames used last are kept, up to the limit", async () => {
  const fetched: number[] = [];
  const cache = new FrameCache(frames(fetched), 350);
  for (const index of [0, 1, 2, 0, 3]) {
    assert.equal((await cache.get(index, null)).positions[0], index);
  }
  // Three of 100 bytes have room: 1 was used least lately and made way for 3.
  assert.equal(cache.size, 300);
  assert.equal(cache.peek(1, null), undefined);
  assert.notEqual(cache.peek(0, null), undefined);
  assert.deepEqual(fetched, [0, 1, 2, 3]);
});

test("a frame that is on its way is not fetched again, and fields are told apart", async () => {
  const fetched: number[] = [];
  const cache = new FrameCache(frames(fetched), 1000);
  await Promise.all([cache.get(5, null), cache.get(5, null), cache.get(5, 0)]);
  assert.deepEqual(fetched, [5, 5]);
  assert.equal(cache.pending, 0);
});

test("one frame larger than the limit is still kept, a failure is tried again", async () => {
  const cache = new FrameCache(frames([]), 10);
  await cache.get(1, null);
  assert.notEqual(cache.peek(1, null), undefined);
  let tries = 0;
  const failing = new FrameCache(() => {
    tries += 1;
    return Promise.reject(new Error("broken"));
  }, 10);
  await assert.rejects(failing.get(1, null));
  await assert.rejects(failing.get(1, null));
  assert.equal(tries, 2);
});

test("what was asked for before a clear is not kept", async () => {
  const cache = new FrameCache(frames([]), 1000);
  const coming = cache.get(1, null);
  cache.clear();
  await coming;
  assert.equal(cache.peek(1, null), undefined);
  assert.equal(cache.size, 0);
});
