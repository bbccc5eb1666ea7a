"""Validation errors of Pydantic as problems that point into the user's files."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from pydantic import ValidationError

from hilc_cli.errors import MOST_PROBLEMS, Problem
from hilc_cli.names import NAME_PATTERN, name_remedy
from hilc_cli.wording import near_name
from hilc_cli.yaml_input.known_keys import KnownKey, known_keys, meant
from hilc_cli.yaml_input.model import Model, listed, steps_to
from hilc_cli.yaml_input.nodes import (
    ListNode,
    MapNode,
    Node,
    PathKeys,
    Place,
    Scalar,
    describe,
    nearest,
    to_data,
)
from hilc_cli.yaml_input.syntax_errors import hint

# What is wrong and what is allowed, by Pydantic's name of the error.
_MESSAGES: Mapping[str, tuple[str, str]] = {
    "string_type": ("must be text", "put it in quotes"),
    "string_too_long": ("is too long", "shorten it"),
    "bool_type": ("must be true or false", "give true or false"),
    "model_type": ("must be a mapping of keys and values", "write its keys below it"),
    "model_attributes_type": ("must be a mapping of keys and values", "write its keys below it"),
    "dict_type": ("must be a mapping of keys and values", "write its keys below it"),
    "list_type": ("must be a list", "write [..., ...] or lines that start with '- '"),
    "tuple_type": ("must be a list", "write [..., ...]"),
    "too_short": ("has too few entries", "add some"),
    "too_long": ("has too many entries", "remove some"),
}
_UNKNOWN = ("is an unknown key", None)


def problems_of(error: ValidationError, tree: Node, model: type[Model]) -> list[Problem]:
    """Each validation error as a problem at the place of the offending value in the tree."""
    found: list[tuple[Place, Problem]] = []
    every = error.errors(include_url=False)
    strange = [details["loc"] for details in every if details["type"] == "extra_forbidden"]
    known = list(known_keys(model, to_data(tree))) if strange else []
    # No more of them are told, and finding out what was meant takes a while.
    unknown = {keys: _unknown(tree, keys, model, known) for keys in strange[:MOST_PROBLEMS]}
    # With the choice that has been forgotten there, what is missing may well not be.
    unchosen = {above for _, above in unknown.values() if above is not None}
    for details in every:
        context: Mapping[str, Any] = details.get("ctx", {})
        keys: PathKeys = details["loc"]
        if keys and keys[-1] == "[key]":  # what is wrong is the key itself
            keys = keys[:-1]
            message = "is no key; give keys with dots between them, such as controller.gains.l1"
            if context.get("pattern") == NAME_PATTERN:
                message = f"is no name; {name_remedy(keys[-1])}"
            found.append(_at(tree, keys, message, point_at_key=True))
        elif details["type"] == "hilc":
            for at, problem, remedy in context["problems"]:
                # A list that is said not to be one is shown; one that does not fit is not.
                show_all = problem.startswith("must be")
                found.append(_located(tree, (*keys, *at), problem, remedy, show_all=show_all))
        elif details["type"] == "too_short" and _has_enough(tree, keys, context):
            continue  # what is wrong with its entries is told
        elif details["type"] == "too_long" and _has_decimal_commas(nearest(tree, keys)[0]):
            message = "has decimal commas, which part the entries of a list; write decimal points"
            found.append(_at(tree, keys, message))
        elif details["type"] == "missing":
            if not any(keys[: len(above)] == above for above in unchosen):
                found.append(_at(tree, keys, f"is missing; {_how_to_give(tree, keys, model)}"))
        elif details["type"] == "extra_forbidden":
            found.append(_at(tree, keys, unknown.get(keys, _UNKNOWN)[0], point_at_key=True))
        elif details["type"] == "literal_error":
            remedy = _choice(str(context["expected"]), nearest(tree, keys)[0])
            found.append(_located(tree, keys, "is not one of the choices", remedy))
        elif details["type"] == "string_pattern_mismatch":
            text = details["input"]
            problem = "has characters that are not allowed"
            problem = "has a first character that is not allowed" if text[:1] == "-" else problem
            found.append(_located(tree, keys, problem, name_remedy(text), show_all=True))
        else:
            other = (details["msg"], "correct it")
            problem, remedy = _MESSAGES.get(details["type"], other)
            found.append(_located(tree, keys, problem, remedy, show_all=True))
    found.sort(key=lambda placed: (placed[0].source.label, placed[0].line, placed[0].column))
    return [problem for _, problem in found]


def located_problem(tree: Node, keys: PathKeys, problem: str, remedy: str) -> Problem:
    """What is wrong with a value, at its place in the tree, and what is allowed."""
    return _located(tree, keys, problem, remedy)[1]


def _located(
    tree: Node, keys: PathKeys, problem: str, remedy: str, *, show_all: bool = False
) -> tuple[Place, Problem]:
    """A problem with the value that it is about, where showing that helps.

    A list or mapping is shown only if that it is one is the problem, not if it does not fit the
    rest.
    """
    node, _, found = nearest(tree, keys)
    shown = f", got {describe(node)}" if found and (show_all or isinstance(node, Scalar)) else ""
    odd = hint(node.text, quoted=node.quoted) if found and isinstance(node, Scalar) else ""
    return _at(tree, keys, f"{problem}{shown}; {remedy}{odd}".replace("?; it", "? It"))


def _has_enough(tree: Node, keys: PathKeys, context: Mapping[str, Any]) -> bool:
    """Whether a list or mapping is too short only without its wrong entries."""
    data = to_data(nearest(tree, keys)[0])
    return isinstance(data, list | dict) and len(data) >= context["min_length"]


def _has_decimal_commas(node: Node) -> bool:
    """Whether a list is of pairs without a space behind their comma, with spaces between them."""
    items = node.items if isinstance(node, ListNode) else ()
    if len(items) % 2 or not all(isinstance(item, Scalar) for item in items):
        return False
    close = [
        isinstance(one, Scalar) and other.place.column == one.place.column + len(one.text) + 1
        for one, other in pairwise(items)
    ]
    return all(close[::2]) and not any(close[1::2])


def _choice(expected: str, given: Node) -> str:
    """What to give instead: the choice that was probably meant, or all of them."""
    choices = re.findall("'([^']*)'", expected)
    text = str(given.value) if isinstance(given, Scalar) else ""
    near = near_name(text, choices)
    return f"did you mean '{near}'?" if near else "give " + expected.replace("'", "")


def _at(
    tree: Node, keys: PathKeys, message: str, *, point_at_key: bool = False
) -> tuple[Place, Problem]:
    _, place, _ = nearest(tree, keys)
    if point_at_key:
        above, _, _ = nearest(tree, keys[:-1])
        if isinstance(above, MapNode):
            place = above.key_places.get(str(keys[-1]), place)
    return place, Problem(str(place), ".".join(map(str, keys)), message)


def _how_to_give(tree: Node, keys: PathKeys, model: type[Model]) -> str:
    if isinstance(keys[-1], int):
        return "the list has too few entries"
    field = steps_to(tree, keys[:-1], model)[-1].fields.get(keys[-1])
    return f"give it ({field.description})" if field and field.description else "give it"


def _unknown(
    tree: Node, keys: PathKeys, model: type[Model], known_here: Sequence[KnownKey]
) -> tuple[str, PathKeys | None]:
    """What is wrong with an unknown key.

    Returns:
        The message; and, where the key would be known if another model had been chosen but none
        has been, the path of what has made no choice.
    """
    *above, last = steps_to(tree, keys[:-1], model)
    known = meant(tree, keys, model, known_here) or f"known: {', '.join(sorted(last.fields))}"
    step = next((step for step in (last, *reversed(above)) if step.choice), None)
    if step is None or step.choice is None:
        return f"is an unknown key; {known}", None
    chooser, chosen = step.choice
    problem = f"is an unknown key of {chooser} {chosen}"
    others = [choice[1] for choice in step.choices_with(keys)]
    if not others:
        return f"{problem}; {known}", None
    whose = f"{chooser} {others[0]}" if len(others) == 1 else f"{chooser}s {listed(others)}"
    problem += f", but one of {whose}"
    data = to_data(nearest(tree, step.keys)[0])
    if isinstance(data, dict) and data.get(chooser) is not None:
        return f"{problem}; {known}", None
    return f"{problem}; add " + " or ".join(f"'{chooser}: {other}'" for other in others), step.keys
