import { TransferPreset, type VolumeDescription } from '../generated/surfcast_pb';
import { fitTo, rangeOf, type PresetName, type Transfer, type TransferPoint } from '../volume/transfer';
import { windowNow, withWindow, type Window, type Windowed } from '../volume/window';
import * as store from './store';

/** The volume of the open model, and its window and level. */

const numbers: Readonly<Record<PresetName, TransferPreset>> = {
  auto: TransferPreset.AUTO,
  gray: TransferPreset.GRAY,
  'ct-bone': TransferPreset.CT_BONE,
  'ct-soft': TransferPreset.CT_SOFT,
  mr: TransferPreset.MR,
};

export const openVolume = (): VolumeDescription | undefined => store.description.value?.volumes[0];

/** The points that the server uses: those chosen, or the preset's for this volume. */
export function pointsOf(transfer: Transfer, volume: VolumeDescription): readonly TransferPoint[] {
  if (transfer.points.length > 0) return transfer.points;
  const found = volume.presets.find(({ preset }) => preset === numbers[transfer.preset])?.points ?? [];
  const points = found.map(({ value, color, opacity }) => ({
    value,
    opacity,
    color: { red: color?.red ?? 0, green: color?.green ?? 0, blue: color?.blue ?? 0 },
  }));
  return transfer.range ? fitTo(points, rangeOf(points), transfer.range) : points;
}

/** What the window of the open volume is set of; undefined: there is no volume, or nothing is known of its presets. */
export function windowed(): Windowed | undefined {
  const volume = openVolume();
  if (!volume) return undefined;
  const { transfer } = store.display.value;
  const points = pointsOf(transfer, volume);
  return points.length > 0 ? { transfer, points, span: volume.high - volume.low } : undefined;
}

export function setWindow(of: Windowed, window: Window): void {
  store.display.value = { ...store.display.peek(), transfer: withWindow(of, window) };
}

/** One press of an arrow key, in hundredths of all values: wider to the right, brighter upwards. */
export function nudgeWindow(right: number, up: number): void {
  const of = windowed();
  if (!of) return;
  const { level, width } = windowNow(of);
  const part = of.span / 100;
  setWindow(of, { level: level - up * part, width: width + right * part });
}

/** Enough decimals to tell a thousandth of the range apart. */
export const decimalsFor = (span: number): number =>
  span > 0 ? Math.min(6, Math.max(0, Math.ceil(3 - Math.log10(span)))) : 3;

/** "Level 40, window 400 HU". */
export function windowText(): string {
  const of = windowed();
  if (!of) return '';
  const { level, width } = windowNow(of);
  const shown = (value: number): string => String(Number(value.toFixed(decimalsFor(of.span))));
  const unit = openVolume()?.sampleUnit;
  return `Level ${shown(level)}, window ${shown(width)}${unit ? ` ${unit}` : ''}`;
}
