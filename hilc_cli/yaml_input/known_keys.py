"""What somebody meant who wrote a key that is not known where it stands."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import get_args, get_origin

from hilc_cli.wording import near_word
from hilc_cli.yaml_input.model import Model, Step, model_in, models_in, steps_to
from hilc_cli.yaml_input.nodes import MapNode, Node, PathKeys, nearest, to_data
from hilc_cli.yaml_input.quantities import quantities_in

_MOST_SHOWN = 3
_MOST_LEVELS = 3
"""So much too far in may a key stand that is to be moved out."""
_SURELY = 0.85
"""So alike must be a word that is looked for everywhere."""
_ANY_ENTRY = "*"
_SELDOM_MEANT = ("record", "sweep")
"""Where a key of the same name stands elsewhere, that one is meant."""


@dataclass(frozen=True, slots=True)
class KnownKey:
    """A key that a file of one kind may have.

    Attributes:
        keys: The way to it; ``*`` stands for each entry of a list.
        choice: The key and its value, such as law and pid, that must have been chosen for it.
        model: What it belongs to.
        annotation: The type of its value.
    """

    keys: tuple[str, ...]
    choice: tuple[str, str] | None
    model: type[Model]
    annotation: object

    @property
    def dotted(self) -> str:
        """The key as it is written after ``--set``."""
        return ".".join(self.keys)

    @property
    def has_keys(self) -> bool:
        """Whether further keys stand below it, instead of a value behind it."""
        has_keys = bool(models_in(self.annotation)) or get_origin(self.annotation) is dict
        return has_keys and not quantities_in(self.annotation)


def known_keys(
    model: type[Model], data: object = None, *, all_choices: bool = False
) -> Iterator[KnownKey]:
    """Every key of a kind of file, the outer ones first.

    Args:
        model: What the file is validated against.
        data: What it holds, which need not be valid; it says which law is meant.
        all_choices: Give the keys of all laws instead of those of the one that is meant.
    """
    level: list[tuple[tuple[str, ...], type[Model], tuple[str, str] | None, object]]
    level = [((), model, None, data)]
    while level:
        below = []
        for keys, part, choice, held in level:
            for name, field in part.model_fields.items():
                here = (*keys, name)
                yield KnownKey(here, choice, part, field.annotation)
                if get_origin(field.annotation) is dict:
                    continue
                value = held.get(name) if isinstance(held, Mapping) else None
                models = models_in(field.annotation)
                if len(models) > 1 and not all_choices:
                    chosen = model_in(field.annotation, value)
                    models = [chosen] if chosen is not None else []
                down = (*here, _ANY_ENTRY) if _is_list(field.annotation) else here
                for each in models:
                    own = each.chosen_by() if len(models) > 1 else choice
                    below.append((down, each, own, value))
        level = below


_MAY_BE_WHOLE = frozenset({"trajectory", "sweep", "corners"})
"""Sections that may be a single value: the path of a file, nothing, or a word."""


def value_keys(model: type[Model], above: str = "") -> Iterator[str]:
    """Dotted keys of all values that a file may hold, those of all laws among them, in order.

    What is in lists, such as the segments of a trajectory, is left out: those keys have numbers.
    Some come twice, since laws share them.

    Args:
        model: What the file is validated against.
        above: What stands before each key, with a dot at its end.
    """
    for name, field in model.model_fields.items():
        parts = [] if _holds_entries(field.annotation) else models_in(field.annotation)
        if not parts or name in _MAY_BE_WHOLE or quantities_in(field.annotation):
            yield f"{above}{name}"
        for part in parts:
            yield from value_keys(part, f"{above}{name}.")


def same_word(one: str, other: str) -> bool:
    """Whether two words differ only in case, hyphens, underscores and spaces."""
    return _plain(one) == _plain(other)


def meant(tree: Node, keys: PathKeys, model: type[Model], known: Sequence[KnownKey]) -> str | None:
    """What to do about an unknown key, as the end of a message; None if nothing is near.

    Args:
        tree: The root, which need not be valid.
        keys: The way to the unknown key.
        model: What the root is validated against.
        known: The keys that a file like this may have, see `known_keys`.
    """
    step = steps_to(tree, keys[:-1], model)[-1]
    word = str(keys[-1])
    place = nearest(tree, keys)[1]
    by_option = not place.source.has_lines
    there = _with_entries(known, to_data(tree))
    if by_option and step.model is not None:
        chain = _chain(tree, keys)
        found = spelled_out(there, chain, len(keys))
        if not found and len(chain) > len(keys):
            near = near_word(word, step.fields)
            mended = [*map(str, keys[:-1]), str(near), *chain[len(keys) :]]
            found = spelled_out(there, mended, len(keys))
        if found or len(chain) > len(keys):
            return did_you_mean(found) if found else _of_other_choice(keys, chain, model)
    elif "." in word and word in {key.dotted for key in known}:
        return "in a file, write each part below the one before it, without dots"
    same = next((name for name in step.fields if same_word(name, word)), None)
    if same is not None:
        return f"did you mean '{same}'?"
    if step.model is not None and _plain(word) in step.model.other_names:
        return step.model.other_names[_plain(word)]
    if not by_option:
        misplaced = _misplaced(tree, keys, step, known)
        if misplaced is not None:
            return misplaced
    part = [name for name in step.fields if name.lower().endswith(f"_{word.lower()}")]
    near = part[0] if len(part) == 1 else near_word(word, step.fields)
    if near is not None:
        return f"did you mean '{near}'?"
    above = tuple(map(_wild, keys[:-1]))
    below_first = sorted(known, key=lambda key: key.keys[: len(above)] != above)
    return _elsewhere(word, below_first, there) or _of_other_choice(keys, [word], model)


def _elsewhere(word: str, known: Sequence[KnownKey], there: Sequence[KnownKey]) -> str | None:
    """A key of another part of the file, by another name of it or one that is surely meant.

    There are the known keys as `_with_entries` gives them.
    """
    is_known = any(key.keys[-1] == word for key in known)  # which then is meant
    for key in known:
        other = key.model.other_names.get(_plain(word))
        # Words that mean something in the entries of a list may mean anything elsewhere.
        if other is not None and not is_known and _ANY_ENTRY not in key.keys:
            above = key.keys[:-1]
            return f"{f'in {_section(above)}' if above else 'at the top level'}, {other}"
    of_entries = [key.keys for key in known if key.keys[-1] == word and _ANY_ENTRY in key.keys]
    if of_entries and all(key.keys[-1] != word for key in there):
        section = _section(of_entries[0][: of_entries[0].index(_ANY_ENTRY)])
        return f"entries of {section} may have it, and none has it here"
    near = near_word(word, {key.keys[-1] for key in there}, _SURELY)
    if near is None:
        return None
    return did_you_mean([key.dotted for key in there if key.keys[-1] == near])


def _of_other_choice(keys: PathKeys, words: Sequence[str], model: type[Model]) -> str | None:
    """A key of another place, by its last words, that needs another choice, such as a law."""
    above = tuple(map(_wild, keys[:-1]))
    every = [
        key
        for key in known_keys(model, all_choices=True)
        if key.choice is not None and key.keys[: len(keys)] != (*above, str(keys[-1]))
    ]
    found = spelled_out(every, words, len(words))
    if not found:
        return None
    choices = [key.choice for key in every if key.dotted == found[0] and key.choice is not None]
    needed = " or ".join(f"'{chooser}: {choice}'" for chooser, choice in choices)
    return f"{did_you_mean(found[:1])} It needs {needed}"


def _with_entries(known: Iterable[KnownKey], data: object) -> list[KnownKey]:
    """The keys, those within lists once for each entry that has them, with its number."""
    single, numbered = [], []
    for key in known:
        if _ANY_ENTRY not in key.keys:
            single.append(key)
            continue
        at = key.keys.index(_ANY_ENTRY)
        entries = _value(data, key.keys[:at])
        for number, entry in enumerate(entries if isinstance(entries, list) else []):
            if _value(entry, key.keys[at + 1 :]) is not None:
                keys = (*key.keys[:at], str(number), *key.keys[at + 1 :])
                numbered.append((number, replace(key, keys=keys)))
    return single + [key for _, key in sorted(numbered, key=lambda pair: pair[0])]


def _value(data: object, keys: Sequence[str]) -> object:
    for key in keys:
        data = data.get(key) if isinstance(data, Mapping) else None
    return data


def spelled_out(known: Iterable[KnownKey], words: Sequence[str], least: int = 1) -> list[str]:
    """Known keys, written out, that some words with parts left out may stand for.

    Args:
        known: The keys.
        words: What was given, from the outermost to the last.
        least: At least so many words must be among those of a key; what is left over, such as
            the place in a list, stays behind it.
    """
    known = [key for key in known if _ANY_ENTRY not in key.keys]
    for count in range(len(words), least - 1, -1):
        given, rest = [_plain(word) for word in words[:count]], words[count:]
        found = [
            key
            for key in known
            if _is_among(given, [_plain(word) for word in key.keys])
            and (not rest or _holds_entries(key.annotation))
        ]
        same = [key for key in found if len(key.keys) == count]
        found = same or [key for key in found if key.keys[0] not in _SELDOM_MEANT] or found
        if found:
            return list(dict.fromkeys(".".join((*key.keys, *rest)) for key in found))
    return []


def _is_among(given: Sequence[str], keys: Sequence[str]) -> bool:
    """Whether the words are among the keys in this order, the last one as the last."""
    left = iter(keys)
    return keys[-1] == given[-1] and all(word in left for word in given)


def _holds_entries(annotation: object) -> bool:
    """Whether places in a list, or names of the user's choice, stand below a key."""
    if get_origin(annotation) in (list, tuple, dict):
        return True
    return any(map(_holds_entries, get_args(annotation)))


