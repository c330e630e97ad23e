import type { ModelDescription } from '../generated/surfcast_pb';

const compact = new Intl.NumberFormat('en', { notation: 'compact', maximumFractionDigits: 1 });

const names: Readonly<Record<string, string>> = { surfel: 'points', gaussian: 'Gaussians' };

/** What a model holds, in one line: "1.2M points, volume of 512 × 512 × 300". */
export function contentsOf({ kinds, surfels, volumes }: ModelDescription): string {
  if (kinds.length === 0) return `${compact.format(Number(surfels))} points`; // of a server before 1.3
  const counted = kinds
    .filter(({ kind }) => kind !== 'grid')
    .map(({ kind, items }) => `${compact.format(Number(items))} ${names[kind] ?? kind}`);
  return [...counted, ...volumes.map(({ size }) => `volume of ${size.join(' × ')}`)].join(', ');
}
