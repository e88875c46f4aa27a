"use strict";
// Curves that zoom, drawn by uPlot.
(() => {
  const { ticksOf, word, marks } = Plot;
  // Values are codes between the limits of their pane; 0 is a gap (see report_curves.cpp).
  const decoded = (text, pane) => {
    if (text === "") return [];
    const codes = pane.bits === 16 ? new Uint16Array(Page.bytes(text)) : new Uint8Array(Page.bytes(text));
    const most = 2 ** pane.bits - 2;
    return Array.from(codes, (code) => {
      if (code === 0) return null;
      const part = (code - 1) / most;
      return pane.log ? pane.low * (pane.high / pane.low) ** part : pane.low + (pane.high - pane.low) * part;
    });
  };

  const start = (figure, number) => {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const lines = data.x.map((text) => Array.from(new Float32Array(Page.bytes(text))));
    const whole = lines.flat().reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);
    const state = { choice: 0, range: whole, plots: [], busy: false };

    // Series of a pane with their numbers; those of a band hold the lower and the upper edge.
    const seriesOf = (pane, choice) => {
      let from = data.panes.slice(0, data.panes.indexOf(pane))
        .reduce((count, one) => count + one.series.reduce((c, s) => c + (s.style === "band" ? 2 : 1), 0), 0);
      return pane.series.map((series) => {
        const next = () => decoded(data.choices[choice].y[from++], pane);
        const y = next(), upper = series.style === "band" ? next() : null;
        return { ...series, x: lines[series.x], y, upper };
      }).filter((series) => series.y.length);
    };
    // The least and the largest value that are seen, with some room; bands may reach out of it.
    const rangeOf = (pane, all, [from, to]) => {
      if (pane.fixed) return [pane.low, pane.high];
      let [low, high] = [Infinity, -Infinity];
      const plain = all.filter((series) => !series.upper);
      for (const { x, y } of plain.length ? plain : all) {
        y.forEach((value, i) => {
          if (value === null || x[i] < from || x[i] > to) return;
          low = Math.min(low, value);
          high = Math.max(high, value);
        });
      }
      if (!(low <= high)) return [pane.low, pane.high];
      if (pane.log) return [low / (high / low) ** 0.05 / 1.1, high * (high / low) ** 0.05 * 1.1];
      const room = 0.06 * (high - low) || 1;
      return [low - room, high + room];
    };

    const host = figure.querySelector(".panes"), choose = figure.querySelector("select");
    const height = (pane) => Math.round(300 * pane.height);

    // Marks and dashed verticals, which uPlot does not draw itself.
    const drawMarks = (u, series, colour) => {
      const mark = marks[series.style], ratio = devicePixelRatio, shape = new Path2D(mark.path), pen = u.ctx;
      pen.save();
      pen.beginPath();
      pen.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
      pen.clip();
      pen.fillStyle = pen.strokeStyle = colour;
      pen.lineWidth = 1.2;
      series.y.forEach((value, i) => {
        if (value === null) return;
        pen.setTransform(ratio, 0, 0, ratio, u.valToPos(series.x[i], "x", true), u.valToPos(value, "y", true));
        if (mark.filled) pen.fill(shape);
        else pen.stroke(shape);
      });
      pen.restore();
    };
    const drawVerticals = (u, colour) => {
      const pen = u.ctx;
      pen.save();
      pen.strokeStyle = colour;
      pen.setLineDash([4, 4]);
      for (const x of data.verticals) {
        if (x < state.range[0] || x > state.range[1]) continue;
        const at = u.valToPos(x, "x", true);
        pen.beginPath();
        pen.moveTo(at, u.bbox.top);
        pen.lineTo(at, u.bbox.top + u.bbox.height);
        pen.stroke();
      }
      pen.restore();
    };

    const zoom = (from, to) => {
      const width = Math.max(to - from, 1e-5 * (whole[1] - whole[0]));
      from = Math.max(whole[0], Math.min(from, whole[1] - width));
      state.range = [from, Math.min(whole[1], from + width)];
      state.busy = true;
      for (const plot of state.plots) plot.setScale("x", { min: state.range[0], max: state.range[1] });
      state.busy = false;
      const [first, last] = state.range.map((x) => word(Number(x.toPrecision(4))));
      host.setAttribute("aria-label", `${data.choices[state.choice].name}: ${data.panes.map((pane) => pane.label).join("; ")} over ` +
        `${data.label} from ${first} to ${last}. Plus and minus zoom, arrows move, 0 shows all.`);
    };
    const plotOf = (pane, is_last) => {
      const colours = Page.colours(), all = seriesOf(pane, state.choice), tables = [], series = [{ label: data.short }], bands = [];
      const add = (one, y, more) => {
        tables.push([one.x, y]);
        series.push({ label: one.name, stroke: colours.series[one.colour], width: 1.5, points: { show: false },
          value: (u, v) => (v == null ? "\u2013" : word(Number(v.toPrecision(pane.bits > 8 ? 3 : 2)))), ...more });
      };
      all.forEach((one) => {
        if (one.upper) {
          add(one, one.upper, { width: 0 });
          add(one, one.y, { width: 0 });
          bands.push({ series: [series.length - 2, series.length - 1], fill: colours.series[one.colour] + "55" });
        } else if (marks[one.style]) add(one, one.y, { paths: () => null });
        else add(one, one.y, one.style === "dashed" ? { dash: [6, 4] } : {});
      });
      const axis = { stroke: colours.grey, grid: { stroke: colours.grid, width: 1 }, ticks: { stroke: colours.grid, width: 1, size: 4 },
        font: "12px system-ui, Arial, sans-serif", labelFont: "12px system-ui, Arial, sans-serif", filter: (u, splits) => splits };
      const options = { width: host.clientWidth, height: height(pane) + (is_last ? 42 : 0), series, bands,
        scales: { x: { time: false, distr: data.log ? 3 : 1, range: (u, low, high) => (state.busy || !u.data ? [low, high] : state.range) },
          y: { distr: pane.log ? 3 : 1, range: () => rangeOf(pane, all, state.range) } },
        axes: [{ ...axis, size: is_last ? 28 : 6, label: is_last ? data.label : undefined, labelSize: 18,
          splits: (u, i, low, high) => ticksOf(data, low, high, host.clientWidth / 90),
          values: (u, splits) => splits.map(is_last ? word : () => "") },
        { ...axis, size: 66, label: pane.label, labelSize: 18, splits: (u, i, low, high) => pane.ticks ?? ticksOf(pane, low, high, 5 * pane.height + 1),
          values: (u, splits) => splits.map(word) }],
        cursor: { sync: { key: `figure-${number}`, setSeries: false }, points: { size: 6 }, y: false, drag: { x: true, y: false, setScale: false } },
        hooks: { setSelect: [(u) => {
          const { left, width } = u.select;
          if (width > 2 && !state.busy) zoom(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
          if (width) u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
        draw: [(u) => {
          for (const one of all) if (marks[one.style]) drawMarks(u, one, colours.series[one.colour]);
          drawVerticals(u, colours.grey);
        }] } };
      const plot = new uPlot(options, uPlot.join(tables), host);
      plot.ctx.canvas.setAttribute("aria-hidden", "true");
      // One entry of the legend for both edges of a band.
      const entries = plot.root.querySelectorAll(".u-legend .u-series");
      bands.forEach((band) => { entries[band.series[1]].hidden = true; });
      plot.over.ondblclick = (event) => { event.stopImmediatePropagation(); zoom(...whole); };
      return plot;
    };
    const rebuild = () => {
      for (const plot of state.plots) plot.destroy();
      state.plots = data.panes.map((pane, p) => plotOf(pane, p === data.panes.length - 1));
      zoom(...state.range);
    };

    // What is seen of a choice, as SVG.
    const picture = (choice, range) => Plot.picture(data, { id: `${number}-${choice}`, name: data.choices[choice].name, range,
      panes: data.panes.map((pane) => {
        const series = seriesOf(pane, choice);
        return { pane, series, range: rangeOf(pane, series, range) };
      }) });

    // Controls.
    const show = (choice) => {
      state.choice = (choice + data.choices.length) % data.choices.length;
      choose.value = String(state.choice);
      rebuild();
    };
    data.choices.forEach((choice, c) => choose.append(Page.make("option", { value: c }, choice.name)));
    choose.closest("label").hidden = data.choices.length < 2;
    choose.onchange = () => show(Number(choose.value));
    const part = (factor) => { const [from, to] = state.range, half = factor * (to - from) / 2, mid = (from + to) / 2; zoom(mid - half, mid + half); };
    const move = (step) => { const [from, to] = state.range, by = step * (to - from); zoom(from + by, to + by); };
    const actions = figure.querySelector(".actions");
    if (data.choices.length > 1) {
      actions.append(Page.button("\u2039", `previous ${data.chooser}`, () => show(state.choice - 1)),
        Page.button("\u203a", `next ${data.chooser}`, () => show(state.choice + 1)));
    }
    actions.append(Page.button("+", "zoom in", () => part(0.5)), Page.button("\u2212", "zoom out", () => part(2)),
      Page.button("Whole range", "show all lines", () => zoom(...whole)),
      ...Page.saveButtons(data.name, () => picture(state.choice, state.range)));
    host.onkeydown = (event) => {
      const act = { "+": () => part(0.5), "-": () => part(2), "0": () => zoom(...whole), ArrowLeft: () => move(-0.25),
        ArrowRight: () => move(0.25) }[event.key];
      if (act && !event.ctrlKey && !event.metaKey) { event.preventDefault(); act(); }
    };
    figure.querySelector(".message").hidden = true;
    show(0);
    new ResizeObserver(() => state.plots.forEach((plot, p) => {
      if (host.clientWidth && plot.width !== host.clientWidth) plot.setSize({ width: host.clientWidth, height: plot.height });
    })).observe(host);
    Page.dark.addEventListener("change", rebuild);
    // Paper has the first choices, or the one that is chosen.
    const sheet = figure.querySelector(".sheet");
    addEventListener("beforeprint", () => {
      const chosen = state.choice ? [state.choice] : data.choices.slice(0, 4).map((_, c) => c);
      sheet.replaceChildren(...chosen.map((c) => picture(c, state.range)));
    });
    addEventListener("afterprint", () => sheet.replaceChildren());
  };
  document.querySelectorAll("figure.curves").forEach(start);
})();
