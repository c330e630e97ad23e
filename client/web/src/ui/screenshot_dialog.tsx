import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { cameraOf } from '../camera/pose';
import { FileFormat } from '../generated/surfcast_pb';
import { pictureOf, type Size } from '../protocol/pictures';
import { dialog, display, model, pose, showNotice, stageSize, upAxis } from '../state/store';
import { mediaType } from '../view/frame_decoder';
import { useActions, type Actions } from './actions';
import { Choices, Dialog, NumberField, Switch } from './controls';
import { saveFile } from './save_file';

const formats = [
  { value: 'png', label: 'PNG', wire: FileFormat.PNG },
  { value: 'jpg', label: 'JPEG', wire: FileFormat.JPEG },
  { value: 'webp', label: 'WebP', wire: FileFormat.WEBP },
  { value: 'exr', label: 'EXR', wire: FileFormat.EXR },
] as const;
type FormatName = (typeof formats)[number]['value'];

const maxPixels = 2 ** 25; // the server's own limit

/** Requests the picture from the server at its best quality. */
async function shoot(
  controller: Actions['controller'],
  size: Size,
  format: FormatName,
  every: boolean,
  started: (cancel: () => void) => void,
): Promise<void> {
  const name = model.peek() ?? '';
  const now = pose.peek();
  const wire = formats.find((each) => each.value === format)?.wire ?? FileFormat.PNG;
  const shown = every ? { ...display.peek(), spacing: 0 } : display.peek();
  const request = pictureOf(name, now && cameraOf(now, upAxis.peek(), display.peek().upsideDown), shown, size, wire);
  const picture = await controller.draw(request, started);
  saveFile(picture.data, `${name}.${format}`, mediaType(wire));
}

const presets: readonly (readonly [string, (stage: Size) => Size])[] = [
  ['As shown', (stage) => stage],
  ['Twice', (stage) => ({ width: stage.width * 2, height: stage.height * 2 })],
  ['Full HD', () => ({ width: 1920, height: 1080 })],
  ['4K', () => ({ width: 3840, height: 2160 })],
];

function Sizes({ size, onChange }: { size: Size; onChange: (size: Size) => void }): JSX.Element {
  const side = (value: number): number => Math.max(1, Math.round(value));
  return (
    <>
      <div class="button-row">
        {presets.map(([label, of]) => {
          const preset = of(stageSize.value);
          const pressed = preset.width === size.width && preset.height === size.height;
          return (
            <button key={label} type="button" aria-pressed={pressed} onClick={() => onChange(preset)}>
              {label}
            </button>
          );
        })}
      </div>
      <div class="range-fields">
        <NumberField
          label="Width"
          value={size.width}
          decimals={0}
          onChange={(width) => onChange({ ...size, width: side(width) })}
        />
        <NumberField
          label="Height"
          value={size.height}
          decimals={0}
          onChange={(height) => onChange({ ...size, height: side(height) })}
        />
      </div>
    </>
  );
}

export function ScreenshotDialog(): JSX.Element {
  const { controller } = useActions();
  const [size, setSize] = useState(stageSize.peek());
  const [format, setFormat] = useState<FormatName>('png');
  const [every, setEvery] = useState(true);
  const [cancel, setCancel] = useState<(() => void) | undefined>(undefined);
  const [problem, setProblem] = useState('');
  const tooLarge = size.width * size.height > maxPixels;
  const start = (): void => {
    setProblem('');
    shoot(controller, size, format, every, (give) => setCancel(() => give)).then(
      () => {
        showNotice('Picture saved.');
        dialog.value = undefined;
      },
      (error: unknown) => {
        setCancel(undefined);
        setProblem(error instanceof Error ? error.message : String(error));
      },
    );
  };
  return (
    <Dialog title="Save a picture" onClose={() => (dialog.value = undefined)}>
      <p class="faint">The server draws the view again at the size you choose.</p>
      <Sizes size={size} onChange={setSize} />
      <Choices label="Format" value={format} options={formats} onChange={setFormat} />
      <Switch label="Every point of the scan" checked={every} onChange={setEvery} />
      {tooLarge && <p class="problem">The server draws at most 33.5 million pixels.</p>}
      {problem && <p class="problem">{problem}</p>}
      <footer>
        {cancel ? (
          <button type="button" onClick={cancel}>
            <span class="spinner" /> Drawing… cancel
          </button>
        ) : (
          <button type="button" class="primary" disabled={tooLarge} onClick={start}>
            Save picture
          </button>
        )}
      </footer>
    </Dialog>
  );
}
