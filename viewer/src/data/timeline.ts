// From times to frames and back.

/** Times that grow: those of frames that cannot be read are put evenly between their neighbours. */
export function steadyTimes(times: (number | null)[]): number[] {
  const steady: number[] = [];
  for (let k = 0; k < times.length; k++) {
    const known = times[k];
    const before = k === 0 ? 0 : steady[k - 1];
    if (known !== null && Number.isFinite(known) && (k === 0 || known >= before)) {
      steady.push(known);
      continue;
    }
    const next = times.findIndex((time, j) => j > k && time !== null && time >= before);
    const after = next < 0 ? before + spacing(steady) : (times[next] as number);
    const missing = next < 0 ? 1 : next - k + 1;
    steady.push(before + (after - before) / missing);
  }
  return steady;
}

function spacing(times: number[]): number {
  const count = times.length;
  return count < 2 ? 1 : times[count - 1] - times[count - 2] || 1;
}

/** The last frame not later than `time`; the first for earlier times, -1 without frames. */
export function frameAt(times: readonly number[], time: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return Math.max(low - 1, Math.min(0, times.length - 1));
}

/** Seconds of film a second of simulation takes at speed 1: real time, unless that is too short or too long to look at. */
export function naturalPace(times: readonly number[]): number {
  const count = times.length;
  const duration = count > 0 ? times[count - 1] - times[0] : 0;
  if (!(duration > 0)) {
    return 1;
  }
  const atThirty = (count - 1) / 30;
  const isWatchable = duration >= 1 && duration <= 120 && atThirty <= 4 * duration;
  return isWatchable ? 1 : Math.max(atThirty, 0.5) / duration;
}

/** As few digits as tell neighbouring times apart. */
export function decimals(times: readonly number[]): number {
  const count = times.length;
  const step = count > 1 ? (times[count - 1] - times[0]) / (count - 1) : 1;
  return step > 0 ? Math.min(6, Math.max(2, Math.ceil(-Math.log10(step) - 1e-9))) : 2;
}
