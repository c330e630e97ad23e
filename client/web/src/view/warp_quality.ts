import { median } from './figures';

/** How a warp in motion is drawn. */
export interface WarpQuality {
  readonly scale: number; // factor on width and height
  readonly coarse: boolean; // a third of the triangles
  readonly layered: boolean; // the last frame at rest is drawn over the newest one
}

export const bestQuality: WarpQuality = { scale: 1, coarse: false, layered: true };

/** Best first. docs/motion.md has their errors. */
const qualities: readonly WarpQuality[] = [
  bestQuality,
  { scale: 0.75, coarse: false, layered: true },
  { scale: 0.5, coarse: false, layered: true },
  { scale: 0.5, coarse: true, layered: true },
  { scale: 0.375, coarse: true, layered: true },
  { scale: 0.375, coarse: true, layered: false },
];
const last = qualities.length - 1;

/**
 * The time of the best quality is 1. Both layers have triangles and pixels: 10 and 36 ms on two cores without a GPU.
 */
export const costOf = ({ scale, coarse, layered }: WarpQuality): number =>
  (((coarse ? 3.5 : 10) + 36 * scale ** 2) / 46) * (layered ? 1 : 0.5);

const inTime = 12; // ms, of the 16.7 between two pictures of a display
const easily = 7; // ms; what takes no longer is no reason for a lower quality
const farTooLong = 24; // ms; two such warps in a row, not only one, are reason enough for a lower quality
const toLower = 3; // samples
const toRaise = 8;
const measuredEvery = 4; // warps, once the first ones of a quality are measured: to measure one is to wait for it

/**
 * Chooses the quality of warps in motion, so that they are drawn in time for the display where graphics are slow, or in
 * software.
 */
export class WarpQualityControl {
  private at = 0;
  private warps = 0;
  private samples: number[] = []; // ms of warps at the present quality

  get quality(): WarpQuality {
    return qualities[this.at]!;
  }

  /** Whether too few warps of the present quality have been measured to judge it. */
  get isUncertain(): boolean {
    return this.samples.length < toLower;
  }

  /** Whether the time of the next warp should be recorded. To be called once for each. */
  measuresNext(): boolean {
    return this.isUncertain || this.warps++ % measuredEvery === 0;
  }

  /** The milliseconds of a warp that was drawn at the present quality. `layered`: it had both layers. */
  record(milliseconds: number, layered: boolean): void {
    this.samples.push((milliseconds * costOf(this.quality)) / costOf({ ...this.quality, layered }));
    const fasterOfTwo = Math.min(...this.samples.slice(-2));
    if (this.samples.length >= 2 && fasterOfTwo > farTooLong) {
      this.goTo(this.affordable(fasterOfTwo));
    } else if (!this.isUncertain && this.typical(toLower) > inTime) {
      this.goTo(this.affordable(this.typical(toLower)));
    } else if (this.samples.length >= toRaise) {
      const rises = this.at > 0 && this.expected(this.typical(toRaise), this.at - 1) < easily;
      this.goTo(rises ? this.at - 1 : this.at);
    }
  }

  private typical(samples: number): number {
    return median(this.samples.slice(-samples))!;
  }

  /** Milliseconds of a warp of another quality, if those of the present one take so many. */
  private expected(milliseconds: number, other: number): number {
    return (milliseconds * costOf(qualities[other]!)) / costOf(this.quality);
  }

  /** The best quality below the present one, whose warps take so long, that is drawn in time. */
  private affordable(milliseconds: number): number {
    const fits = qualities.findIndex((_, i) => i > this.at && this.expected(milliseconds, i) <= inTime);
    return fits < 0 ? last : fits;
  }

  private goTo(at: number): void {
    this.samples = at === this.at ? this.samples.slice(-toRaise + 1) : [];
    this.at = at;
  }
}
