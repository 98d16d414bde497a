// Results from the server of `koiter view`.

import type { Columns, Element, FrameData, Hand, Info, Range, Request, RunState, Source } from "./source";

/** The results that the server has. */
export async function serverSources(): Promise<Source[]> {
  const infos = (await json("api/results")) as Info[];
  return infos.map((info, index) => new ServerSource(info, `api/results/${index}`));
}

class ServerSource implements Source {
  constructor(
    readonly info: Info,
    private readonly address: string,
  ) {}

  async state(): Promise<RunState> {
    const state = (await json(`${this.address}/state`)) as RunState;
    // A run that had no frame yet when the page was opened had no fields either.
    if (this.info.fields.length === 0 && state.times.length > 0) {
      const number = Number(this.address.split("/").pop());
      const infos = (await json("api/results")) as Info[];
      this.info.fields = infos[number].fields;
    }
    return state;
  }

  async topology(): Promise<Uint32Array> {
    return new Uint32Array(await bytes(`${this.address}/topology`));
  }

  async frame(index: number, field: number | null): Promise<FrameData> {
    const query = field === null ? "" : `?field=${field}`;
    const numbers = new Float32Array(await bytes(`${this.address}/frames/${index}${query}`));
    const count = 3 * this.info.vertices;
    return {
      positions: numbers.subarray(0, count),
      values: field === null ? null : numbers.subarray(count),
    };
  }

  range(field: number): Promise<Range> {
    return json(`${this.address}/range?field=${field}`) as Promise<Range>;
  }

  history(element: Element): Promise<Columns> {
    const query = "vertex" in element ? `vertex=${element.vertex}` : `face=${element.face}`;
    return json(`${this.address}/history?${query}`) as Promise<Columns>;
  }

  stats(): Promise<Columns> {
    return json(`${this.address}/stats`) as Promise<Columns>;
  }

  probes(): Promise<Columns> {
    return json(`${this.address}/probes`) as Promise<Columns>;
  }

  async scene(): Promise<string> {
    return (await answer(`${this.address}/scene`)).text();
  }

  request(word: Request): Promise<void> {
    return this.post("request", word);
  }

  pull(hand: Hand | null): Promise<void> {
    return this.post("hand", hand === null ? "released" : [hand.vertex, ...hand.target].join(" "));
  }

  private async post(what: string, body: string): Promise<void> {
    const token = document.querySelector<HTMLMetaElement>('meta[name="koiter-token"]')?.content ?? "";
    await answer(`${this.address}/${what}`, { method: "POST", headers: { "X-Koiter-Token": token }, body });
  }
}

async function answer(address: string, init?: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(address, init);
  } catch {
    throw new Error("the server does not answer: has koiter view ended?");
  }
  if (!response.ok) {
    const told = (await response.json().catch(() => ({}))) as { error?: string };
    throw new Error(told.error ?? `the server answered with status ${response.status}`);
  }
  return response;
}

async function json(address: string): Promise<unknown> {
  return (await answer(address)).json();
}

async function bytes(address: string): Promise<ArrayBuffer> {
  return (await answer(address)).arrayBuffer();
}
