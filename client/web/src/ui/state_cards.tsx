import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { ScanStatus } from '../generated/surfcast_pb';
import { isServed } from '../state/joined';
import { failed, progressText } from '../state/scans';
import { galleryOpen, link, model, models, openScan, shownFrame, viewProblem } from '../state/store';
import { useActions } from './actions';

/** Cards shown instead of the picture, or over it, while the connection, the model or the first frame is missing. */

function useSecondsUntil(time: number): number {
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 250);
    return () => clearInterval(timer);
  }, []);
  return Math.max(0, Math.ceil((time - now) / 1000));
}

function Waiting({ until, message }: { until: number; message: string }): JSX.Element {
  const { controller } = useActions();
  const seconds = useSecondsUntil(until);
  return (
    <div class="banner" role="status">
      <span class="lamp offline" />
      <p>
        <b>{message}</b> Trying again {seconds > 0 ? `in ${seconds} s` : 'now'}.
      </p>
      <button type="button" onClick={() => controller.retry()}>
        Try now
      </button>
    </div>
  );
}

function Refused({ message }: { message: string }): JSX.Element {
  return (
    <div class="state-card" role="alert">
      <h2>This page and the server are not compatible</h2>
      <p class="message">{message}</p>
      <p class="faint">Reload the page to get the version that matches the server.</p>
      <button type="button" class="primary" onClick={() => location.reload()}>
        Reload the page
      </button>
    </div>
  );
}

function Problem({ message, again }: { message: string; again: boolean }): JSX.Element {
  const { controller } = useActions();
  const missing = model.value !== undefined && models.value !== undefined && !isServed(model.value, models.value);
  const title = again ? 'The server is busy' : missing ? 'No such model' : 'This view cannot be shown';
  return (
    <div class="state-card" role="alert">
      <h2>{title}</h2>
      <p class="message">{message}</p>
      {again && <p class="faint">The page retries automatically.</p>}
      <div class="button-row">
        <button type="button" onClick={() => controller.retry()}>
          Try again
        </button>
        <button type="button" class="primary" onClick={() => (galleryOpen.value = true)}>
          Show all models
        </button>
      </div>
    </div>
  );
}

function Loading({ text }: { text: string }): JSX.Element {
  return (
    <div class="loading" role="status">
      <span class="spinner" />
      <p>{text}</p>
    </div>
  );
}

/** The open scan has nothing to show yet, or never will. */
function ScanState({ scan }: { scan: ScanStatus }): JSX.Element {
  return (
    <div class="state-card" role={failed(scan) ? 'alert' : 'status'}>
      <h2>{failed(scan) ? `${scan.model} cannot be built` : `${scan.model} is being built`}</h2>
      {failed(scan) ? <p class="message">{scan.problem}</p> : <progress value={scan.done} />}
      {!failed(scan) && (
        <p class="faint">{progressText(scan)}. A preview appears here as soon as there is one.</p>
      )}
      <button type="button" onClick={() => (galleryOpen.value = true)}>
        Show all models
      </button>
    </div>
  );
}

export function StateCards(): JSX.Element | null {
  const state = link.value;
  if (state.kind === 'refused') return <Refused message={state.message} />;
  if (state.kind === 'waiting') return <Waiting until={state.until} message={state.message} />;
  if (model.value === undefined || galleryOpen.value) {
    return state.kind === 'connecting' && !models.value ? <Loading text="Connecting" /> : null;
  }
  const scan = openScan.value;
  if (scan && scan.edition === 0n && state.kind === 'open') return <ScanState scan={scan} />;
  if (viewProblem.value) return <Problem {...viewProblem.value} />;
  if (shownFrame.value) return state.kind === 'connecting' ? <Loading text="Connecting" /> : null;
  return <Loading text={state.kind === 'connecting' ? 'Connecting' : `Opening ${model.value}`} />;
}
