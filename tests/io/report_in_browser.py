#!/usr/bin/env python3
"""Opens a report in Chromium and uses it as a reader would.

report_in_browser.py PAGE
Prints what is wrong and ends with 1, or with 0 where nothing is. The browser is driven by its
debugging pipe, so that nothing listens on a port.
"""
import base64
import json
import os
import pathlib
import re
import select
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

FLAGS = """--headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader
--force-prefers-reduced-motion --remote-debugging-pipe --window-size=1280,900""".split()


class Browser:
    """One page of a Chromium of its own."""

    def __init__(self, folder):
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()

        def put_pipe():  # Chromium reads 3 and writes 4
            ends = os.dup(to_read), os.dup(to_write)
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.program = subprocess.Popen(
            ["chromium", *FLAGS, f"--user-data-dir={folder}/profile", "about:blank"], close_fds=False,
            preexec_fn=put_pipe, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.rest, self.count, self.events, self.session = b"", 0, [], None
        page = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.call(domain + ".enable")

    def message(self, seconds):
        """The next message, or None."""
        while b"\0" not in self.rest:
            if not select.select([self.back], [], [], seconds)[0]:
                return None
            if not (piece := os.read(self.back, 1 << 20)):
                raise EOFError("chromium has ended")
            self.rest += piece
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while answer := self.message(120):
            if answer.get("id") == self.count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)
        raise TimeoutError(method)

    def open(self, page):
        self.call("Page.navigate", url=page.as_uri())
        end = time.monotonic() + 120
        while time.monotonic() < end:
            if any(event.get("method") == "Page.loadEventFired" for event in self.events):
                return
            if event := self.message(1):
                self.events.append(event)
        raise TimeoutError("the page did not load")

    def run(self, script):
        """The value of an expression in the page, promises awaited."""
        answer = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True, userGesture=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def close(self):
        self.session = None
        try:
            self.call("Browser.close")
        except (EOFError, OSError, TimeoutError):
            pass
        self.program.wait(30)


def saved(folder, ending):
    """The first file of that ending, once it is whole."""
    end = time.monotonic() + 60
    while time.monotonic() < end:
        files = list(folder.glob("*" + ending))
        if files and files[0].stat().st_size:
            return files[0]
        time.sleep(0.2)
    return None


def nothing_bad_happened(browser, page):
    for event in browser.events:
        if event.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
            yield f"the browser complains: {json.dumps(event['params'])[:600]}"
        if event.get("method") == "Network.requestWillBeSent":
            url = event["params"]["request"]["url"]
            if url != page.as_uri() and not url.startswith(("data:", "blob:")):
                yield f"a request was sent: {url}"


def curves_show_zoom_and_choose(browser):
    drawn = """[...document.querySelectorAll(".curves canvas")].map((canvas) => {
      const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let coloured = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] && Math.max(data[i], data[i+1], data[i+2]) - Math.min(data[i], data[i+1], data[i+2]) > 60) ++coloured;
      return coloured; })"""
    for pane, count in enumerate(browser.run(drawn)):
        if count < 200:
            yield f"pane {pane} of the curves shows {count} coloured pixels"
    label = "document.querySelector('.panes').getAttribute('aria-label')"
    whole = browser.run(label)
    box = browser.run("(() => { const b = document.querySelector('.u-over').getBoundingClientRect();"
                      " scrollTo(0, b.y + scrollY - 100); const c = document.querySelector('.u-over').getBoundingClientRect();"
                      " return [c.x, c.y, c.width, c.height]; })()")
    y = box[1] + box[3] / 2
    for kind, part in (("mousePressed", 0.25), ("mouseMoved", 0.4), ("mouseMoved", 0.5), ("mouseReleased", 0.5)):
        browser.call("Input.dispatchMouseEvent", type=kind, x=box[0] + part * box[2], y=y, button="left", buttons=1, clickCount=1)
    low, high = map(float, re.search(r"from (\d+(?:\.\d+)?) to (\d+(?:\.\d+)?)", whole).groups())
    zoomed = browser.run(label)
    found = list(map(float, re.search(r"from (\d+(?:\.\d+)?) to (\d+(?:\.\d+)?)", zoomed).groups()))
    wanted = [low + 0.25 * (high - low), low + 0.5 * (high - low)]
    if any(abs(a - b) > 0.01 * (high - low) for a, b in zip(found, wanted)):
        yield f"a drag zoomed to {found}, expected {wanted}"
    browser.run("document.querySelector('.panes').dispatchEvent(new KeyboardEvent('keydown', {key: '0'}))")
    if browser.run(label) != whole:
        yield "the key 0 did not show all lines"
    browser.run("(() => { const s = document.querySelector('.curves select'); s.value = '1'; s.onchange(); })()")
    if browser.run(label).split(":")[0] != browser.run("document.querySelectorAll('.curves option')[1].textContent"):
        yield "the second choice is not shown"


