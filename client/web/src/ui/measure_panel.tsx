import type { JSX } from 'preact';
import { clear, finish, remove, undoPoint } from '../measure/measurement_list';
import { csvOf, geoJsonOf } from '../measure/export';
import { formatExact, linesOf } from '../measure/format';
import { isWhole, measureKinds, type MeasureKind, type Measurement } from '../measure/measurement';
import { chooseTool } from '../input/keyboard';
import { growing, lengthDecimals, measurements, model, tool, upAxis } from '../state/store';
import { copyText, notAllowed } from './clipboard';
import { IconButton, Section } from './controls';
import { Icon } from './icons';
import { ProfileChart } from './profile_chart';
import { saveFile } from './save_file';

export const measureLabels: Readonly<Record<MeasureKind, string>> = {
  distance: 'Distance',
  height: 'Height',
  angle: 'Angle',
  area: 'Area',
  profile: 'Profile',
};

function Kinds(): JSX.Element {
  return (
    <div class="kinds" role="group" aria-label="Kind of measurement">
      {measureKinds.map((kind) => (
        <button key={kind} type="button" aria-pressed={tool.value === kind} onClick={() => chooseTool(kind)}>
          <Icon name={kind} />
          <span>{measureLabels[kind]}</span>
        </button>
      ))}
    </div>
  );
}

function copy(m: Measurement): Promise<void> {
  const points = m.points.map((p) => [p.x, p.y, p.z].map(formatExact).join('\t'));
  const lines = linesOf(m, upAxis.value, lengthDecimals.value).map(({ name, value }) => `${name}\t${value}`);
  const text = [measureLabels[m.kind], ...lines, ...points].join('\n');
  return copyText(text, 'Measurement copied.', notAllowed);
}

function Card({ m, number }: { m: Measurement; number: number }): JSX.Element {
  const open = m.id === growing.value;
  const lines = linesOf(m, upAxis.value, lengthDecimals.value);
  return (
    <li class={open ? 'card open' : 'card'} data-kind={m.kind}>
      <header>
        <Icon name={m.kind} size={18} />
        <h3>
          {measureLabels[m.kind]} <small>{number}</small>
        </h3>
        <IconButton icon="copy" label="Copy figures and points" onPress={() => void copy(m)} />
        <IconButton icon="trash" label="Remove" onPress={() => remove(m.id)} />
      </header>
      {lines.length === 0 && <p class="faint">{m.points.length === 1 ? '1 point' : `${m.points.length} points`} so far</p>}
      <dl>
        {lines.map(({ name, value }, i) => (
          <div key={name} class={i === 0 ? 'main' : ''}>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
      {m.kind === 'profile' && m.points.length >= 2 && <ProfileChart points={m.points} open={open} />}
      {open && (
        <footer>
          <button type="button" onClick={undoPoint}>
            <Icon name="undo" size={16} /> Undo point
          </button>
          <button type="button" class="primary" onClick={finish}>
            Done
          </button>
        </footer>
      )}
    </li>
  );
}

function Export(): JSX.Element {
  const name = `${model.value ?? 'model'}-measurements`;
  const geoJson = (): void =>
    saveFile(geoJsonOf(measurements.peek(), upAxis.peek(), model.peek() ?? ''), `${name}.geojson`, 'application/geo+json');
  const csv = (): void => saveFile(csvOf(measurements.peek(), upAxis.peek()), `${name}.csv`, 'text/csv');
  return (
    <div class="button-row" role="group" aria-label="Save all measurements">
      <button type="button" onClick={geoJson}>
        <Icon name="download" size={16} /> GeoJSON
      </button>
      <button type="button" onClick={csv}>
        <Icon name="download" size={16} /> CSV
      </button>
    </div>
  );
}

export function MeasurePanel(): JSX.Element {
  const list = measurements.value;
  const aside = list.length > 1 && (
    <button type="button" class="quiet" onClick={clear}>
      Remove all
    </button>
  );
  return (
    <>
      <Section title="Measure">
        <Kinds />
      </Section>
      <Section title="Results" aside={aside}>
        {list.length === 0 && <p class="faint">Choose a kind of measurement, then click points of the scan.</p>}
        {list.some(isWhole) && <Export />}
        <ul class="cards">
          {list.map((m, i) => (
            <Card key={m.id} m={m} number={i + 1} />
          ))}
        </ul>
      </Section>
    </>
  );
}
