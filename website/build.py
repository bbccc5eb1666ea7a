"""Builds the documentation as a site: ``python website/build.py``.

Needs the extra ``docs``. The site is at ``build/site/index.html``; it works from a file, search
included, and asks for nothing from elsewhere.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent


def main() -> int:
    """Builds the site and returns an exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "site", metavar="DIR")
    parser.add_argument(
        "--no-gallery", action="store_true", help="run no commands, draw no pictures"
    )
    options = parser.parse_args()
    if options.out.exists() and any(options.out.iterdir()):
        if not (options.out / ".buildinfo").is_file():
            parser.error(f"--out {options.out}: holds something else than a site")
        shutil.rmtree(options.out)
    sys.path.insert(0, str(ROOT))
    from sphinx.cmd.build import main as sphinx

    from website import commands, gallery, interface, links, staging
    from website.contents import notebooks

    start = time.monotonic()
    with TemporaryDirectory() as name:
        pages = Path(name)
        generated = {
            "Results": [gallery.write_page(pages, draw=not options.no_gallery)],
            "Reference": [commands.write_pages(pages), interface.write_pages(pages)],
        }
        if notebooks():
            generated["What for, and ten minutes"] = [staging.list_of_notebooks(pages)]
        staging.stage(pages, generated)
        print(f"pages: {time.monotonic() - start:.0f} s", file=sys.stderr)
        doctrees = pages / ".doctrees"
        code = sphinx(
            ["-W", "--keep-going", "-q", "-n", "-c", str(ROOT / "website"), "-d", str(doctrees),
             str(pages), str(options.out)]
        )  # fmt: skip
    broken = links.broken_links(options.out.resolve())
    print(*broken, sep="\n", file=sys.stderr, end="\n" if broken else "")
    elsewhere = links.external_links(options.out.resolve())
    took = time.monotonic() - start
    print(f"site: {took:.0f} s; {len(elsewhere)} links to elsewhere, not followed", file=sys.stderr)
    return int(code) or bool(broken)


if __name__ == "__main__":
    sys.exit(main())
