"""The laws that a scenario may name, each with the model of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import ModelWrapValidatorHandler, ValidationError, WrapValidator
from pydantic_core import InitErrorDetails

from hilc_cli.laws.feedback import FeedbackController
from hilc_cli.laws.hybrid import HybridController
from hilc_cli.laws.norm_optimal.law import NormOptimalController
from hilc_cli.laws.parameters import DEFAULT_LAW, Controller, law_named
from hilc_cli.laws.pid import PidController

AnyController = HybridController | PidController | NormOptimalController | FeedbackController

CONTROLLERS: Mapping[str, type[Controller]] = {
    model.name(): model
    for model in (HybridController, PidController, NormOptimalController, FeedbackController)
}


def controller_model(data: object) -> type[Controller] | None:
    """The model of the law that parameters name; None if there is no such law."""
    if not isinstance(data, Mapping):
        return CONTROLLERS[DEFAULT_LAW]
    law = law_named(data)
    return CONTROLLERS.get(law) if isinstance(law, str) else None


def _of_its_law(data: object, handler: ModelWrapValidatorHandler[AnyController]) -> Controller:
    """Validates parameters against the model of their law alone.

    So what is wrong with them is told by the keys of that law, as if there were no others.
    """
    if isinstance(data, Controller):
        return data
    model = controller_model(data)
    if model is not None:
        return model.model_validate(data)
    assert isinstance(data, Mapping)  # anything else is given to the default law
    *others, last = (f"'{name}'" for name in CONTROLLERS)
    expected = f"{', '.join(others)} or {last}" if others else last
    wrong = InitErrorDetails(
        type="literal_error", loc=("law",), input=data["law"], ctx={"expected": expected}
    )
    raise ValidationError.from_exception_data("controller", [wrong])


ControllerSpec = Annotated[AnyController, WrapValidator(_of_its_law)]