def _chain(tree: Node, keys: PathKeys) -> list[str]:
    """The words of an option's key from the outermost to the last, of which one is unknown."""
    chain = [str(key) for key in keys]
    node = nearest(tree, keys)[0]
    source = node.place.source
    while isinstance(node, MapNode) and len(node.entries) == 1:
        ((key, node),) = node.entries.items()
        if node.place.source != source:
            break
        chain.append(key)
    return chain


def _misplaced(tree: Node, keys: PathKeys, step: Step, known: Sequence[KnownKey]) -> str | None:
    """Where a key of a file belongs that stands too far out, too far in, or elsewhere."""
    word, above = _plain(str(keys[-1])), tuple(map(_wild, keys[:-1]))
    places = [key.keys[:-1] for key in known if _plain(key.keys[-1]) == word]
    deeper = [
        place
        for place in places
        if place[: len(above)] == above
        and place != above
        and _ANY_ENTRY not in place[len(above) : -1]
    ]
    if deeper:
        section = _section_before(tree, keys, deeper) or (deeper[0] if len(deeper) == 1 else None)
        if section is not None and section[-1] == _ANY_ENTRY:
            return f"it is a key of entries of {_section(section)}: write it there behind '- '"
        if section is not None:
            return f"it is a key of {_section(section)}: indent it below '{section[-1]}:'"
    source = nearest(tree, keys)[1].source
    outer = [
        place
        for place in places
        if place == above[: len(place)]
        and len(above) - len(place) <= _MOST_LEVELS
        and not _has(tree, (*keys[: len(place)], str(keys[-1])))
        and nearest(tree, keys[: len(place)])[0].place.source == source
    ]
    if outer:
        return f"it is a key of {_section(outer[-1])}: indent it less"
    beside = [place for place in places if place[:-1] == above[:-1]]
    others = beside or [place for place in places if not _has(tree, (*place, str(keys[-1])))]
    if len(others) == 1 and (beside or _ANY_ENTRY not in others[0]):
        return f"it is a key of {_section(others[0])}"
    single = [place for place in others if _ANY_ENTRY not in place]
    if single:
        return did_you_mean([".".join((*place, str(keys[-1]))) for place in single])
    return None


