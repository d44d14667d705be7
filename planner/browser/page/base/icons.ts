// SPDX-License-Identifier: AGPL-3.0-or-later
// Icons as inline SVG strokes on a 24-pixel grid.

const paths = {
  navigate: "M5 3l14 8-6 2-2 6z",
  region: "M5 8l7-4 7 5-2 9H7zM5 8h.01M12 4h.01M19 9h.01M17 18h.01M7 18h.01",
  move:
      "M12 3v18M3 12h18M12 3l-2.5 2.5M12 3l2.5 2.5M12 21l-2.5-2.5M12 21l2.5-2.5M3 12l2.5-2.5M3 12l2.5 2.5M21 12l-2.5-2.5M21 12l-2.5 2.5",
  marks: "M6 18h.01M4 18a2 2 0 104 0 2 2 0 00-4 0zM16 6a2 2 0 104 0 2 2 0 00-4 0zM8 16l8-8M12 8h4v4",
  contact: "M3 8c3 4 6 4 9 0s6-4 9 0M3 14c3 4 6 4 9 0s6-4 9 0M12 8v6",
  landmark: "M12 21s6.5-6 6.5-11a6.5 6.5 0 10-13 0c0 5 6.5 11 6.5 11zM12 12a2 2 0 100-4 2 2 0 000 4z",
  distance: "M3 17L17 3l4 4L7 21zM8 12l2 2M11 9l2 2M14 6l2 2",
  angle: "M4 20h16M4 20L15 5M11 20a8 8 0 00-3-6",
  surface_distance: "M3 18c3-10 6 2 9-6s5-6 9-6M3 18h.01M21 6h.01",
  islands: "M4 9c0-5 8-6 10-2s-2 8-6 8-4-2-4-6zM19 8h.01M18 16a1.500 1.500 0 103 0 1.500 1.500 0 10-3 0zM10 20h.01",
  brush: "M20 3l-9 9M10 11l3 3c0 4-4 7-9 6 2-1 1-3 2-5s2-3 4-4z",
  contour: "M5 7c4-5 12-4 14 2s-3 10-8 10-10-7-6-12zM5 7h.01M19 9h.01M11 19h.01M9 11c2-2 5-1 5 1s-3 3-4 2-2-2-1-3z",
  segment: "M15 4l5 5M4 20l9-9M13 6l5 5M9 4v3M7.5 5.5h3M19 15v3M17.500 16.500h3",
  grow: "M12 12h.01M12 8a4 4 0 100 8 4 4 0 000-8zM12 4v-2M12 22v-2M4 12h-2M22 12h-2M6.300 6.300L5 5M19 19l-1.300-1.300M17.700 6.300L19 5M5 19l1.300-1.300",
  window: "M4 18V9M8 18V5M12 18v-7M16 18V8M20 18v-4M3 21h18",
  cut: "M6 6a2 2 0 104 0 2 2 0 00-4 0zM6 18a2 2 0 104 0 2 2 0 00-4 0zM10 7l10 9M10 17L20 8",
  arch: "M5 5v6a7 7 0 0014 0V5M5 5h.01M19 5h.01M12 18h.01",
  plane: "M4 15l8 5 8-5-8-5zM12 3v7M4 9l8-5 8 5",
  compare: "M9 5a7 7 0 100 14A7 7 0 009 5zM15 5a7 7 0 110 14",
  mirror: "M12 3v18M9 7L4 17h5zM15 7l5 10h-5z",
  procedure: "M6 3h9l4 4v14H6zM9 12h7M9 16h7M9 8h3",
  undo: "M9 7L4 11l5 4M4 11h10a6 6 0 010 12",
  redo: "M15 7l5 4-5 4M20 11H10a6 6 0 000 12",
  branch: "M7 4v16M7 9c6 0 10 0 10 6M17 20a2 2 0 100-4 2 2 0 000 4zM7 4h.01",
  eye:
      "M2.500 12S6 5.500 12 5.500 21.500 12 21.500 12 18 18.500 12 18.500 2.500 12 2.500 12zM12 14.500a2.500 2.500 0 100-5 2.500 2.500 0 000 5z",
  eye_off:
      "M4 4l16 16M9.500 6c.8-.3 1.600-.5 2.500-.5 6 0 9.500 6.500 9.500 6.500a17 17 0 01-3 3.700M6 8a17 17 0 00-3.500 4S6 18.500 12 18.500c1.200 0 2.300-.3 3.300-.7",
  more: "M12 6h.01M12 12h.01M12 18h.01",
  close: "M6 6l12 12M18 6L6 18",
  add: "M12 5v14M5 12h14",
  search: "M11 18a7 7 0 100-14 7 7 0 000 14zM16.500 16.500L21 21",
  help: "M12 21a9 9 0 100-18 9 9 0 000 18zM9.500 9.500a2.500 2.500 0 115 0c0 2-2.500 2-2.500 4M12 17h.01",
  theme: "M12 3a9 9 0 100 18zM12 3a9 9 0 010 18",
  folder: "M3 6h6l2 2h10v11H3z",
  file: "M6 3h8l4 4v14H6zM14 3v4h4",
  head: "M6 21v-4c-2-2-2-4-2-6a8 8 0 0116 0l1 4h-2v3a2 2 0 01-2 2h-3v1",
  export: "M12 15V3M8 7l4-4 4 4M5 13v7h14v-7",
  report: "M6 3h9l4 4v14H6zM9 13l2 2 4-5",
  camera: "M4 8h4l2-3h4l2 3h4v11H4zM12 16.500a3.500 3.500 0 100-7 3.500 3.500 0 000 7z",
  screen: "M3 5h18v11H3zM9 20h6M12 16v4",
  share: "M6 14a2 2 0 100-4 2 2 0 000 4zM17 7a2 2 0 100-4 2 2 0 000 4zM17 21a2 2 0 100-4 2 2 0 000 4zM8 11l7-5M8 13l7 5",
  maximise: "M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5",
  trash: "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13",
  copy: "M8 8h11v12H8zM5 16V4h11",
  certify: "M12 3l7 3v5c0 5-3 8-7 10-4-2-7-5-7-10V6zM9 12l2 2 4-4",
  target: "M12 19a7 7 0 100-14 7 7 0 000 14zM12 2v5M12 17v5M2 12h5M17 12h5",
  play: "M8 5l11 7-11 7z",
  fit: "M4 8V4h4M20 8V4h-4M4 16v4h4M20 16v4h-4M9 9h6v6H9z",
} as const;
export type IconName = keyof typeof paths;

export function icon(name: IconName, size = 18): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("width", String(size));
  svg.setAttribute("height", String(size));
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}
export const is_icon = (name: string): name is IconName => name in paths;
