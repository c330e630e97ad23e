// Markers (ITU-T T.81, table B.1), without their first byte, which is 0xff.
const progressiveFrame = 0xc2;
const firstRestart = 0xd0;
const lastRestart = 0xd7;
const startOfFile = 0xd8;
const endOfFile = 0xd9;
const startOfScan = 0xda;
const lastFrequency = 63;

/** The marker at a place of a file, if both of its bytes are there. */
function markerAt(file: Uint8Array, at: number): number | undefined {
  return file[at] === 0xff ? file[at + 1] : undefined;
}

/** The parameters behind the marker at a place, if all of them are there. */
function segmentAt(file: Uint8Array, at: number): Uint8Array | undefined {
  const [high, low] = [file[at + 2], file[at + 3]];
  if (high === undefined || low === undefined) return undefined;
  const end = at + 2 + 256 * high + low;
  return end >= at + 4 && end <= file.length ? file.subarray(at + 4, end) : undefined;
}

/** Where the next marker begins: the data of a scan have none but restarts (T.81, B.1.1.5). */
function endOfScan(file: Uint8Array, from: number): number | undefined {
  for (let at = file.indexOf(0xff, from); at >= 0; at = file.indexOf(0xff, at + 1)) {
    const next = file[at + 1];
    if (next === undefined) return undefined;
    if (next !== 0 && (next < firstRestart || next > lastRestart)) return at;
  }
  return undefined;
}

/** Whether a scan has the highest frequency of a component (T.81, B.2.3). */
function hasAllOf(scan: Uint8Array, component: number): boolean {
  const components = scan[0] ?? 0;
  for (let i = 0; i < components; ++i) {
    if (scan[1 + 2 * i] === component) return scan[2 + 2 * components] === lastFrequency;
  }
  return false;
}

/**
 * How much of a progressive JPEG file can be shown before the rest has come: its complete scans, once the first
 * component (the brightness) has all frequencies, if roughly. Before that, the picture is less sharp than a frame in
 * motion. Bytes from the beginning. 0: nothing yet, or no progressive JPEG.
 */
export function showableBytes(begun: Uint8Array): number {
  if (markerAt(begun, 0) !== startOfFile) return 0;
  let brightness: number | undefined;
  let known = false;
  let complete = 0;
  for (let at = 2; ; ) {
    const marker = markerAt(begun, at);
    const segment = segmentAt(begun, at);
    if (marker === undefined || marker === endOfFile || !segment) return complete;
    at += 4 + segment.length;
    if (marker === progressiveFrame) brightness = segment[6]; // T.81, B.2.2
    if (marker !== startOfScan) continue;
    const end = endOfScan(begun, at);
    if (brightness === undefined || end === undefined) return complete;
    known ||= hasAllOf(segment, brightness);
    if (known) complete = end;
    at = end;
  }
}

/** These bytes of a JPEG file as a file without the scans that follow. */
export function endedAt(begun: Uint8Array, bytes: number): Uint8Array {
  const file = new Uint8Array(bytes + 2);
  file.set(begun.subarray(0, bytes));
  file.set([0xff, endOfFile], bytes);
  return file;
}