def _section_before(
    tree: Node, keys: PathKeys, places: Sequence[tuple[str, ...]]
) -> tuple[str, ...] | None:
    """The section whose key stands nearest above an unknown key, of those that may have it."""
    node = nearest(tree, keys[:-1])[0]
    if not isinstance(node, MapNode):
        return None
    names = list(node.entries)
    depth = len(keys) - 1
    for name in reversed(names[: names.index(str(keys[-1]))]):
        for place in places:
            if place[depth] == name:
                return place
    return None


def _has(tree: Node, keys: PathKeys) -> bool:
    return nearest(tree, keys)[2]


def _section(keys: tuple[str, ...]) -> str:
    shown = [key for key in keys if key != _ANY_ENTRY]
    return f"'{'.'.join(shown)}'" if shown else "the top level"


def did_you_mean(words: Sequence[str]) -> str:
    """The question which of some words was meant."""
    *others, last = [f"'{word}'" for word in words[:_MOST_SHOWN]]
    if len(words) > _MOST_SHOWN:
        return f"did you mean {', '.join((*others, last))}, ...?"
    return f"did you mean {', '.join(others)} or {last}?" if others else f"did you mean {last}?"


def _is_list(annotation: object) -> bool:
    return get_origin(annotation) is list or any(map(_is_list, get_args(annotation)))


def _wild(key: str | int) -> str:
    return _ANY_ENTRY if isinstance(key, int) else key


def _plain(word: str) -> str:
    return word.replace("_", "").replace("-", "").replace(" ", "").lower()
