import type { ModelDescription } from '../generated/surfcast_pb';

/** Several models in one view: their names, with plus signs between them, are the name of one model. */

const most = 64; // that the server shows together

/** The names of the models in the view. A model whose own name has a plus sign is one. */
export function membersOf(name: string | undefined, description: ModelDescription | undefined): readonly string[] {
  if (name === undefined) return [];
  const members = description?.members ?? [];
  return members.length > 0 ? members.map(({ model }) => model) : [name];
}

/** Whether a model can be shown beside those of the view. */
export const canJoin = (members: readonly string[], name: string): boolean =>
  members.length > 0 && members.length < most && ![...members, name].some((each) => each.includes('+'));

export const withMember = (members: readonly string[], name: string): string => [...members, name].join('+');

export const withoutMember = (members: readonly string[], name: string): string =>
  members.filter((member) => member !== name).join('+');

/** The models that are not hidden, under one name; all of them, if every one is hidden. */
export function shownName(members: readonly string[], hidden: readonly string[]): string {
  const shown = members.filter((member) => !hidden.includes(member));
  return (shown.length > 0 ? shown : members).join('+');
}

/** Two models of the view, one on each side of a vertical line. */
export interface Swipe {
  readonly left: string;
  readonly right: string;
}

/** The models that are hidden on a side of the line. Without a line both sides show the same. */
export const hiddenAt = (side: keyof Swipe, hidden: readonly string[], swipe: Swipe | undefined): readonly string[] =>
  swipe ? [...hidden, side === 'left' ? swipe.right : swipe.left] : hidden;

/** Whether the server has a model of this name, or all that it joins. */
export const isServed = (name: string, models: readonly string[]): boolean =>
  models.includes(name) || name.split('+').every((member) => models.includes(member));
