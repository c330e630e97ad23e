import { formatPlace, parsePlace } from './place';

/** Named views of a model, and files of them. */

export interface SavedView {
  readonly name: string;
  readonly link: string; // the hash of a link: camera, display options and clip boxes
}

export interface ViewFile {
  readonly model: string;
  readonly views: readonly SavedView[];
}

export const longestName = 80;
export const mostViews = 500;
const format = 'surfcast-views';
const version = 1;

/** The parameters of a link, which are those of the server's pictures. */
export const parametersOf = (link: string): Record<string, string> =>
  Object.fromEntries(new URLSearchParams(link.split('?', 2)[1] ?? ''));

/** The link of parameters. What a link does not know is left out. */
export const linkOf = (parameters: Readonly<Record<string, string>>, model: string): string =>
  formatPlace(parsePlace(`#/${encodeURIComponent(model)}?${new URLSearchParams(parameters).toString()}`));

/** A file of the views of a model. */
export function formatViews({ model, views }: ViewFile): string {
  const entries = views.map(({ name, link }) => ({ name, parameters: parametersOf(link) }));
  return `${JSON.stringify({ format, version, model, views: entries }, undefined, 2)}\n`;
}

/** The name of a file of the views of a model. */
export const viewsFile = (model: string): string => `${model.replaceAll('/', '-')}-views.json`;

const quoted = (word: string): string => `'${word.replaceAll("'", "'\\''")}'`;

/** The command line, for a shell, that makes a film of a flight through the views of a file. */
export function filmCommand(page: Pick<Location, 'protocol' | 'host'>, model: string, file: string): string {
  const server = page.protocol === 'https:' ? `wss://${page.host}` : page.host;
  const film = file.replace(/-views\.json$/, '.mp4');
  return `surfcast render ${quoted(`${server}/${model}`)} --path ${quoted(file)} --output ${quoted(film)}`;
}

const isObject = (value: unknown): value is Record<string, unknown> =>
  typeof value === 'object' && value !== null && !Array.isArray(value);

/** Undefined without a camera. What a link does not know is left out. */
function viewIn(entry: unknown, model: string): SavedView | undefined {
  if (!isObject(entry) || typeof entry['name'] !== 'string' || !isObject(entry['parameters'])) return undefined;
  const name = entry['name'].trim().slice(0, longestName);
  const isText = (pair: [string, unknown]): pair is [string, string] => typeof pair[1] === 'string';
  const texts = Object.entries(entry['parameters']).filter(isText);
  const link = linkOf(Object.fromEntries(texts), model);
  return name !== '' && parsePlace(link).camera ? { name, link } : undefined;
}

/**
 * The views of a file, as views of a model; `of` is the model that the file names. Throws an error with a sentence if
 * the file is none of views, or if one of them is wrong.
 */
export function parseViews(text: string, model: string): { readonly of: string; readonly views: readonly SavedView[] } {
  let file: unknown;
  try {
    file = JSON.parse(text);
  } catch {
    throw new Error('The file is not JSON.');
  }
  if (!isObject(file) || file['format'] !== format || !Array.isArray(file['views'])) {
    throw new Error('The file has no views of Surfcast.');
  }
  if (file['version'] !== version) throw new Error('The file is of another version of Surfcast.');
  if (file['views'].length > mostViews) throw new Error(`The file has more than ${mostViews} views.`);
  const views = file['views'].map((entry, i) => {
    const view = viewIn(entry, model);
    if (!view) throw new Error(`View ${i + 1} of the file has no name or no camera.`);
    return view;
  });
  return { of: typeof file['model'] === 'string' ? file['model'] : model, views };
}

/** The name, or the name with the first number that no view has. */
function freeName(views: readonly SavedView[], name: string): string {
  const taken = new Set(views.map((view) => view.name));
  let free = name;
  for (let number = 2; taken.has(free); ++number) free = `${name} ${number}`;
  return free;
}

/** The name of a view for which the user has given none. */
export function usualName(views: readonly SavedView[]): string {
  let number = views.length + 1;
  while (views.some(({ name }) => name === `View ${number}`)) ++number;
  return `View ${number}`;
}

/** Adds views behind the others. Names stay unique; a view that is there already is not added again. */
export function withViews(views: readonly SavedView[], added: readonly SavedView[]): readonly SavedView[] {
  return added.reduce<readonly SavedView[]>((list, view) => {
    const known = list.some(({ name, link }) => name === view.name && link === view.link);
    return known ? list : [...list, { ...view, name: freeName(list, view.name) }];
  }, views);
}
