import { useEffect, useRef } from 'preact/hooks';
import type { JSX } from 'preact';
import { glyphPixels, type Glyph } from '../state/glyph';
import { shownProjection } from '../state/store';

const size = 160; // pixels

/** A picked ellipsoid, enlarged, turned as in the picture on the screen. */
export function GlyphPicture({ glyph, color }: { glyph: Glyph; color: readonly number[] | undefined }): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const view = shownProjection.value;
  useEffect(() => {
    const context = canvas.current?.getContext('2d');
    if (!context || !view) return;
    context.putImageData(new ImageData(glyphPixels(glyph, view.axes, color, size), size, size), 0, 0);
  }, [glyph, color, view]);
  return <canvas ref={canvas} class="glyph" width={size} height={size} role="img" aria-label="Ellipsoid" />;
}
