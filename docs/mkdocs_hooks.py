"""Search that works where pages are opened as files: browsers fetch no index and start no worker there.

Both are given to the theme as a script, by the names that it asks for (`__search`)."""
import json
import pathlib

from markdown.extensions import toc

FILE = "search/offline.js"
SCRIPT = """var __search = {{
  index: Promise.resolve({index}),
  worker: URL.createObjectURL(new Blob([{worker}], {{type: "text/javascript"}}))
}};
"""


def numbered(name, names):
    """An anchor that is not yet among `names`, numbered as GitHub numbers them."""
    free, count = name, 0
    while free in names:
        count += 1
        free = f"{name}-{count}"
    names.add(free)
    return free


def on_config(config):
    toc.unique = numbered
    return config


def on_post_page(output, page, config):
    up = "../" * page.url.count("/")
    return output.replace("</head>", f'<script src="{up}{FILE}"></script></head>', 1)


def on_post_build(config):
    site = pathlib.Path(config["site_dir"])
    (worker,) = site.glob("assets/javascripts/workers/search.*.js")
    code = worker.read_text().partition("//# sourceMappingURL")[0]
    script = SCRIPT.format(index=(site / "search/search_index.json").read_text(), worker=json.dumps(code))
    (site / FILE).write_text(script)
