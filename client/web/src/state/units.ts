import type { ModelDescription } from '../generated/surfcast_pb';
import { systemFacts, type Unit } from './wkt';

/** Units of length, as the page writes them. */

export interface LengthUnit {
  readonly symbol: string;
  readonly metres: number | undefined; // undefined: a unit the page does not know
}

const metres: Readonly<Record<string, number>> = {
  nm: 1e-9, µm: 1e-6, mm: 1e-3, cm: 1e-2, m: 1, km: 1e3, in: 0.0254, ft: 0.3048,
};

/** Symbols by names, as files and systems write them. */
const symbols: Readonly<Record<string, string>> = {
  nanometre: 'nm', um: 'µm', μm: 'µm', micron: 'µm', micrometre: 'µm', millimetre: 'mm', centimetre: 'cm',
  metre: 'm', kilometre: 'km', inch: 'in', foot: 'ft', feet: 'ft', 'us survey foot': 'ftUS', degree: '°',
};

/** "mm" of "millimeters"; a name that is not known stays what it is. */
function symbolOf(name: string): string {
  const plain = name.trim().toLowerCase().replace(/meter/, 'metre');
  const singular = plain.replace(/(metre|micron|degree)s$/, '$1');
  return symbols[singular] ?? (metres[plain] === undefined ? name.trim() : plain);
}

/** "m"; empty for a unit that is not known. */
export const unitSymbol = (unit: Unit | undefined): string => (unit ? symbolOf(unit.name) : '');

function statedUnit(text: string): LengthUnit | undefined {
  const symbol = symbolOf(text);
  return symbol === '' ? undefined : { symbol, metres: metres[symbol] };
}

/** The unit of a model's world coordinates: that of its system, or what the files of its volumes state. */
export function lengthUnitOf({ system, volumes, ellipsoids }: ModelDescription): LengthUnit | undefined {
  const unit = system && systemFacts(system.wkt).horizontal;
  if (unit) return unit.kind === 'length' ? { symbol: unitSymbol(unit), metres: unit.size } : undefined;
  const stated = [...volumes, ...ellipsoids].find(({ lengthUnit }) => lengthUnit !== '');
  return stated && statedUnit(stated.lengthUnit);
}