def tables_copy(browser):
    browser.run("[...document.querySelectorAll('.matrix')][0].closest('.table').querySelector('button').click()")
    time.sleep(0.5)
    said = browser.run("document.querySelector('[aria-live]').textContent")
    if said != "the table is copied":
        yield f"after a click on Copy the page says \"{said}\""
    pasted = browser.run("navigator.clipboard.readText()")
    wanted = browser.run("[...document.querySelector('.matrix').rows].map((r) => [...r.cells].map((c) => c.textContent).join('\\t')).join('\\n') + '\\n'")
    if pasted != wanted:
        yield f"the clipboard has {pasted!r}, expected {wanted!r}"


def figures_save(browser, folder):
    for place, name in ((".curves", "responses"), (".matrix", "likeness")):
        for kind in ("SVG", "PNG"):
            browser.run("(() => { const f = document.querySelector('%s'); const b = f.closest('.table') || f;"
                        " [...b.querySelectorAll('button')].find((x) => x.textContent === '%s').click(); })()" % (place, kind))
            file = saved(folder, f"{name}.{kind.lower()}")
            if not file:
                yield f"{place} was not saved as {kind}"
            elif kind == "SVG":
                root = xml.etree.ElementTree.parse(file).getroot()
                marks = [e for e in root.iter() if e.tag.endswith("}path") or e.tag.endswith("}rect")]
                if len(marks) < 4:
                    yield f"{file.name} has {len(marks)} paths and rectangles"
            elif file.read_bytes()[:8] != b"\x89PNG\r\n\x1a\n" or file.stat().st_size < 2000:
                yield f"{file.name} is no picture"


def everything_has_a_name(browser):
    roles = {"button", "combobox", "slider", "checkbox", "image", "img", "link", "region"}
    for node in browser.call("Accessibility.getFullAXTree")["nodes"]:
        role = node.get("role", {}).get("value")
        if role in roles and not node.get("ignored") and not node.get("name", {}).get("value"):
            yield f"a {role} has no name for a screen reader"
    levels = browser.run("[...document.querySelectorAll('h1, h2, h3')].map((h) => Number(h.tagName[1]))")
    if levels[0] != 1 or levels.count(1) != 1:
        yield f"headings do not begin with one h1: {levels}"


def colours_follow_the_reader(browser):
    """Text of every colour stands out from what is behind it (WCAG: 4.5 to 1), light and dark."""
    contrast = """(() => {
      const parse = (c) => c.match(/[\\d.]+/g).map(Number);
      const light = (c) => parse(c).slice(0, 3).map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((s, v, i) => s + v * [0.2126, 0.7152, 0.0722][i], 0);
      const behind = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor;
        const p = parse(c); if (p.length < 4 || p[3] > 0.9) return c; } return "rgb(255, 255, 255)"; };
      const bad = [];
      for (const e of document.querySelectorAll("p, td, th, dt, dd, li, a, button, caption, figcaption, h1, h2, h3, summary")) {
        if (!e.textContent.trim() || e.closest(".unseen") || !e.offsetParent) continue;
        const [a, b] = [light(getComputedStyle(e).color), light(behind(e))].sort((x, y) => y - x);
        if ((a + 0.05) / (b + 0.05) < 4.5) bad.push(`${e.tagName} ${e.className} "${e.textContent.slice(0, 20)}" ${((a + 0.05) / (b + 0.05)).toFixed(2)}`);
      }
      return bad; })()"""
    grounds = []
    for theme in ("light", "dark"):
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
        grounds.append(browser.run("getComputedStyle(document.body).backgroundColor"))
        for line in browser.run(contrast)[:5]:
            yield f"{theme}: too little contrast: {line}"
    if grounds[0] == grounds[1]:
        yield "a dark page is as light as a light one"
    browser.call("Emulation.setEmulatedMedia", features=[])


def it_prints(browser):
    pages = browser.call("Page.printToPDF", preferCSSPageSize=True)["data"]
    if not base64.b64decode(pages).startswith(b"%PDF"):
        yield "no PDF was printed"
    browser.run("dispatchEvent(new Event('beforeprint'))")
    if browser.run("document.querySelectorAll('.curves .sheet svg').length") < 1:
        yield "curves are not on paper"
    if browser.run("document.querySelectorAll('.viewer .sheet img').length") < 1:
        yield "the body is not on paper"
    browser.run("dispatchEvent(new Event('afterprint'))")


def it_fits_a_phone(browser):
    browser.call("Emulation.setDeviceMetricsOverride", width=390, height=800, deviceScaleFactor=2, mobile=False)
    time.sleep(1)
    width = browser.run("document.documentElement.scrollWidth")
    if width > 390:
        yield f"the page is {width} px wide where 390 are seen"
    browser.call("Emulation.clearDeviceMetricsOverride")


def faults(page, folder):
    browser = Browser(folder)
    try:
        browser.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
        browser.open(page)
        yield from curves_show_zoom_and_choose(browser)
        yield from tables_copy(browser)
        yield from figures_save(browser, folder)
        yield from everything_has_a_name(browser)
        yield from colours_follow_the_reader(browser)
        yield from it_prints(browser)
        yield from it_fits_a_phone(browser)
        yield from nothing_bad_happened(browser, page)
    finally:
        browser.close()


def main():
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        found = list(faults(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(folder)))
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
