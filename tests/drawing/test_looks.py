"""Width, font, style and titles of pictures: what is taken, what is refused, what comes of it."""

from __future__ import annotations

import re
import zlib
from io import BytesIO
from pathlib import Path

import matplotlib
import pytest
from matplotlib.font_manager import FontEntry, fontManager
from matplotlib.text import Text
from PIL import Image

from hilc_cli.drawing.looks import KEYS, picture_look
from hilc_cli.drawing.save import render
from hilc_cli.drawing.sheet import Sheet
from hilc_cli.errors import HilcError, InvalidInputError, UsageError
from hilc_cli.results.look import USUAL, Look, read_width
from hilc_cli.runs.pictures.catalogue import draw, kinds_of
from tests.drawing.reading import overlaps, texts
from tests.made_up_runs import MakeRun, straight

MM = 1 / 25.4  # [inch]


@pytest.mark.parametrize(
    ("text", "width"),
    [
        ("8.5cm", 0.085),
        ("3.4in", 0.08636),
        ("170 mm", 0.17),
        (" .2 M ", 0.2),
        ("252pt", 252 * 0.0254 / 72.27),
        ("60mm", 0.06),
        (0.085, 0.085),
    ],
)
def test_widths_are_read(text: str | float, width: float) -> None:
    assert read_width(text) == pytest.approx(width, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("85", "--width 85: has no unit; give a width with its unit, such as 85mm"),
        ("wide", "--width wide: is no width"),
        ("-85mm", "--width -85mm: is no width"),
        ("1e9mm", "--width 1e9mm: is no width"),
        ("85px", "--width 85px: is no width"),
        ("59mm", "--width 59mm: must be from 60mm to 1000mm, got 59mm"),
        ("85m", "--width 85m: must be from 60mm to 1000mm, got 8.5e\\+04mm"),
        (float("nan"), "--width nan: must be from 60mm to 1000mm$"),
    ],
)
def test_other_widths_are_refused(text: str | float, problem: str) -> None:
    with pytest.raises(UsageError, match=f"^{problem}"):
        picture_look(width=text)


def test_fonts_are_those_of_the_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert picture_look(font="DejaVu Serif") == Look(font="DejaVu Serif")
    with pytest.raises(UsageError, match=r"^--font Dejavu Serf: there is no .* 'DejaVu Serif'\?$"):
        picture_look(font="Dejavu Serf")
    with pytest.raises(UsageError, match=r"^--font STIX: there is no such font; known: STIX.*STIX"):
        picture_look(font="STIX")
    with pytest.raises(UsageError, match=r"^--font \ufffd: there is no such font; known: "):
        picture_look(font="\x1b")
    with pytest.raises(UsageError, match=r"^--font-size 3: must be from 4 to 30 points$"):
        picture_look(font_size=3)
    (tmp_path / "a.otf").write_bytes(b"OTTO")
    postscript = FontEntry(fname=str(tmp_path / "a.otf"), name="Outlined")
    monkeypatch.setattr(fontManager, "ttflist", [*fontManager.ttflist, postscript])
    with pytest.raises(UsageError, match=r"^--font Outlined: its outlines are PostScript's"):
        picture_look(font="Outlined")


STYLE = """\
# a style of ours
font.family: serif
font.serif: No Such Font, DejaVu Serif  # the first that is there
font.size: 9
axes.linewidth: 0.5
axes.edgecolor: "#102030"
axes.spines.top: False
xtick.direction : in
grid.linestyle: :
"""


def test_a_style_file_sets_how_axes_look(tmp_path: Path, make_run: MakeRun) -> None:
    file = tmp_path / "mine.mplstyle"
    file.write_text(STYLE)
    look = picture_look(style=file, width="90mm")
    assert (look.font_size, look.style_file) == (9.0, str(file))
    assert picture_look(style=file, font_size=7).font_size == 7
    assert look.options == f" --width 90mm --style {file}"
    figure = draw("error", [make_run()], look=look)
    (axes,) = figure.axes
    assert isinstance(figure, Sheet)
    assert float(axes.xaxis.label.get_fontsize()) * figure.scale == pytest.approx(9)
    assert axes.xaxis.label.get_fontname() == "DejaVu Serif"
    # Points are those of the page, and the whole sheet is scaled to it.
    assert axes.spines["left"].get_linewidth() * figure.scale == pytest.approx(0.5)
    assert matplotlib.colors.to_hex(axes.spines["left"].get_edgecolor()) == "#102030"
    assert not axes.spines["top"].get_visible()
    assert matplotlib.rcParams["axes.spines.top"], "only while pictures are drawn"
    for key in KEYS:
        assert key in matplotlib.rcParamsDefault


