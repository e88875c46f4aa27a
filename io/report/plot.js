"use strict";
// Ticks and marks of curves, and curves as SVG in the colours of paper.
const Plot = (() => {
  // The ticks of an axis: steps of 1, 2 or 5, or the decades, with 2 and 5 where these are few.
  const linearTicks = (low, high, most) => {
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= rough * 0.999);
    const ticks = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high * (1 + 1e-12); ++i) ticks.push(i * step);
    return ticks;
  };
  const logTicks = (low, high, most) => {
    const decades = Math.log10(high / low), ticks = [];
    if (decades < 0.8) return linearTicks(low, high, most);
    const skip = Math.max(1, Math.ceil(decades / most)), factors = decades < 2.2 ? [1, 2, 5] : [1];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
      if (e % skip) continue;
      for (const factor of factors) {
        const tick = Number(`${factor}e${e}`);
        if (tick >= low * 0.9999 && tick <= high * 1.0001) ticks.push(tick);
      }
    }
    return ticks;
  };
  const ticksOf = (axis, low, high, most) => (axis.log ? logTicks : linearTicks)(low, high, most);
  const word = (value) => {
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(6))).replace("-", "\u2212");
    return value.toExponential(Number(value.toPrecision(1)) === Number(value.toPrecision(6)) ? 0 : 2)
      .replace("e+", "e").replace("-", "\u2212").replace("-", "\u2212");
  };

  // A mark of radius r around the origin, for canvas and SVG alike.
  const circle = (r) => `M${r},0A${r},${r} 0 1 1 ${-r},0A${r},${r} 0 1 1 ${r},0Z`;
  const marks = {
    dots: { path: circle(1.7), filled: true },
    circles: { path: circle(3.6), filled: false },
    crosses: { path: "M-3,-3L3,3M-3,3L3,-3", filled: false },
    plusses: { path: "M-3.6,0L3.6,0M0,-3.6L0,3.6", filled: false } };

  const width = 720, left = 78, right = 12, top = 52, gap = 14;
  const across = left + (width - left - right) / 2;
  const write = (x, y, text, more = {}) => Page.svg("text", { x, y, fill: Page.paper.ink, "font-size": 12, ...more }, text);
  const near = (value) => value.toFixed(1);
  const drawn = (mark, colour, more) => Page.svg("path", { d: mark.path, ...more,
    ...(mark.filled ? { fill: colour } : { fill: "none", stroke: colour, "stroke-width": 1.2 }) });
  const scale = (axis, [low, high], from, to) => (axis.log ?
    (value) => from + (to - from) * Math.log(value / low) / Math.log(high / low) :
    (value) => from + (to - from) * (value - low) / (high - low));

  const grid = (data, { pane, range }, box, places, is_last) => {
    const { paper, svg } = Page, parts = [];
    for (const tick of pane.ticks ?? ticksOf(pane, ...range, 5 * pane.height + 1)) {
      const y = places.y(tick);
      parts.push(svg("line", { x1: left, x2: width - right, y1: y, y2: y, stroke: paper.grid }),
        write(left - 6, y + 4, word(tick), { "text-anchor": "end", fill: paper.grey }));
    }
    for (const tick of ticksOf(data, ...places.range, 8)) {
      const x = places.x(tick);
      parts.push(svg("line", { x1: x, x2: x, y1: box.y, y2: box.base, stroke: paper.grid }));
      if (is_last) parts.push(write(x, box.base + 16, word(tick), { "text-anchor": "middle", fill: paper.grey }));
    }
    const middle = (box.y + box.base) / 2;
    parts.push(write(14, middle, pane.label, { "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }));
    return parts;
  };
  const curve = (one, places) => {
    const colour = Page.paper.series[one.colour], mark = marks[one.style], [from, to] = places.range;
    const shown = one.x.map((_, i) => i).filter((i) => one.x[i] >= from && one.x[i] <= to);
    const point = (values, i) => `${near(places.x(one.x[i]))},${near(places.y(values[i]))}`;
    if (one.upper) {
      const seen = shown.filter((i) => one.y[i] !== null && one.upper[i] !== null);
      if (!seen.length) return [];
      const edge = (values, order) => order.map((i) => point(values, i)).join("L");
      return [Page.svg("path", { fill: colour, "fill-opacity": 0.28,
        d: `M${edge(one.upper, seen)}L${edge(one.y, [...seen].reverse())}Z` })];
    }
    if (mark) {
      return shown.filter((i) => one.y[i] !== null)
        .map((i) => drawn(mark, colour, { transform: `translate(${point(one.y, i)})` }));
    }
    const path = shown.map((i, k) => (one.y[i] === null ? "" :
      `${k === 0 || one.y[shown[k - 1]] === null ? "M" : "L"}${point(one.y, i)}`)).join("");
    return [Page.svg("path", { d: path, fill: "none", stroke: colour, "stroke-width": 1.4,
      ...(one.style === "dashed" ? { "stroke-dasharray": "6 4" } : {}) })];
  };
  const legend = (all) => {
    const parts = [];
    let x = left;
    for (const one of all) {
      const colour = Page.paper.series[one.colour], mark = marks[one.style];
      parts.push(one.upper ? Page.svg("rect", { x, y: 30, width: 16, height: 10, fill: colour, "fill-opacity": 0.28 }) :
        mark ? drawn(mark, colour, { transform: `translate(${x + 8},35)` }) :
          Page.svg("line", { x1: x, x2: x + 16, y1: 35, y2: 35, stroke: colour, "stroke-width": 2 }), write(x + 21, 39, one.name));
      x += 40 + 6.4 * one.name.length;
    }
    return parts;
  };

  /// `shown`: { id, name, range of x, panes: [{ pane, series, range of y }] }
  const picture = (data, shown) => {
    const { paper, svg } = Page, parts = [], named = new Map();
    let y = top;
    shown.panes.forEach((one, p) => {
      const box = { y, base: y + Math.round(220 * one.pane.height) }, clip = `clip-${shown.id}-${p}`;
      const frame = { x: left, y, width: width - left - right, height: box.base - y };
      const places = { range: shown.range, x: scale(data, shown.range, left, width - right), y: scale(one.pane, one.range, box.base, y) };
      const inside = data.verticals.filter((x) => x >= shown.range[0] && x <= shown.range[1]).map((x) => svg("line",
        { x1: places.x(x), x2: places.x(x), y1: y, y2: box.base, stroke: paper.grey, "stroke-dasharray": "4 4" }));
      for (const series of one.series) {
        inside.push(...curve(series, places));
        if (!named.has(series.name)) named.set(series.name, series);
      }
      parts.push(svg("clipPath", { id: clip }, svg("rect", frame)), ...grid(data, one, box, places, p === shown.panes.length - 1),
        svg("g", { "clip-path": `url(#${clip})` }, ...inside), svg("rect", { ...frame, fill: "none", stroke: paper.grey, "stroke-width": 0.8 }));
      y = box.base + gap;
    });
    const height = y + 32;
    return svg("svg", { width, height, viewBox: `0 0 ${width} ${height}`, "font-family": "Arial, sans-serif", role: "img", "aria-label": shown.name },
      svg("rect", { width, height, fill: paper.back }), write(left, 18, shown.name, { "font-size": 14, "font-weight": 600 }),
      ...legend(named.values()), ...parts, write(across, y + 22, data.label, { "text-anchor": "middle" }));
  };

  return { ticksOf, word, marks, picture };
})();
