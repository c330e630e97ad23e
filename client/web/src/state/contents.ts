import type { CoordinateSystem, KindCount, MemberDescription, ModelDescription } from '../generated/surfcast_pb';

const compact = new Intl.NumberFormat('en', { notation: 'compact', maximumFractionDigits: 1 });

const itemNames: Readonly<Record<string, string>> = {
  surfel: 'points',
  gaussian: 'Gaussians',
  ellipsoid: 'ellipsoids',
};
const kindNames: Readonly<Record<string, string>> = {
  surfel: 'Scan',
  grid: 'Volume',
  gaussian: 'Gaussians',
  ellipsoid: 'Ellipsoids',
};

/** The kinds of a model: "Volume", "Scan and Volume". */
export function kindOf({ kinds }: ModelDescription): string {
  const names = kinds.map(({ kind }) => kindNames[kind] ?? kind);
  return names.length > 0 ? names.join(' and ') : kindNames['surfel']!; // none: of a server before 1.3
}

/** What is drawn: a model, or scans that none was built of. */
export const originOf = ({ inPlace, members }: ModelDescription): string => {
  if (!inPlace) return members.length > 0 ? 'models' : 'a model';
  return members.length > 0 ? 'models, and scans in place' : 'the scan, in place';
};

/** The name of a coordinate system and its code, if it has one: "ETRS89 / UTM zone 32N (EPSG:25832)". */
export const systemName = ({ name, id }: CoordinateSystem): string => (id ? `${name} (${id})` : name);

/** The items of each kind but volumes: "1.2M points". */
const countsOf = (kinds: readonly KindCount[]): string[] =>
  kinds
    .filter(({ kind }) => kind !== 'grid')
    .map(({ kind, items }) => `${compact.format(Number(items))} ${itemNames[kind] ?? kind}`);

/** What one of several models holds, in one line: "1.2M points, volume". */
export const memberContents = ({ kinds }: MemberDescription): string =>
  [...countsOf(kinds), ...(kinds.some(({ kind }) => kind === 'grid') ? ['volume'] : [])].join(', ');

/** What a model holds, in one line: "1.2M points, volume of 512 × 512 × 300". */
export function contentsOf({ kinds, surfels, volumes }: ModelDescription): string {
  if (kinds.length === 0) return `${compact.format(Number(surfels))} points`; // of a server before 1.3
  return [...countsOf(kinds), ...volumes.map(({ size }) => `volume of ${size.join(' × ')}`)].join(', ');
}
