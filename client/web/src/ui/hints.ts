import type { Tool } from '../state/store';

const hints: Readonly<Record<Tool, readonly [string, string]>> = {
  navigate: ['', ''],
  inspect: ['Click a point to read it.', 'Click a point to read it.'],
  distance: ['Click the first point.', 'Click the next point. Enter or a double click ends.'],
  height: ['Click the lower or the upper point.', 'Click the other point.'],
  angle: ['Click three points; the second is the vertex.', 'Click the next point.'],
  area: ['Click the corners of the area.', 'Click the next corner. Enter or a double click ends.'],
  profile: ['Click the points of the profile.', 'Click the next point. Enter or a double click ends.'],
  clip: ['Click where the box should be.', 'Click where the box should be.'],
};

/** What to do now with the tool in hand. */
export function hintFor(tool: Tool, flying: boolean, begun: boolean): string {
  if (flying && tool === 'navigate') return 'Flying: W A S D, Q E down and up, drag to look, wheel sets the speed.';
  return hints[tool][begun ? 1 : 0];
}
