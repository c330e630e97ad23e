import type { PaintedFrame } from './painter';

/** Where the time of one frame went, ms. */
export interface StageTimes {
  readonly wait: number; // in the server's queue
  readonly load: number; // reading and decoding blocks
  readonly draw: number;
  readonly encode: number;
  readonly network: number; // both ways, and what the server does not account for
  readonly decode: number;
  readonly paint: number;
}

export const stageNames = ['wait', 'load', 'draw', 'encode', 'network', 'decode', 'paint'] as const;
export type StageName = (typeof stageNames)[number];

export interface Figures {
  readonly framesPerSecond: number;
  readonly bytesPerSecond: number;
  readonly latency: number | undefined; // ms from asking to seeing, median of the recent frames
  readonly stages: StageTimes | undefined; // medians likewise
}

const within = 2000; // ms that count as recent
type ServerStage = 'wait' | 'load' | 'draw' | 'encode';
const byStage: Readonly<Record<string, ServerStage>> = { queue: 'wait', select: 'wait', load: 'load', encode: 'encode' };
/** Stages that happen while another one of the list does. */
const inside = new Set(['decode', 'upload']);

/** `asked`: when the update that the frame shows was sent (performance.now()); unknown for the first of a view. */
export function stagesOf(painted: PaintedFrame, asked: number | undefined): StageTimes {
  const sums = { wait: 0, load: 0, draw: 0, encode: 0 };
  for (const stage of painted.frame.picture?.stages ?? []) {
    if (inside.has(stage.name)) continue;
    const name = byStage[stage.name] ?? 'draw';
    sums[name] += stage.milliseconds;
  }
  const server = sums.wait + sums.load + sums.draw + sums.encode;
  return {
    ...sums,
    network: asked === undefined ? 0 : Math.max(0, painted.arrived - asked - server),
    decode: painted.decoded - painted.arrived,
    paint: painted.painted - painted.decoded,
  };
}

export function median(values: readonly number[]): number | undefined {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[sorted.length >> 1];
}

interface Entry {
  readonly at: number;
  readonly latency: number | undefined;
  readonly stages: StageTimes;
}

/** Keeps what the figures of the last two seconds need. Times are given, so that tests choose them. */
export class FigureCollector {
  private frames: Entry[] = [];
  private arrivals: { at: number; bytes: number }[] = [];
  private kept: Pick<Figures, 'latency' | 'stages'> = { latency: undefined, stages: undefined };

  bytes(count: number, now: number): void {
    this.arrivals.push({ at: now, bytes: count });
  }

  /** Only frames of a moving camera tell the latency: those at rest wait on purpose. */
  painted(frame: PaintedFrame, asked: number | undefined): void {
    const latency = asked === undefined || !frame.frame.moving ? undefined : frame.painted - asked;
    this.frames.push({ at: frame.painted, latency, stages: stagesOf(frame, asked) });
  }

  figures(now: number): Figures {
    this.frames = this.frames.filter((entry) => now - entry.at < within);
    this.arrivals = this.arrivals.filter((arrival) => now - arrival.at < within);
    const total = this.arrivals.reduce((sum, arrival) => sum + arrival.bytes, 0);
    this.keepLatency();
    return {
      framesPerSecond: this.rate(),
      bytesPerSecond: (total * 1000) / within,
      ...this.kept,
    };
  }

  /** At rest there is nothing to time; the panel goes on showing the last movement. */
  private keepLatency(): void {
    const timed = this.frames.filter((entry) => entry.latency !== undefined);
    if (timed.length === 0) return;
    const of = (name: StageName): number => median(timed.map((entry) => entry.stages[name])) ?? 0;
    const stages = Object.fromEntries(stageNames.map((name) => [name, of(name)])) as unknown as StageTimes;
    this.kept = { latency: median(timed.map((entry) => entry.latency ?? 0)), stages };
  }

  /** From the gaps between frames, so that it is right before two seconds have passed. */
  private rate(): number {
    const [first, last] = [this.frames[0], this.frames[this.frames.length - 1]];
    if (!first || !last || last.at <= first.at) return 0;
    return ((this.frames.length - 1) * 1000) / (last.at - first.at);
  }
}
