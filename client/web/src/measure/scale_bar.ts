import type { LengthUnit } from '../state/units';
import { formatNumber } from './format';

/** A bar of a round length beside the picture. */
export interface ScaleBar {
  readonly pixels: number;
  readonly label: string; // "20 m"
}

const metricSteps = [
  ['km', 1e3],
  ['m', 1],
  ['cm', 1e-2],
  ['mm', 1e-3],
  ['µm', 1e-6],
  ['nm', 1e-9],
] as const;

/** The largest of 1, 2 and 5 times a power of ten that is not above a length. */
export function roundLength(most: number): number {
  const power = Math.floor(Math.log10(most));
  const part = [5, 2].find((factor) => Number(`${factor}e${power}`) <= most) ?? 1;
  return Number(`${part}e${power}`); // the nearest double, which a product would not always be
}

const isMetric = ({ metres }: LengthUnit): boolean =>
  metres !== undefined && Math.abs(Math.log10(metres) - Math.round(Math.log10(metres))) < 1e-9;

function labelOf(length: number, symbol: string): string {
  const decimals = Math.max(0, -Math.floor(Math.log10(length)));
  return `${formatNumber(length, decimals)} ${symbol}`;
}

function metricLabel(length: number): string {
  const fitting = metricSteps.find(([, each]) => length >= each * (1 - 1e-9));
  const [symbol, size] = fitting ?? metricSteps[metricSteps.length - 1]!;
  return labelOf(Number((length / size).toPrecision(1)), symbol);
}

/**
 * `unitPixels`: how long a unit of the model is on the screen, across the view and at the depth that the bar is for.
 * Undefined where no bar of at most so many pixels can be stated.
 */
export function scaleBar(unitPixels: number, unit: LengthUnit, mostPixels: number): ScaleBar | undefined {
  const most = mostPixels / unitPixels;
  if (!(most > 1e-12 && most < 1e12)) return undefined;
  if (!isMetric(unit)) {
    const length = roundLength(most);
    return { pixels: length * unitPixels, label: labelOf(length, unit.symbol) };
  }
  const length = roundLength(most * unit.metres!);
  return { pixels: (length / unit.metres!) * unitPixels, label: metricLabel(length) };
}
