"""Figures, panels and situations as the captions and equations of the paper have them."""

from __future__ import annotations

import pytest

from hilc_cli.errors import UsageError
from hilc_cli.paper.contents import FIGURES, figures_named
from hilc_cli.paper.plan import plan_reproduction
from hilc_cli.paper.texts import situation_text

# Typed from the captions: letter, what it shows, number of the law. Caption 3 names no laws, and
# caption 6 gives gains only.
CAPTIONS = {
    "fig3": """
        a1 path change 45; a2 final path 45; a3 maximum error 45
        b1 path change 45; b2 final path 45; b3 maximum error 45
        c1 path change 45; c2 final path 45; c3 maximum error 45
        d1 path change 45; d2 final path 45; d3 maximum error 45
    """,
    "fig4": """
        a1 path change 46; a2 final path 46; a3 average error 46
        b1 path change 47; b2 final path 47; b3 average error 47
    """,
    "fig5": """
        a1 path change 47; a2 final path 47; a3 average error 47
        b1 path change 47; b2 final path 47; b3 average error 47
        c1 path change 47; c2 final path 47; c3 average error 47
    """,
    "fig6": """
        a path change and final path 48; b path change and final path 48
        c path change and final path 48; d path change and final path 49
        e path change and final path 49; f path change and final path 49
        g path change and final path 50; h path change and final path 50
        i path change and final path 50
    """,
    "fig7": """
        a1 path change 51; a2 final wheel speeds 51; a3 maximum error 51
        b1 path change 52; b2 final wheel speeds 52; b3 maximum error 52
        c1 path change 53; c2 final wheel speeds 53; c3 maximum error 53
        d1 path change 54; d2 final wheel speeds 54; d3 maximum error 54
    """,
    "fig8": """
        a1 path change 55; a2 final path 55; a3 maximum error 55
        b1 path change 56; b2 final path 56; b3 maximum error 56
        c1 path change 57; c2 final path 57; c3 maximum error 57
    """,
}
# Typed from situations 1 to 13 and Eqs. 45 to 57.
SITUATIONS = {
    "fig3-circle": "Situation 1, Eq. 45: circle, l₁ = 1, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig3-arc-and-line": "Situation 1, Eq. 45: arc-and-line, l₁ = 1, l₂ = 0, l₃ = 0, "
    "limit 180 rad/s",
    "fig3-cardioid": "Situation 1, Eq. 45: cardioid, l₁ = 1, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig3-spiral": "Situation 1, Eq. 45: spiral, l₁ = 1, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig4-uncompensated": "Situation 2, Eq. 46: circle from (9, 0) m at 90°, l₁ = 0.5, l₂ = 0.25, "
    "l₃ = 0.25, compensation off, limit 180 rad/s",
    "fig4-compensated": "Situation 3, Eq. 47: circle from (9, 0) m at 90°, l₁ = 0.5, h = 200, "
    "limit 180 rad/s",
    # 14 pi / 15 is 168 degrees, 31 pi / 30 is 186.
    "fig5-arc-and-line": "Situation 3, Eq. 47: arc-and-line from (4, 0) m at 90°, l₁ = 0.5, "
    "h = 200, limit 180 rad/s",
    "fig5-cardioid": "Situation 3, Eq. 47: cardioid from (2, 0) m at 168°, l₁ = 0.5, h = 200, "
    "limit 180 rad/s",
    "fig5-spiral": "Situation 3, Eq. 47: spiral from (2.5, 0) m at 186°, l₁ = 0.5, h = 200, "
    "limit 180 rad/s",
    "fig6a": "Situation 4a, Eq. 48: circle, l₁ = 0.1, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig6b": "Situation 4b, Eq. 48: circle, l₁ = 1, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig6c": "Situation 4c, Eq. 48: circle, l₁ = 10, l₂ = 0, l₃ = 0, limit 180 rad/s",
    "fig6d": "Situation 5a, Eq. 49: circle, l₁ = 0.1, l₂ = 0.5, l₃ = 0, limit 180 rad/s",
    "fig6e": "Situation 5b, Eq. 49: circle, l₁ = 0.1, l₂ = 1, l₃ = 0, limit 180 rad/s",
    "fig6f": "Situation 5c, Eq. 49: circle, l₁ = 0.1, l₂ = 10, l₃ = 0, limit 180 rad/s",
    "fig6g": "Situation 6a, Eq. 50: circle, l₁ = 0.1, l₂ = 1, l₃ = 0.1, limit 180 rad/s",
    "fig6h": "Situation 6b, Eq. 50: circle, l₁ = 0.1, l₂ = 1, l₃ = 1, limit 180 rad/s",
    "fig6i": "Situation 6c, Eq. 50: circle, l₁ = 0.1, l₂ = 1, l₃ = 20, limit 180 rad/s",
    "fig7a": "Situation 7, Eq. 51: circle, l₁ = 0.1, l₂ = 0.25, l₃ = 0.25, no speed limit",
    "fig7b": "Situation 8, Eq. 52: circle, l₁ = 0.1, l₂ = 0.25, l₃ = 0.25, limit 180 rad/s",
    "fig7c": "Situation 9, Eq. 53: circle, l₁ = 1, l₂ = 0.25, l₃ = 0.25, no speed limit",
    "fig7d": "Situation 10, Eq. 54: circle, l₁ = 0.5, l₂ = 0.25, l₃ = 0.25, limit 180 rad/s",
    "fig8a": "Situation 11, Eq. 55: circle, l₁ = 0.1, l₂ = 0.25, l₃ = 0.25, limit 180 rad/s",
    "fig8b": "Situation 12, Eq. 56: circle, l₁ = 1, l₂ = 0.5, l₃ = 0.5, matrix with R = B = 1, "
    "limit 180 rad/s",
    "fig8c": "Situation 13, Eq. 57: circle, l₁ = 0.1, l₂ = 0.25, l₃ = 0.25, "
    "matrix [0.5 0.2 B/R; cos sin −B/R], limit 180 rad/s",  # noqa: RUF001  # a true minus
}


