import type { ColorMapName } from './display_options';

/** The server's colours (server/draw/render/color_maps.cpp), for legends. */

const maps: Readonly<Record<ColorMapName, readonly string[]>> = {
  viridis: ['440154', '472d7b', '3b528b', '2c728e', '21918c', '27ad81', '5ec962', 'aadc32', 'fde725'],
  turbo: [
    ...['30123b', '4145ab', '4675ed', '39a2fc', '1bcfd4', '24eca6', '61fc6c', 'a4fc3b'],
    ...['d1e834', 'f3c63a', 'fe9b2d', 'f36315', 'd93806', 'b11901', '7a0403'],
  ],
  gray: ['000000', 'ffffff'],
  terrain: ['1d5b4f', '3f8a55', '86b061', 'cfcf7d', 'dcb873', 'b98a58', '8e6a52', 'b3a69d', 'fafafa'],
};

export const gradientOf = (map: ColorMapName): string =>
  `linear-gradient(to right, ${maps[map].map((color) => `#${color}`).join(', ')})`;

/** Name and colour of the classes that the ASPRS names (LAS 1.4, table 17), by code. */
const classes: readonly (readonly [string, string])[] = [
  ['Never classified', '#8c8c8c'],
  ['Unclassified', '#b4b4b4'],
  ['Ground', '#a87b4f'],
  ['Low vegetation', '#a6cf5a'],
  ['Medium vegetation', '#5fab4a'],
  ['High vegetation', '#2a7a3d'],
  ['Building', '#e0603f'],
  ['Low point (noise)', '#ff2fd0'],
  ['Model key point', '#d9a441'],
  ['Water', '#2f7fe0'],
  ['Rail', '#7a5ea8'],
  ['Road surface', '#5d6470'],
  ['Overlap', '#e8cf86'],
  ['Wire, guard', '#ffe14a'],
  ['Wire, conductor', '#ffb52e'],
  ['Transmission tower', '#9b4fd1'],
  ['Wire connector', '#c58af0'],
  ['Bridge deck', '#3fc1c9'],
  ['High noise', '#ff4040'],
  ['Overhead structure', ''],
  ['Ignored ground', ''],
  ['Snow', ''],
  ['Temporal exclusion', ''],
];

export const className = (code: number): string => classes[code]?.[0] ?? (code < 64 ? 'Reserved' : 'User defined');

/** Colours of the other codes: hues that differ by the golden ratio. */
function spreadColor(code: number): string {
  const hue = 6 * ((code * 0.6180339887) % 1);
  const channel = (offset: number): number => {
    const x = Math.min(1, Math.max(0, Math.abs(((hue + offset) % 6) - 3) - 1));
    return Math.round(80 + 150 * x);
  };
  return `rgb(${channel(0)}, ${channel(4)}, ${channel(2)})`;
}

export const classColor = (code: number): string => classes[code]?.[1] || spreadColor(code);
