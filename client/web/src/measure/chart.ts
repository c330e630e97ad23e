import type { ProfilePoint } from './measurement';

/** Ticks of an axis: about `count` between two values. The step is 1, 2 or 5 times a power of ten. */
export function ticks(from: number, to: number, count: number): number[] {
  const span = to - from;
  if (!(span > 0)) return [from];
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= rough) ?? rough;
  const first = Math.ceil(from / step - 1e-9);
  const last = Math.floor(to / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * step);
}

export interface ChartFrame {
  readonly width: number;
  readonly height: number;
  readonly left: number;
  readonly bottom: number;
  readonly top: number;
  readonly right: number;
}

export interface Chart {
  readonly path: string; // SVG path data
  readonly dots: readonly { readonly x: number; readonly y: number }[];
  readonly x: (along: number) => number;
  readonly y: (height: number) => number;
  readonly alongTicks: readonly number[];
  readonly heightTicks: readonly number[];
}

/** Scales a profile, and other heights that it shows, to a frame. A flat profile gets a margin above and below. */
export function chartOf(profile: readonly ProfilePoint[], frame: ChartFrame, others: readonly number[] = []): Chart {
  const far = profile[profile.length - 1]?.along ?? 0;
  const heights = [...profile.map((point) => point.height), ...others];
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const air = high > low ? (high - low) * 0.08 : Math.max(far * 0.02, 1e-6);
  const [bottom, top] = [low - air, high + air];
  const x = (along: number): number => frame.left + ((frame.width - frame.left - frame.right) * along) / (far || 1);
  const y = (height: number): number =>
    frame.height - frame.bottom - ((frame.height - frame.bottom - frame.top) * (height - bottom)) / (top - bottom);
  const dots = profile.map((point) => ({ x: x(point.along), y: y(point.height) }));
  const path = dots.map((dot, i) => `${i === 0 ? 'M' : 'L'}${dot.x.toFixed(1)} ${dot.y.toFixed(1)}`).join('');
  return { path, dots, x, y, alongTicks: ticks(0, far, 4), heightTicks: ticks(bottom, top, 3) };
}
