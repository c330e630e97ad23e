import type { JSX } from 'preact';
import { chooseTool } from '../input/keyboard';
import type { Choice } from '../generated/plain_options';
import type { DisplayOptions } from '../state/display_options';
import { description, display, hasSurfels, panel, tool } from '../state/store';
import { decimalsFor, openVolume, pointsOf, setWindow, windowed } from '../state/volume';
import type { PresetName, TransferPoint } from '../volume/transfer';
import { windowNow } from '../volume/window';
import { Choices, NumberField, optionsOf, Section, Switch } from './controls';
import { Opacity } from './opacity_section';
import { SliceSection, SurfaceSection } from './surface_sections';
import { TransferEditor } from './transfer_editor';

const change = (part: Partial<DisplayOptions>): void => void (display.value = { ...display.peek(), ...part });

const presetLabels: readonly { value: PresetName; label: string }[] = [
  { value: 'auto', label: 'Automatic' },
  { value: 'gray', label: 'Grey' },
  { value: 'ct-bone', label: 'CT bone' },
  { value: 'ct-soft', label: 'CT soft' },
  { value: 'mr', label: 'MR' },
];

/** Level and window as numbers, and the tool that drags them on the picture. */
function WindowFields(): JSX.Element | null {
  const of = windowed();
  if (!of) return null;
  const now = windowNow(of);
  const decimals = decimalsFor(of.span);
  const dragging = tool.value === 'window';
  const choose = (): void => {
    chooseTool(dragging ? 'navigate' : 'window');
    if (!dragging && innerWidth < 860) panel.value = undefined; // the panel lies over the picture
  };
  return (
    <div class="range-fields">
      <NumberField
        label="Level"
        value={now.level}
        decimals={decimals}
        onChange={(level) => setWindow(of, { ...now, level })}
      />
      <NumberField
        label="Window"
        value={now.width}
        decimals={decimals}
        onChange={(width) => setWindow(of, { ...now, width })}
      />
      <button type="button" class="quiet" aria-pressed={dragging} onClick={choose}>
        Drag on picture
      </button>
    </div>
  );
}

export function VolumeSections(): JSX.Element | null {
  const volume = openVolume();
  if (!volume) return null;
  const { transfer, shaded } = display.value;
  const own = transfer.points.length > 0;
  const set = (points: readonly TransferPoint[]): void => change({ transfer: { ...transfer, points } });
  return (
    <>
      <Section title={`Colour and opacity by value${volume.sampleUnit && `, ${volume.sampleUnit}`}`}>
        <Choices<PresetName | 'own'>
          label="Preset"
          value={own ? 'own' : transfer.preset}
          options={[...presetLabels, { value: 'own', label: 'Own', disabled: !own }]}
          onChange={(chosen) => {
            if (chosen !== 'own') change({ transfer: { preset: chosen, range: undefined, points: [] } });
          }}
        />
        <TransferEditor
          points={pointsOf(transfer, volume)}
          low={volume.low}
          high={volume.high}
          counts={volume.histogram.map(Number)}
          decimals={decimalsFor(volume.high - volume.low)}
          onChange={set}
        />
        <WindowFields />
        <Switch label="Light by gradient" checked={shaded ?? (transfer.preset === 'auto' && !own)} onChange={(on) => change({ shaded: on })} />
        {!hasSurfels() && <Opacity />}
      </Section>
      <SurfaceSection volume={volume} />
      <SliceSection size={volume.size} medium />
    </>
  );
}

const conventionLabels: Readonly<Record<Choice<'splatConvention'>, string>> = { trained: 'As trained', exact: 'Exact' };

export function GaussianSection(): JSX.Element | null {
  if (!description.value?.kinds.some(({ kind }) => kind === 'gaussian')) return null;
  return (
    <Section title="Gaussians">
      <Choices
        label="Convention"
        value={display.value.splatConvention}
        options={optionsOf(conventionLabels)}
        onChange={(splatConvention) => change({ splatConvention })}
      />
      {!openVolume() && !hasSurfels() && <Opacity />}
    </Section>
  );
}
