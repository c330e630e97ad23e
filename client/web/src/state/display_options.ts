import type { Box } from '../camera/standard_views';
import { defaultPlain, type Choice, type PlainOptions } from '../generated/plain_options';
import type { IsoSurface, Slice } from '../volume/surfaces';
import { defaultTransfer, type Transfer } from '../volume/transfer';
import { defaultGlyphs, type GlyphOptions, type Lighting } from './glyph_options';

/** The last three are of ellipsoids. */
export const colorSources = [
  ...(['rgb', 'intensity', 'elevation', 'classification', 'normal'] as const),
  ...(['direction', 'dec', 'attribute'] as const),
] as const;
export type ColorSourceName = (typeof colorSources)[number];

export type ColorMapName = Choice<'colorMap'>;

/** A factor of the opacities of a class. */
export interface ClassOpacity {
  readonly code: number;
  readonly opacity: number; // 0 to 1
}

export interface Clip {
  readonly box: Box;
  readonly inverted: boolean; // hides the points inside
}

/** How the model is shown, apart from the camera: plain options, and those with a structure. */
export interface DisplayOptions extends PlainOptions {
  readonly source: ColorSourceName;
  readonly attribute: string; // of the source 'attribute'
  readonly map: ColorMapName;
  readonly range: readonly [number, number] | undefined; // undefined: the model's own
  readonly hiddenClasses: readonly number[];
  readonly hiddenModels: readonly string[]; // of several that are shown together
  readonly clips: readonly Clip[];
  readonly eyeDome: { readonly strength: number; readonly radius: number }; // strength 0: off
  readonly transfer: Transfer; // of volumes
  readonly surfaces: readonly IsoSurface[]; // of volumes
  readonly slices: readonly Slice[]; // of volumes
  readonly classOpacities: readonly ClassOpacity[]; // of surfels
  readonly upsideDown: boolean; // the model is shown with its vertical axis pointing the other way
  readonly glyphs: GlyphOptions; // ellipsoids
  readonly lighting: Lighting | undefined; // of ellipsoids; undefined: a headlight
}

export const defaultDisplay: DisplayOptions = {
  ...defaultPlain,
  source: 'rgb',
  attribute: 'fa',
  map: 'viridis',
  range: undefined,
  hiddenClasses: [],
  hiddenModels: [],
  clips: [],
  eyeDome: { strength: 0, radius: 1.5 },
  transfer: defaultTransfer,
  surfaces: [],
  slices: [],
  classOpacities: [],
  upsideDown: false,
  glyphs: defaultGlyphs,
  lighting: undefined,
};

/** Whether what the transfer function shows is drawn. */
export const showsMedium = ({ medium, surfaces, slices, transfer }: DisplayOptions): boolean =>
  medium ?? (transfer !== defaultTransfer || (surfaces.length === 0 && slices.length === 0));
