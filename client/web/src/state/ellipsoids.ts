import type { EllipsoidDescription } from '../generated/surfcast_pb';
import type { GlyphRadiusName } from './glyph_options';

/** What the panels know of the ellipsoids of a model. */

/** The attributes that some of the sources have, in the order in which they come. */
export const attributeNames = (sources: readonly EllipsoidDescription[]): string[] => [
  ...new Set(sources.flatMap(({ ranges }) => ranges.map(({ attribute }) => attribute))),
];

/** The smallest and the largest value of an attribute; from 0 to 1 if there is none. */
export function attributeRange(
  sources: readonly EllipsoidDescription[],
  attribute: string,
): readonly [number, number] {
  const found = sources.flatMap(({ ranges }) => ranges.filter((range) => range.attribute === attribute));
  if (found.length === 0) return [0, 1];
  return [Math.min(...found.map(({ smallest }) => smallest)), Math.max(...found.map(({ largest }) => largest))];
}

/**
 * The semi-axis of a value, root or ratio of 1 of the first source; undefined if the server does not say it: one before
 * these fields.
 */
export function usualScale(sources: readonly EllipsoidDescription[], radius: GlyphRadiusName): number | undefined {
  const [source] = sources;
  if (!source) return undefined;
  const scale = { eigenvalue: source.scale, root: source.rootScale, unit: source.unitScale }[radius];
  return scale > 0 ? scale : undefined;
}
