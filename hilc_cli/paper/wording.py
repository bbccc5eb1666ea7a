"""What a situation is, in words taken from the scenario that is run."""

from __future__ import annotations

import math

from hilc_cli.figures.labels import number_text
from hilc_cli.paper.contents import Situation
from hilc_cli.spec.controller import default_length
from hilc_cli.spec.hybrid import HybridController
from hilc_cli.spec.valid import Scenario


def situation_text(situation: Situation, scenario: Scenario) -> str:
    """Number, trajectory and controller of a situation, on one line."""
    controller = ", ".join([gains_text(scenario), *setting_texts(scenario)])
    return f"{_head(situation.number, situation)}: {course_text(scenario)}, {controller}"


def group_text(situation: Situation, scenario: Scenario) -> str:
    """What runs of one situation have in common: all but the gains."""
    number = situation.number.rstrip("abc")
    return ", ".join(
        [f"{_head(number, situation)}: {course_text(scenario)}", *setting_texts(scenario)]
    )


def _head(number: str, situation: Situation) -> str:
    return f"Situation {number}, Eq. {situation.equation}"


def course_text(scenario: Scenario) -> str:
    """The trajectory, and where the platform starts if not on it."""
    name = scenario.spec.trajectory.name
    if not any(scenario.spec.initial_error):
        return name
    x, y, heading = scenario.spec.start_pose
    degrees = number_text(math.degrees(heading), 4)
    return f"{name} from ({number_text(x)}, {number_text(y)}) m at {degrees}°"


def law_text(scenario: Scenario) -> str:
    """The law that the switch of Fig. 2 takes."""
    return "Eq. 21" if scenario.compensates else "Eq. 17"


def gains_text(scenario: Scenario) -> str:
    """The parameters of the law that is used."""
    controller = _of_the_paper(scenario)
    gains = controller.gains
    if scenario.compensates:
        h = default_length(controller.h, scenario.spec.trajectory.reference())
        return f"l₁ = {number_text(gains.l1)}, h = {h}"
    values = zip("₁₂₃", (gains.l1, gains.l2, gains.l3), strict=True)
    return ", ".join(f"l{index} = {number_text(value)}" for index, value in values)


def setting_texts(scenario: Scenario) -> list[str]:
    """What else tells the controller from others."""
    controller = _of_the_paper(scenario)
    texts = []
    if controller.gain_matrix == "unit":
        texts.append("matrix with R = B = 1")
    elif controller.gain_matrix != "model":
        rows = "; ".join(" ".join(map(str, row)) for row in controller.gain_matrix)
        texts.append(f"matrix [{rows}]".replace("-", "\N{MINUS SIGN}"))
    if any(scenario.spec.initial_error) and not scenario.compensates:
        texts.append("compensation off")
    limit = scenario.speed_limit
    texts.append("no speed limit" if limit is None else f"limit {number_text(limit)} rad/s")
    return texts


def _of_the_paper(scenario: Scenario) -> HybridController:
    controller = scenario.spec.controller
    assert isinstance(controller, HybridController)  # all its situations have this law
    return controller
