// Pictures and films of what the page shows.

/** How a film is taken: a picture at a time, in the rhythm of the film. */
export interface Taking {
  framesASecond: number;
  seconds: number;
  /** Shows what is seen at this share of the film. */
  show(share: number): Promise<void>;
  /** Whether the person has had enough. */
  isEnough(): boolean;
}

export function savePicture(canvas: HTMLCanvasElement, name: string): Promise<void> {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => {
      if (blob === null) {
        reject(new Error("the browser could not make the picture"));
        return;
      }
      save(blob, name);
      resolve();
    }, "image/png");
  });
}

/** The kinds of film that browsers record, the best first. */
const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

/** Records a film of the canvas, in the time that it takes to look at it. */
export async function recordFilm(canvas: HTMLCanvasElement, taking: Taking): Promise<Blob> {
  const kind = KINDS.find((candidate) => MediaRecorder.isTypeSupported(candidate));
  if (kind === undefined) {
    throw new Error("this browser records no films: koiter render makes one");
  }
  const stream = canvas.captureStream(0);
  const track = stream.getVideoTracks()[0] as CanvasCaptureMediaStreamTrack;
  const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: 12e6 });
  const pieces: Blob[] = [];
  recorder.ondataavailable = (event) => pieces.push(event.data);
  const stopped = new Promise<void>((resolve) => {
    recorder.onstop = () => resolve();
  });
  recorder.start();
  const count = Math.max(2, Math.round(taking.seconds * taking.framesASecond));
  const begin = performance.now();
  for (let k = 0; k < count && !taking.isEnough(); k++) {
    await taking.show(k / (count - 1));
    track.requestFrame();
    const due = begin + (1000 * (k + 1)) / taking.framesASecond;
    await new Promise((resolve) => setTimeout(resolve, Math.max(0, due - performance.now())));
  }
  recorder.stop();
  await stopped;
  track.stop();
  return new Blob(pieces, { type: kind.split(";")[0] });
}

export function save(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  // The download has begun by then.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export function fileName(title: string, ending: string): string {
  const plain = title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  return `${plain || "koiter"}.${ending}`;
}
