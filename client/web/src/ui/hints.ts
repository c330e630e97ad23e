import type { Tool } from '../state/store';

const hints: Readonly<Record<Tool, readonly [string, string]>> = {
  navigate: ['', ''],
  inspect: ['Click a point to see its attributes.', 'Click a point to see its attributes.'],
  distance: ['Click the first point.', 'Click the next point. Finish with Enter or a double click.'],
  height: ['Click the lower or the upper point.', 'Click the other point.'],
  angle: ['Click three points; the second is the vertex.', 'Click the next point.'],
  area: ['Click the corners of the area.', 'Click the next corner. Finish with Enter or a double click.'],
  profile: ['Click the points of the profile.', 'Click the next point. Finish with Enter or a double click.'],
  clip: ['Click the centre of the new box.', 'Click the centre of the new box.'],
  window: ['Drag: window sideways, level up and down.', ''],
};

/** Instruction for the selected tool; `begun`: a measurement is in progress. */
export function hintFor(tool: Tool, flying: boolean, begun: boolean): string {
  if (flying && tool === 'navigate') return 'Flying: W A S D, Q E down and up, drag to look, wheel sets the speed.';
  return hints[tool][begun ? 1 : 0];
}
