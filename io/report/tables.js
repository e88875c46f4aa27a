"use strict";
// Tables copy as tab-separated text; coloured ones also save as pictures.
(() => {
  const rows = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent));
  const tsv = (table) => rows(table).map((row) => row.join("\t")).join("\n") + "\n";
  // Where the clipboard is closed to scripts, the text is selected in a field and copied from there.
  const copyBySelection = (text) => {
    const field = Page.make("textarea", { class: "unseen" });
    field.value = text;
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  };
  const copy = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      return copyBySelection(text);
    }
  };

  const cell = 34, wide = 96, fontSize = 12;
  const write = (x, y, text, more = {}) =>
    Page.svg("text", { x, y, "font-size": fontSize, fill: Page.paper.ink, ...more }, text);
  // The squares of a matrix with their numbers, its names beside and below them.
  const matrixSvg = (table) => {
    const [heads, ...body] = [...table.rows].map((row) => [...row.cells]);
    const [width, height] = [wide + 20 + cell * (heads.length - 1), 60 + cell * body.length + wide];
    const bottom = 50 + cell * body.length;
    const parts = body.flatMap((cells, r) => cells.map((one, c) => {
      const y = 50 + cell * r;
      if (c === 0) return write(wide - 6, y + 21, one.textContent, { "text-anchor": "end" });
      const { backgroundColor, color } = getComputedStyle(one), x = wide + cell * (c - 1);
      return Page.svg("g", {}, Page.svg("rect", { x, y, width: cell - 1, height: cell - 1, fill: backgroundColor }),
        write(x + cell / 2, y + 21, one.textContent, { "text-anchor": "middle", "font-size": 10, fill: color }));
    }));
    const names = heads.slice(1).map((one, c) => {
      const x = wide + cell * c + cell / 2 + 4;
      return write(x, bottom + 8, one.textContent, { "text-anchor": "end", transform: `rotate(-60 ${x} ${bottom + 8})` });
    });
    const picture = Page.svg("svg", { width, height, viewBox: `0 0 ${width} ${height}`, "font-family": "Arial, sans-serif" });
    picture.append(Page.svg("rect", { width, height, fill: "#fff" }),
      write(10, 20, table.caption.textContent, { "font-weight": 600 }),
      write(10, 40, heads[0].textContent, { fill: Page.paper.grey }), ...parts, ...names);
    return picture;
  };

  for (const table of document.querySelectorAll(".table > table")) {
    const name = table.caption ? table.caption.textContent : table.closest("section").querySelector("h2").textContent;
    const buttons = [Page.button("Copy", "copy the table as tab-separated text", async () => {
      Page.say(await copy(tsv(table)) ? "the table is copied" : "this browser did not let the table be copied");
    })];
    if (table.classList.contains("matrix")) buttons.push(...Page.saveButtons(name, () => matrixSvg(table)));
    table.closest(".table").append(Page.make("div", { class: "actions" }, ...buttons));
  }
})();