HOSTILE = [
    "backend: module://evil",
    "figure.hooks: evil:run",
    "axes.prop_cycle: cycler('color', [__import__('os').system('touch evil')])",
    "text.usetex: True",
    r"text.latex.preamble: \input{/etc/passwd}",
    r"pgf.preamble: \write18{touch evil}",
    "animation.ffmpeg_path: ./evil",
    "savefig.directory: /tmp",
    "ps.usedistiller: ghostscript",
    "webagg.address: 0.0.0.0",
    "path.effects: [__import__('os')]",
    "svg.fonttype: none",
    "pdf.fonttype: 3",
    "lines.linewidth: 3",
]


def test_other_keys_of_a_strangers_style_file_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "evil.mplstyle"
    file.write_text("axes.linewidth: 1\n" + "\n".join(HOSTILE))
    with pytest.raises(InvalidInputError) as refused:
        picture_look(style=file)
    lines = str(refused.value).splitlines()
    assert len(lines) == len(HOSTILE)
    for number, (line, said) in enumerate(zip(HOSTILE, lines, strict=True), 2):
        key = line.partition(":")[0]
        assert said.startswith(f"{file}:{number}: {key}: is not allowed in a style file; ")
    assert not (tmp_path / "evil").exists() and not Path("evil").exists()


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("axes.linewidth: 1e9", "1: axes.linewidth: must be a number from 0 to 20, in points, got"),
        ("font.size: nan", "1: font.size: must be a number from 4 to 30"),
        ("font.size: small", "1: font.size: must be a number from 4 to 30"),
        ("grid.alpha: 2", "1: grid.alpha: must be a number from 0 to 1, got 2"),
        ("grid.linestyle: (0, (0, 0))", "1: grid.linestyle: must be -, --, -. or :, got"),
        ("text.color: nonsense", "1: text.color: must be a colour"),
        ("text.color: " + "(" * 190, "1: text.color: must be a colour"),
        ("text.color: " + "a" * 201, "1: text.color: is longer than 200 letters"),
        ("font.weight: 5000", "1: font.weight: must be normal, bold"),
        ("font.family: /etc/font.ttf", "1: font.family: /etc/font.ttf: there is no such font"),
        ("font.serif: Dejavu Serf", "1: font.serif: Dejavu Serf: .* did you mean 'DejaVu Serif'"),
        ("axes.spines.top: perhaps", "1: axes.spines.top: must be True or False, got perhaps"),
        ("\nhello", "2: hello: is no line 'key: value'"),
        ("grid.alpha: 1\ngrid.alpha: 1", "2: grid.alpha: stands there twice"),
        ("axes.linewith: 1", "1: axes.linewith: is not allowed .* did you mean 'axes.linewidth'"),
    ],
)
def test_mistakes_in_a_style_file_are_told_by_line(
    tmp_path: Path, content: str, problem: str
) -> None:
    file = tmp_path / "a.mplstyle"
    file.write_text(content)
    with pytest.raises(InvalidInputError, match=f"^{re.escape(str(file))}:{problem}"):
        picture_look(style=file)


def test_what_is_no_style_file_is_refused(tmp_path: Path) -> None:
    for name, content in (("large", b"#" * 64_001), ("binary", b"\xff\xfe\x00")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(UsageError, match=f"{name}: is "):
            picture_look(style=tmp_path / name)
    for path in (tmp_path, tmp_path / "none", Path("/dev/zero")):
        with pytest.raises(HilcError):
            picture_look(style=path)


def streams(pdf: bytes) -> bytes:
    found = b""
    for stream in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL):
        try:
            found += zlib.decompress(stream)
        except zlib.error:
            found += stream
    return found


