import type { PaintedFrame } from './frame_decoder';

/** Duration of the stages of one frame, ms. */
export interface StageTimes {
  readonly wait: number; // in the server's queue
  readonly load: number; // reading and decoding blocks
  readonly draw: number;
  readonly encode: number;
  readonly network: number; // both ways, and server time outside of its stages
  readonly decode: number;
  readonly paint: number;
}

export const stageNames = ['wait', 'load', 'draw', 'encode', 'network', 'decode', 'paint'] as const;
export type StageName = (typeof stageNames)[number];

export interface Figures {
  readonly framesPerSecond: number;
  readonly bytesPerSecond: number;
  readonly latency: number | undefined; // ms from sending an update to painting its frame, median of recent frames
  readonly stages: StageTimes | undefined; // medians of recent frames
}

const within = 2000; // ms; older frames are not recent
type ServerStage = 'wait' | 'load' | 'draw' | 'encode';
const byStage: Readonly<Record<string, ServerStage>> = { queue: 'wait', select: 'wait', load: 'load', encode: 'encode' };
/** Stages contained in another stage. */
const inside = new Set(['decode', 'upload']);

/** `asked`: send time of the update that the frame shows (performance.now()); unknown for the first frame of a view. */
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

/** Collects the performance figures of the last two seconds. The caller passes times, so that tests can choose them. */
export class FigureCollector {
  private frames: Entry[] = [];
  private arrivals: { at: number; bytes: number }[] = [];
  private kept: Pick<Figures, 'latency' | 'stages'> = { latency: undefined, stages: undefined };

  bytes(count: number, now: number): void {
    this.arrivals.push({ at: now, bytes: count });
  }

  /** Latency is measured on moving frames only, because frames at rest are delayed on purpose. */
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

  /** At rest there is no new measurement, so the figures of the last movement stay. */
  private keepLatency(): void {
    const timed = this.frames.filter((entry) => entry.latency !== undefined);
    if (timed.length === 0) return;
    const of = (name: StageName): number => median(timed.map((entry) => entry.stages[name])) ?? 0;
    const stages = Object.fromEntries(stageNames.map((name) => [name, of(name)])) as unknown as StageTimes;
    this.kept = { latency: median(timed.map((entry) => entry.latency ?? 0)), stages };
  }

  /** Frame rate from the intervals between frames, so that it is correct before two seconds have passed. */
  private rate(): number {
    const [first, last] = [this.frames[0], this.frames[this.frames.length - 1]];
    if (!first || !last || last.at <= first.at) return 0;
    return ((this.frames.length - 1) * 1000) / (last.at - first.at);
  }
}
