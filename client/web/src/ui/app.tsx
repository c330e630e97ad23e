import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';
import { chooseTool, togglePanel } from '../input/keyboard';
import { formatNumber } from '../measure/format';
import { gradientOf } from '../state/palette';
import * as store from '../state/store';
import { openVolume, windowText } from '../state/volume';
import { useActions } from './actions';
import { AnnotationCard } from './annotations';
import { ClipPanel } from './clip_panel';
import { IconButton } from './controls';
import { Gallery } from './gallery';
import { Gizmo } from './gizmo';
import { HelpDialog } from './help_dialog';
import { InspectCard } from './inspect_card';
import { DisplayPanel, mapped, mappedName, shownRange } from './display_panel';
import { MeasurePanel } from './measure_panel';
import { ModelPanel } from './model_panel';
import { Compass, CursorReadout, ScaleBar } from './orientation';
import { PointsDialog } from './points_dialog';
import { SavedViewsPanel } from './saved_views_panel';
import { ScreenshotDialog } from './screenshot_dialog';
import { StateCards } from './state_cards';
import { FiguresCard, Status } from './status';
import { hintFor } from './hints';
import { PhoneBar, ToolRail, panelNames } from './tool_rail';
import { SwipeLine } from './swipe_line';
import { TopBar } from './top_bar';
import { UploadsCard } from './uploads_card';

/** Inserts the canvases, which are created outside of the components. */
function Canvases(): JSX.Element {
  const { stage } = useActions();
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => host.current?.append(stage), []);
  return <div class="canvas-host" ref={host} />;
}

function Legend(): JSX.Element | null {
  const { source, map } = store.display.value;
  const name = mappedName(store.display.value);
  if (!mapped(source) || !store.shownFrame.value) return null;
  const [first, last] = shownRange();
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(Math.max(1e-9, last - first))));
  return (
    <figure class="legend" aria-label={`Colours of ${name}`}>
      <figcaption>{name}</figcaption>
      <span class="ramp" style={{ background: gradientOf(map) }} />
      <span class="ends">
        <span>{formatNumber(first, decimals)}</span>
        <span>{formatNumber(last, decimals)}</span>
      </span>
    </figure>
  );
}

function Hint(): JSX.Element | null {
  const tool = store.tool.value;
  const hint = hintFor(tool, store.flying.value, store.growing.value !== undefined);
  const text = store.notice.value ?? (tool === 'window' ? `${windowText()}. ${hint}` : hint);
  if (!text || !store.shownFrame.value) return null;
  return (
    <p class={store.notice.value ? 'hint said' : 'hint'} role="status">
      {text}
    </p>
  );
}

function Stage(): JSX.Element {
  return (
    <main class="stage" hidden={store.model.value === undefined || store.galleryOpen.value}>
      <Canvases />
      <SwipeLine />
      <div class="aids">
        <Gizmo />
        <Compass />
      </div>
      <Hint />
      <div class="foot">
        <div class="foot-left">
          <AnnotationCard />
          <InspectCard />
          <FiguresCard />
          <div class="foot-line">
            <Status />
            <CursorReadout />
          </div>
        </div>
        <div class="foot-right">
          <Legend />
          <ScaleBar />
        </div>
      </div>
    </main>
  );
}

const panels: Readonly<Record<store.Panel, () => JSX.Element | null>> = {
  look: DisplayPanel,
  measure: MeasurePanel,
  clip: ClipPanel,
  views: SavedViewsPanel,
  model: ModelPanel,
};

function SidePanel(): JSX.Element | null {
  const open = store.panel.value;
  if (!open || !store.description.value) return null;
  const Content = panels[open];
  return (
    <aside class="panel" aria-label={panelNames[open].label}>
      <nav class="tabs">
        {(Object.keys(panels) as store.Panel[]).map((name) => (
          <button
            key={name}
            type="button"
            aria-pressed={name === open}
            onClick={() => (store.panel.value = name)}
          >
            {panelNames[name].label}
          </button>
        ))}
        <IconButton icon="close" label="Close the panel" onPress={() => togglePanel(open)} />
      </nav>
      <div class="panel-content">
        <Content />
      </div>
    </aside>
  );
}

export function App(): JSX.Element {
  // Starting a measurement opens the panel with the results, if the window is wide enough.
  useEffect(
    () =>
      store.growing.subscribe((id) => {
        if (id !== undefined && innerWidth >= 860) store.panel.value = 'measure';
      }),
    [],
  );
  useEffect(() => {
    if (store.panel.value !== 'clip' && store.tool.peek() === 'clip') chooseTool('navigate');
  }, [store.panel.value]);
  // Another model may have no window.
  useEffect(() => {
    if (store.description.value && !openVolume() && store.tool.peek() === 'window') chooseTool('navigate');
  }, [store.description.value]);
  const shown = store.model.value !== undefined && !store.galleryOpen.value;
  return (
    <div class={shown && store.panel.value && store.description.value ? 'page with-panel' : 'page'}>
      <TopBar />
      {shown && <ToolRail />}
      <Stage />
      {shown && <SidePanel />}
      {shown && <PhoneBar />}
      <Gallery />
      <StateCards />
      <UploadsCard />
      {store.dialog.value === 'screenshot' && <ScreenshotDialog />}
      {store.dialog.value === 'points' && <PointsDialog />}
      {store.dialog.value === 'help' && <HelpDialog />}
    </div>
  );
}