def test_saved_files_have_the_true_size_and_embedded_fonts(make_run: MakeRun) -> None:
    look = picture_look(width="85mm", font="DejaVu Serif")
    figure = draw("error", [make_run(saturated=3)], look=look)
    assert isinstance(figure, Sheet)
    width, height = figure.get_size_inches() * figure.scale
    assert width == pytest.approx(85 * MM)

    pdf = render(figure, "pdf")
    (box,) = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", pdf)
    assert [float(side) for side in box] == pytest.approx([72 * width, 72 * height], abs=1e-6)
    assert pdf == render(draw("error", [make_run(saturated=3)], look=look), "pdf")
    assert b"/Type3" not in pdf and b"/Subtype /Type42" not in pdf
    fonts = set(re.findall(rb"/BaseFont /(\S+)", pdf))
    assert {font.split(b"+")[-1] for font in fonts} == {b"DejaVuSerif", b"DejaVuSerif-Bold"}
    descriptors = pdf.count(b"/Type /FontDescriptor")
    assert descriptors == pdf.count(b"/FontFile2") == len(fonts)
    assert pdf.count(b"/Subtype /CIDFontType2") == len(fonts), "TrueType"
    # Nothing is cut off at a page that is smaller than the layout.
    content = streams(pdf)
    assert b"%.10g 0 0 %.10g 0 0 cm" % (figure.scale, figure.scale) in content
    (axes,) = figure.axes
    top = axes.get_position().y1 * figure.get_size_inches()[1] * 72
    assert max(float(y) for y in re.findall(rb" ([\d.]+) l$", content, re.M)) > top - 1

    svg = render(figure, "svg").decode()
    tag = re.findall(r"<svg[^>]*>", svg)[0]
    sizes = {name: float(value) for name, value in re.findall(r'(width|height)="([\d.]+)pt"', tag)}
    assert sizes == pytest.approx({"width": 72 * width, "height": 72 * height}, rel=1e-5)
    with Image.open(BytesIO(render(figure, "png", 300))) as image:
        dots = [side / dpi for side, dpi in zip(image.size, image.info["dpi"], strict=True)]
    assert dots == pytest.approx([width, height], abs=1.01 / 300)


def smallest_text(figure: Sheet) -> float:
    """Size on paper of the smallest text that is there [pt]."""
    found = [
        float(text.get_fontsize())
        for text in figure.findobj(Text)
        if isinstance(text, Text) and text.get_text().strip() and text.get_visible()
    ]
    return min(found) * figure.scale


@pytest.mark.parametrize("width", ["85mm", "175mm"])
def test_pictures_of_runs_fit_one_column_and_two(make_run: MakeRun, width: str) -> None:
    look = picture_look(width=width)
    one = [make_run("a-name-of-some-length", saturated=3)]
    several = [
        make_run("a-long-name-of-a-run-with-many-letters", saturated=3),
        make_run("b", reference=straight(), saturated=1, diverged_at=4),
        make_run("another-name"),
    ]
    for runs in (one, several):
        for kind in kinds_of(runs):
            figure = draw(kind, runs, look=look)
            assert isinstance(figure, Sheet)
            inches = read_width(width) / 0.0254
            assert figure.get_size_inches()[0] * figure.scale == pytest.approx(inches)
            assert overlaps(figure) == [], (kind, len(runs))
            assert smallest_text(figure) > 6.5, kind


def test_without_titles_only_notes_and_what_tells_panels_apart_stay(make_run: MakeRun) -> None:
    look = picture_look(title=False)
    run = make_run("circle", diverged_at=4)
    with_titles, without = (draw("error", [run], look=each) for each in (USUAL, look))
    assert texts(without).strip() == "diverged to non-finite values in iteration 4"
    assert without.get_size_inches()[0] == with_titles.get_size_inches()[0]
    assert without.get_size_inches()[1] < with_titles.get_size_inches()[1] - 0.3
    grid = draw("path-change", [make_run("one"), make_run("two")], look=look)
    assert texts(grid).split() == ["one", "two"]
    assert overlaps(without) == overlaps(grid) == []


def test_a_look_that_asks_for_nothing_changes_nothing(make_run: MakeRun) -> None:
    assert picture_look() == USUAL
    figures = [draw("summary", [make_run()], look=look) for look in (USUAL, picture_look())]
    assert render(figures[0], "png", 40) == render(figures[1], "png", 40)
    assert Look(width=0.085, font="A B", font_size=7, title=False).options == (
        " --width 85mm --font 'A B' --font-size 7 --no-title"
    )


@pytest.mark.parametrize(
    ("width", "font_size", "least", "most"),
    [("60mm", 12.0, "90", "8"), ("85mm", 20.0, "150", "11.3"), ("120mm", 30.0, "225", "16")],
)
def test_text_that_leaves_no_room_is_refused(
    width: str, font_size: float, least: str, most: str
) -> None:
    with pytest.raises(UsageError) as error:
        picture_look(width=width, font_size=font_size)
    assert str(error.value) == (
        f"--width {width}: is too narrow for text of {font_size:g} points; give {least}mm or "
        f"more, or a --font-size of {most} or less"
    )
    assert picture_look(width=f"{least}mm", font_size=font_size).font_size == font_size
