"""What is said of links that lead nowhere, and of what a page would load from elsewhere."""

from __future__ import annotations

from pathlib import Path

from website.links import broken_links, external_links

HOME = """\
<link rel="stylesheet" href="style.css"><link rel="canonical" href="https://example.org/">
<h1 id="top">Home</h1> <a href="#top">up</a> <a href="#nowhere">down</a>
<a href="inside/page.html#part">in</a> <a href="inside/page.html#other">in</a>
<a href="gone.html">gone</a> <a href="https://example.org/x">out</a>
<a href="data%20file.csv">data</a>
<img src="data:image/png;base64,AA=="><script src="//example.org/a.js"></script>
"""


def test_every_broken_link_is_told_and_no_other(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    (tmp_path / "index.html").write_text(HOME)
    (tmp_path / "inside/page.html").write_text(
        '<a name="part"></a><a href="../index.html#top">b</a>'
    )
    (tmp_path / "style.css").touch()
    (tmp_path / "data file.csv").touch()
    assert broken_links(tmp_path) == [
        "index.html: #nowhere: no such anchor",
        "index.html: inside/page.html#other: no such anchor",
        "index.html: gone.html: no such file",
        "index.html: loads //example.org/a.js",
    ]
    assert external_links(tmp_path) == ["https://example.org/x"]
