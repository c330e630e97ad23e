import type { Vector } from '../camera/vector';

/** Saved views and annotations of a model that the server keeps: the document of `api/models/NAME/annotations`. */

/** Those of a link. They are kept as they are: another program may have written some that this page does not know. */
export type Parameters = Readonly<Record<string, string>>;

export interface KeptView {
  readonly name: string;
  readonly parameters: Parameters;
}

/** A text at a point, and a view of it. */
export interface Annotation {
  readonly text: string;
  readonly position: Vector;
  readonly parameters: Parameters;
}

export interface Kept {
  readonly views: readonly KeptView[];
  readonly annotations: readonly Annotation[];
}

export const longestText = 1000;
const format = 'surfcast-annotations';
const version = 1;

export function formatKept({ views, annotations }: Kept): string {
  const notes = annotations.map(({ text, position: { x, y, z }, parameters }) => ({
    text,
    position: [x, y, z],
    parameters,
  }));
  return JSON.stringify({ format, version, views, annotations: notes });
}

/** The document of the server, which has checked it. */
export function parseKept(text: string): Kept {
  const file = JSON.parse(text) as {
    views: readonly KeptView[];
    annotations: readonly { text: string; position: [number, number, number]; parameters: Parameters }[];
  };
  return {
    views: file.views,
    annotations: file.annotations.map(({ position: [x, y, z], ...rest }) => ({ ...rest, position: { x, y, z } })),
  };
}

/** The first words of a text, for where there is little room. */
export function shortened(text: string, most = 40): string {
  const line = text.split('\n', 1)[0]!.trim();
  return line.length > most ? `${line.slice(0, most - 1).trimEnd()}…` : line;
}
