import type { JSX } from 'preact';
import { formatExact } from '../measure/format';
import { systemName } from '../state/contents';
import { glyphOf, linesOf } from '../state/glyph';
import { className } from '../state/palette';
import { description, inspection } from '../state/store';
import type { CoordinateSystem } from '../generated/surfcast_pb';
import { vectorFrom } from '../protocol/pictures';
import type { Vector } from '../camera/vector';
import { AnnotationForm } from './annotations';
import { copyText, notAllowed } from './clipboard';
import { IconButton } from './controls';
import { GlyphPicture } from './glyph_picture';

const coordinates = (v: Vector): string => [v.x, v.y, v.z].map(formatExact).join(' ');

function valueOf(attribute: string, value: number): string {
  return attribute === 'classification' ? `${value} · ${className(value)}` : formatExact(value);
}

const axes = ['x', 'y', 'z'] as const;

/** Coordinates of the source, where it has another system than the picture. */
function SourceCoordinates({ at, system }: { at: Vector; system: CoordinateSystem | undefined }): JSX.Element {
  return (
    <>
      {system && <p class="system">{systemName(system)}</p>}
      <dl class="coordinates">
        {axes.map((axis) => (
          <div key={axis}>
            <dt>
              <b class={`axis ${axis}`}>{axis.toUpperCase()}</b>
            </dt>
            <dd data-source-axis={axis}>{formatExact(at[axis])}</dd>
          </div>
        ))}
      </dl>
    </>
  );
}

/** All attributes of the clicked point. */
export function InspectCard(): JSX.Element | null {
  const shown = inspection.value;
  if (!shown) return null;
  const { result, at } = shown;
  const { color, normal } = result;
  const model = description.value;
  const source = result.sourcePosition && vectorFrom(result.sourcePosition);
  const glyph = glyphOf(result.attributes);
  const rows: [string, JSX.Element | string][] = glyph
    ? linesOf(result.attributes, ({ attribute, value }) => valueOf(attribute, value))
    : result.attributes.map(({ attribute, value }) => [attribute, valueOf(attribute, value)]);
  if (color) {
    const css = `rgb(${color.red}, ${color.green}, ${color.blue})`;
    rows.unshift([
      'colour',
      <>
        <i class="chip" style={{ background: css }} /> {color.red} {color.green} {color.blue}
      </>,
    ]);
  }
  if (normal) {
    const n = vectorFrom(normal);
    rows.push(['normal', [n.x, n.y, n.z].map((part) => part.toFixed(3)).join('  ')]);
  }
  if (result.model) rows.unshift(['model', result.model]);
  rows.push(['distance', result.distance.toPrecision(6)]);
  return (
    <section class="inspect-card" aria-label="Point">
      <header>
        <h2>Point</h2>
        <IconButton icon="copy" label="Copy coordinates" onPress={() => void copyText(coordinates(source ?? at), 'Coordinates copied.', notAllowed)} />
        <IconButton icon="close" label="Close" onPress={() => (inspection.value = undefined)} />
      </header>
      {glyph && <GlyphPicture glyph={glyph} color={color && [color.red, color.green, color.blue]} />}
      {model?.system && <p class="system">{systemName(model.system)}</p>}
      <dl class="coordinates">
        {axes.map((axis) => (
          <div key={axis}>
            <dt>
              <b class={`axis ${axis}`}>{axis.toUpperCase()}</b>
            </dt>
            <dd data-axis={axis}>{formatExact(at[axis])}</dd>
          </div>
        ))}
      </dl>
      {source && <SourceCoordinates at={source} system={model?.sourceSystem} />}
      <dl class="facts">
        {rows.map(([name, value]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
      <AnnotationForm at={at} />
    </section>
  );
}
