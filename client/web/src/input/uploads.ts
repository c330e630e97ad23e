import { signal } from '@preact/signals';

/** Scans that the user has dropped on the page, on their way to the server. */

export interface Upload {
  readonly id: number;
  readonly name: string;
  readonly sent: number; // share, 0 to 1
  readonly state: 'sending' | 'done' | 'failed';
  readonly problem?: string;
  readonly model?: string; // under which the server has it
}

export const uploadList = signal<readonly Upload[]>([]);

/** What a server takes. */
export interface UploadRules {
  readonly maxBytes: bigint;
  readonly extensions: readonly string[];
}

/** Why a file is not sent; undefined: it is. */
export function refusal(file: { name: string; size: number }, rules: UploadRules): string | undefined {
  const name = file.name.toLowerCase();
  if (!rules.extensions.some((extension) => name.endsWith(extension))) {
    return `Not a scan by its name. This server takes ${rules.extensions.join(' ')}.`;
  }
  if (file.size === 0) return 'The file is empty.';
  if (BigInt(file.size) > rules.maxBytes) {
    return `Larger than the ${Number(rules.maxBytes / 1048576n)} MiB that this server takes.`;
  }
  return undefined;
}

/** The message of an answer that is not a success. */
export function problemOf(status: number, text: string): string {
  try {
    const { error } = JSON.parse(text) as { error?: { message?: string } };
    if (error?.message) return error.message;
  } catch {
    // Not the server's own words: a proxy's.
  }
  return status > 0 ? `The server answered ${status}.` : 'The connection was lost.';
}

/** The name of the model in the answer to a file that has arrived; undefined: it holds the samples of another file. */
export function modelOf(text: string): string | undefined {
  return (JSON.parse(text) as { model?: string }).model;
}

/** Headers whose samples are in other files, and meshes, whose materials and pictures are. */
const detached = ['.nhdr', '.mhd', '.hdr', '.hdr.gz', '.obj', '.gltf', '.ply'];

/** The order in which files are sent: what a header names is there before it. */
export function inOrder<File extends { readonly name: string }>(files: readonly File[]): readonly File[] {
  const isHeader = ({ name }: File): boolean => detached.some((extension) => name.toLowerCase().endsWith(extension));
  return [...files.filter((file) => !isHeader(file)), ...files.filter(isHeader)];
}

const atOnce = 1; // so that the first scan is there soon

/** Sends files one after another. */
export class Uploader {
  private nextId = 1;
  private readonly waiting: { id: number; file: File }[] = [];
  private readonly running = new Map<number, XMLHttpRequest>();

  /** `arrived` is called after each file that the server has. */
  constructor(private readonly arrived: () => void) {}

  add(files: readonly File[], rules: UploadRules): void {
    for (const file of inOrder(files)) {
      const id = this.nextId++;
      const problem = refusal(file, rules);
      const upload: Upload = { id, name: file.name, sent: 0, state: problem ? 'failed' : 'sending' };
      uploadList.value = [...uploadList.value, problem ? { ...upload, problem } : upload];
      if (!problem) this.waiting.push({ id, file });
    }
    this.next();
  }

  /** Takes an upload off the list, and ends it. */
  remove(id: number): void {
    uploadList.value = uploadList.value.filter((upload) => upload.id !== id);
    const place = this.waiting.findIndex((each) => each.id === id);
    if (place >= 0) this.waiting.splice(place, 1);
    this.running.get(id)?.abort();
  }

  private next(): void {
    if (this.running.size >= atOnce) return;
    const first = this.waiting.shift();
    if (first) this.send(first.id, first.file);
  }

  private send(id: number, file: File): void {
    const request = new XMLHttpRequest();
    this.running.set(id, request);
    request.upload.onprogress = ({ loaded, total }) => change(id, { sent: total > 0 ? loaded / total : 0 });
    request.onloadend = () => {
      this.running.delete(id);
      const { status } = request;
      if (status === 201) {
        const model = modelOf(request.responseText);
        change(id, { sent: 1, state: 'done', ...(model === undefined ? {} : { model }) });
        this.arrived();
      } else {
        change(id, { state: 'failed', problem: problemOf(status, request.responseText) });
      }
      this.next();
    };
    request.open('PUT', `api/uploads/${encodeURIComponent(file.name)}`);
    request.send(file);
  }
}

function change(id: number, changes: Partial<Upload>): void {
  uploadList.value = uploadList.value.map((upload) => (upload.id === id ? { ...upload, ...changes } : upload));
}

/** Takes files that are dropped anywhere on the page. `over` tells whether some are held over it. */
export function acceptDrops(
  rules: () => UploadRules | undefined,
  over: (held: boolean) => void,
  dropped: (files: readonly File[], rules: UploadRules) => void,
): void {
  const holds = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;
  addEventListener('dragover', (event) => {
    if (!holds(event)) return;
    event.preventDefault(); // the browser would open the file
    over(rules() !== undefined);
  });
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) over(false);
  });
  addEventListener('drop', (event) => {
    if (!holds(event)) return;
    event.preventDefault();
    over(false);
    const allowed = rules();
    if (allowed) dropped([...(event.dataTransfer?.files ?? [])], allowed);
  });
}
