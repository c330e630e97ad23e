import type { Box } from '../camera/standard_views';
import { defaultTransfer, type Transfer } from '../volume/transfer';

export const colorSources = ['rgb', 'intensity', 'elevation', 'classification', 'normal'] as const;
export type ColorSourceName = (typeof colorSources)[number];

export const colorMaps = ['viridis', 'turbo', 'gray', 'terrain'] as const;
export type ColorMapName = (typeof colorMaps)[number];

export const splatConventions = ['trained', 'exact'] as const;
export type SplatConventionName = (typeof splatConventions)[number];

export interface Clip {
  readonly box: Box;
  readonly inverted: boolean; // hides the points inside
}

export interface Rgb {
  readonly red: number;
  readonly green: number;
  readonly blue: number;
}

/** How the model is shown, apart from the camera. */
export interface DisplayOptions {
  readonly source: ColorSourceName;
  readonly map: ColorMapName;
  readonly range: readonly [number, number] | undefined; // undefined: the model's own
  readonly hiddenClasses: readonly number[];
  readonly clips: readonly Clip[];
  readonly eyeDome: { readonly strength: number; readonly radius: number }; // strength 0: off
  readonly background: Rgb;
  readonly spacing: number; // projected surfel spacing at which refinement at rest stops, pixels; 0: every surfel
  readonly transfer: Transfer; // of volumes
  readonly shaded: boolean; // volumes are lit
  readonly splatConvention: SplatConventionName;
}

/** Slightly darker than the panels, so that the picture appears to be behind them. */
export const defaultBackground: Rgb = { red: 14, green: 18, blue: 22 };

export const defaultDisplay: DisplayOptions = {
  source: 'rgb',
  map: 'viridis',
  range: undefined,
  hiddenClasses: [],
  clips: [],
  eyeDome: { strength: 0, radius: 1.5 },
  background: defaultBackground,
  spacing: 1,
  transfer: defaultTransfer,
  shaded: false,
  splatConvention: 'trained',
};

export const toHex = (color: Rgb): string =>
  '#' + [color.red, color.green, color.blue].map((part) => part.toString(16).padStart(2, '0')).join('');

export function fromHex(text: string): Rgb {
  const value = Number.parseInt(text.slice(1), 16);
  return { red: (value >> 16) & 255, green: (value >> 8) & 255, blue: value & 255 };
}
