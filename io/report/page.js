"use strict";
// What the parts of the page share: elements, saved files, colours.
const Page = (() => {
  const space = document.querySelector("svg.unseen").namespaceURI;
  const fill = (element, attributes, children) => {
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children.filter((child) => child !== null));
    return element;
  };
  const make = (name, attributes = {}, ...children) => fill(document.createElement(name), attributes, children);
  const svg = (name, attributes = {}, ...children) => fill(document.createElementNS(space, name), attributes, children);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

  // Wong's colours, as in the pictures; lighter ones on a dark page. The order is that of PlotSeries::colour.
  const paper = { ink: "#1d2126", grey: "#5b626c", grid: "#e6e7e9", back: "#ffffff",
    series: ["#21242a", "#0073b2", "#d65e00", "#009e73", "#cc79a7", "#b07d00", "#85888f"] };
  const night = { ink: "#e4e7eb", grey: "#a3abb6", grid: "#2c323b", back: "#14171c",
    series: ["#e4e7eb", "#56b4e9", "#f0803c", "#2fc79b", "#dc96bd", "#e69f00", "#9aa0a8"] };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  let printing = false;
  addEventListener("beforeprint", () => { printing = true; });
  addEventListener("afterprint", () => { printing = false; });
  const colours = () => (dark.matches && !printing ? night : paper);

  const words = make("p", { class: "unseen", "aria-live": "polite" });
  document.body.append(words);
  const say = (text) => { words.textContent = text; };
  const button = (text, title, act) => {
    const made = make("button", { type: "button", title }, text);
    made.onclick = act;
    return made;
  };

  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "");
  const save = (name, extension, content) => {
    const file = `${slug(document.title)}-${slug(name)}.${extension}`;
    const link = make("a", { href: URL.createObjectURL(content), download: file });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    say(`saved ${file}`);
  };
  const text = (picture) => new XMLSerializer().serializeToString(picture);
  const saveSvg = (name, picture) => save(name, "svg", new Blob([text(picture)], { type: "image/svg+xml" }));
  // Twice as many pixels as the SVG has units.
  const savePng = (name, picture) => {
    const image = new Image(), canvas = make("canvas");
    image.onload = () => {
      [canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => save(name, "png", blob));
    };
    image.src = "data:image/svg+xml;base64," +
      btoa(Array.from(new TextEncoder().encode(text(picture)), (byte) => String.fromCharCode(byte)).join(""));
  };
  /// Buttons that save the picture that `draw` makes, in the colours of paper.
  const saveButtons = (name, draw) => [
    button("SVG", `save ${name} as SVG`, () => saveSvg(name, draw())),
    button("PNG", `save ${name} as PNG`, () => savePng(name, draw()))];

  return { make, svg, bytes, paper, colours, dark, say, button, save, saveButtons };
})();