def test_panels_are_those_of_the_captions() -> None:
    assert [figure.name for figure in FIGURES] == list(CAPTIONS)
    for figure in FIGURES:
        typed = [part.strip() for part in CAPTIONS[figure.name].replace("\n", ";").split(";")]
        found = [
            f"{panel.letter} {panel.kind} {panel.situation.equation}" for panel in figure.panels
        ]
        assert found == [part for part in typed if part]
        assert [panel.name for panel in figure.panels] == [
            figure.name + panel.letter for panel in figure.panels
        ]


def test_situations_are_those_of_the_paper() -> None:
    plan = plan_reproduction()
    told = {
        reading.name: {
            situation.scenario: situation_text(
                situation, plan.scenarios[reading.name][situation.scenario], reading
            )
            for figure in FIGURES
            for situation in figure.situations
        }
        for reading in plan.readings
    }
    assert told["literal"] == SITUATIONS
    # 7 pi / 15 is 84 degrees, 31 pi / 60 is 93; tau stands above the figure.
    read = {"168°": "84° (7π/15, printed: 14π/15)", "186°": "93° (31π/60, printed: 31π/30)"}
    for name, text in SITUATIONS.items():
        expected = text
        for printed, other in read.items():
            expected = expected.replace(printed, other)
        assert told["derivative"][name] == expected
    assert {s.spec.iterations for of in plan.scenarios.values() for s in of.values()} == {100}


@pytest.mark.parametrize("names", [["fig7", "fig3"], ["3", "7"], ["FIG3", "fig7", "3"]])
def test_figures_come_in_the_order_of_the_paper_and_once(names: list[str]) -> None:
    assert [figure.name for figure in figures_named(names)] == ["fig3", "fig7"]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("fig2", "known: fig3"), ("fig33", "known: fig3"), ("circle", "known: fig3, fig4")],
)
def test_unknown_figure_is_named_with_a_hint(name: str, hint: str) -> None:
    with pytest.raises(UsageError, match=f"^{name}: is no figure of the paper's results; {hint}"):
        figures_named(["fig3", name])


def test_some_figures_take_their_own_runs_only_and_no_claims() -> None:
    plan = plan_reproduction(["fig4"], reading="derivative")
    assert {name: list(of) for name, of in plan.scenarios.items()} == {
        "derivative": ["fig4-uncompensated", "fig4-compensated"]
    }
    assert (plan.claims, plan.steps) == ((), 3)
    assert plan_reproduction(["fig4"]).steps == 6


@pytest.mark.parametrize(
    ("name", "hint"),
    [("derivativ", "did you mean 'derivative'?"), ("D", "known: both, derivative, literal")],
)
def test_unknown_reading_is_named_with_a_hint(name: str, hint: str) -> None:
    with pytest.raises(UsageError) as raised:
        plan_reproduction(["fig4"], reading=name)
    assert str(raised.value) == f"{name}: is no reading of the paper; {hint}"


def test_plans_are_told_apart_by_figures_and_values() -> None:
    plans = [
        plan_reproduction(["fig4"]),
        plan_reproduction(["fig4", "fig5"]),
        plan_reproduction(["fig4"], overrides={"controller.b_w": 170}),
        plan_reproduction(["fig4"], reading="literal"),
        plan_reproduction(["fig4"], reading="derivative"),
    ]
    assert len({plan.checksum() for plan in plans}) == 5
    assert plans[0].checksum() == plan_reproduction(["4"]).checksum()


def test_all_figures_bring_the_claims() -> None:
    plan = plan_reproduction()
    assert len(plan.claims) > 0
    assert len({claim.name for claim in plan.claims}) == len(plan.claims)
    assert plan.steps == 2 * (25 + len(plan.claims) + 6)
