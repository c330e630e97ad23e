import type { JSX } from 'preact';

/** Line icons on a grid of 24, drawn for this page. */
const paths = {
  orbit: 'M12 4a8 8 0 1 0 8 8M20 4v5h-5M12 9.5v5M9.5 12h5',
  fly: 'M3 11l18-7-7 18-3-8-8-3zM11 14l5-5',
  inspect: 'M12 3v4M12 17v4M3 12h4M17 12h4M12 12h.01M12 18a6 6 0 1 0 0-12 6 6 0 0 0 0 12z',
  distance: 'M5 19L19 5M5 19h.01M19 5h.01M3.5 15l5.5 5.500M15 3.500l5.5 5.5',
  height: 'M12 3v18M8 7l4-4 4 4M8 17l4 4 4-4',
  angle: 'M20 19H4L15 5M12.5 19a8.5 8.5 0 0 0-3.2-6.7',
  area: 'M5 7l8-3 7 6-3 9H7L5 7zM5 7l12 12M13 4L7 19',
  profile: 'M3 4v16h18M6.5 15l3.5-5 3.5 3 4.5-6',
  measure: 'M3 16L16 3l5 5L8 21l-5-5zM7 12l2 2M10 9l3 3M13 6l2 2',
  clip: 'M12 3l8 4.500v9L12 21l-8-4.500v-9L12 3zM12 12l8-4.500M12 12v9M12 12L4 7.5',
  window: 'M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM12 3v18M12 8h5.500M12 12h8.500M12 16h5.5',
  look: 'M12 3a9 9 0 1 0 0 18c1.5 0 2-1 1.6-2.2-.5-1.6.4-2.8 2-2.800H18a3 3 0 0 0 3-3.200C20.6 7.2 16.8 3 12 3zM7.5 12h.01M9.5 8h.01M14.5 8h.01',
  model: 'M12 3v0M4 7l8-4 8 4-8 4-8-4zM4 12l8 4 8-4M4 17l8 4 8-4',
  fit: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M9 9h6v6H9z',
  link: 'M10 14a4 4 0 0 0 6 .4l3-3a4 4 0 0 0-5.7-5.700l-1.3 1.300M14 10a4 4 0 0 0-6-.4l-3 3a4 4 0 0 0 5.7 5.700l1.3-1.3',
  camera: 'M4 8h3.500L9 5.500h6L16.5 8H20v11H4V8zM12 16.500a3.25 3.25 0 1 0 0-6.5 3.25 3.25 0 0 0 0 6.500z',
  help: 'M9 9.200A3 3 0 1 1 13.3 12c-.9.5-1.3 1-1.3 2M12 17.500h.01M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18z',
  close: 'M6 6l12 12M18 6L6 18',
  chevron: 'M7 10l5 5 5-5',
  trash: 'M5 7h14M10 7V4.500h4V7M7 7l1 13h8l1-13M10.5 11v5.500M13.5 11v5.5',
  plus: 'M12 5v14M5 12h14',
  copy: 'M9 9h11v11H9V9zM5 15H4V4h11v1',
  eye: 'M2.5 12S6 5.5 12 5.5 21.5 12 21.5 12 18 18.5 12 18.5 2.5 12 2.5 12zM12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6z',
  hidden: 'M4 4l16 16M9.5 5.9a9 9 0 0 1 2.500-.4C18 5.5 21.5 12 21.5 12s-.9 1.600-2.600 3.200M6 7.600C3.700 9.500 2.500 12 2.500 12S6 18.500 12 18.500c1.600 0 3-.5 4.200-1.100M10 10a3 3 0 0 0 4 4',
  undo: 'M8 5L4 9l4 4M4 9h10a5 5 0 0 1 0 10h-4',
  bookmark: 'M7 3.500h10V20l-5-4-5 4V3.500z',
  upload: 'M12 15V4M7.5 8.500L12 4l4.5 4.500M4 20h16',
  download: 'M12 4v11M7.5 11l4.5 4.5 4.5-4.500M4 20h16',
} as const;

export type IconName = keyof typeof paths;

export function Icon({ name, size = 20 }: { name: IconName; size?: number }): JSX.Element {
  return (
    <svg class="icon" width={size} height={size} viewBox="0 0 24 24" aria-hidden="true">
      <path d={paths[name]} />
    </svg>
  );
}

/** The logo: a wave of discs that grow to the right. */
export function Logo({ size = 26 }: { size?: number }): JSX.Element {
  const dots = Array.from({ length: 7 }, (_, i) => {
    const t = i / 6;
    return { x: 3 + 26 * t, y: 17 - 7.5 * Math.sin(t * 5.2 - 0.5), r: 1.2 + 2.2 * t };
  });
  return (
    <svg class="logo" width={size} height={size} viewBox="0 0 32 32" aria-hidden="true">
      {dots.map(({ x, y, r }) => (
        <circle cx={x} cy={y} r={r} />
      ))}
      {dots.slice(2).map(({ x, y, r }) => (
        <circle cx={x - 1} cy={y + 8} r={r * 0.7} opacity={0.45} />
      ))}
    </svg>
  );
}
