import { median } from './figures';

const scales = [1, 0.75, 0.5]; // factors on width and height
const inTime = 12; // ms, of the 16.7 between two pictures of a display
const easily = 7; // ms; what takes no longer is no reason for a smaller picture
const toLower = 3; // samples
const toRaise = 8;
const measuredEvery = 4; // warps: to measure one is to wait for it

/**
 * Chooses the resolution of warps in motion, so that they are drawn in time for the display where graphics are slow, or
 * in software. The time of a warp grows with its pixels.
 */
export class WarpResolution {
  private at = 0;
  private warps = 0;
  private samples: number[] = []; // ms of warps at the present scale

  get scale(): number {
    return scales[this.at]!;
  }

  /** Whether the time of the next warp should be recorded. To be called once for each. */
  measuresNext(): boolean {
    return this.warps++ % measuredEvery === 0;
  }

  /** The milliseconds of a warp that was drawn at the present scale. */
  record(milliseconds: number): void {
    this.samples.push(milliseconds);
    if (this.samples.length >= toLower && this.expected(toLower, this.scale) > inTime) {
      const fits = scales.findIndex((scale, i) => i > this.at && this.expected(toLower, scale) <= inTime);
      this.goTo(fits < 0 ? scales.length - 1 : fits);
    } else if (this.samples.length >= toRaise) {
      const larger = scales[this.at - 1];
      if (larger !== undefined && this.expected(toRaise, larger) < easily) this.goTo(this.at - 1);
      else this.samples = this.samples.slice(-toRaise + 1);
    }
  }

  /** Milliseconds of a warp at a scale, by the last samples, of which there must be some. */
  private expected(samples: number, scale: number): number {
    return median(this.samples.slice(-samples))! * (scale / this.scale) ** 2;
  }

  private goTo(at: number): void {
    this.at = at;
    this.samples = [];
  }
}
