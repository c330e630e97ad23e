export interface Rgb {
  readonly red: number;
  readonly green: number;
  readonly blue: number;
}

export const toHex = (color: Rgb): string =>
  '#' + [color.red, color.green, color.blue].map((part) => part.toString(16).padStart(2, '0')).join('');

export function fromHex(text: string): Rgb {
  const value = Number.parseInt(text.slice(1), 16);
  return { red: (value >> 16) & 255, green: (value >> 8) & 255, blue: value & 255 };
}
