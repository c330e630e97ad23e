import type { Rgb } from './rgb';

/** The values of plain options, and their texts in links. What is missing or wrong is undefined. */
export type PlainValue = string | number | boolean | Rgb | undefined;

const numberOf = (text: string): number => (text.trim() === '' ? Number.NaN : Number(text));

/** `above`: the least value itself is none. */
export function numberIn(text: string | null, least: number, most: number, above: boolean): number | undefined {
  const value = numberOf(text ?? '');
  return Number.isFinite(value) && value <= most && (above ? value > least : value >= least) ? value : undefined;
}

export const choiceIn = <Name extends string>(names: readonly Name[], text: string | null): Name | undefined =>
  names.find((name) => name === text);

export const switchIn = (text: string | null): boolean | undefined =>
  text === 'on' ? true : text === 'off' ? false : undefined;

/** From 0 to 255 each: red, green and blue. */
export function colorIn(text: string | null): Rgb | undefined {
  const [red, green, blue, ...more] = (text ?? '').split(',').map(numberOf);
  const inByte = (part: number | undefined): part is number => Number.isInteger(part) && part! >= 0 && part! <= 255;
  return inByte(red) && inByte(green) && inByte(blue) && more.length === 0 ? { red, green, blue } : undefined;
}

function textOf(value: PlainValue): string | undefined {
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  if (typeof value === 'object') return `${value.red},${value.green},${value.blue}`;
  return value === undefined ? undefined : String(value);
}

/** The text of a value that is not the usual one. */
export function textUnless(value: PlainValue, usual: PlainValue): string | undefined {
  const text = textOf(value);
  return text === textOf(usual) ? undefined : text;
}
