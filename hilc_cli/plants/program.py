"""A plant that is another program, in any language, over standard input and output."""

from __future__ import annotations

import math
import os
import re
import select
import shutil
import signal
import subprocess
import time
import weakref
from collections.abc import Generator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from hilc_cli.errors import PlantError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.wording import printable, shortened

_LONGEST = 1000  # [bytes] of an answer
_LAST_WORDS = 400  # [bytes] kept of what it says on standard error
_AT_ONCE = 65_536  # [bytes]
_LONGEST_WAIT = 3600.0  # [s] that the system is told to wait at once
_GRACE = 1.0  # [s] to end after the end of its input, and again after it was told to
_NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@dataclass(frozen=True)
class ProgramPlant(Plant):
    """A plant whose motion another program computes.

    It is told ``start X Y HEADING DT`` at the start of each pass, which it does not answer, and
    then ``LEFT RIGHT`` for each sample, which it answers with ``X Y HEADING``: the pose one sample
    later. Numbers are in m, rad, s and rad/s, with all their digits.

    Attributes:
        robot: The platform, as the scenario tells it: nothing of it is told to the program.
        command: The program and its arguments.
        folder: Its working folder, from which a relative path of the program starts.
        timeout: How long it may take for an answer [s].
    """

    robot: Robot
    command: tuple[str, ...]
    folder: str
    timeout: float

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass with a process of its own, which ends with the pass."""
        return _pass(_Process(self), pose, sample_time)

    @contextmanager
    def session(self) -> Generator[Plant]:
        """Keeps one process for the passes of a run, one after the other."""
        process = _Process(self)
        try:
            yield _Started(self.robot, process)
        finally:
            process.end()

    def executable(self) -> str:
        """Returns the path of the program.

        Raises:
            PlantError: There is no such program.
        """
        name = self.command[0]
        has_folder = os.sep in name  # otherwise it is looked for where programs are
        path = shutil.which(Path(self.folder, name) if has_folder else name)
        if path is None:
            where = f"in {self.folder}" if has_folder else "on the PATH"
            problem = f"there is no such program {where}, or it may not be run"
            raise PlantError(name, problem)
        return str(Path(path).absolute())


@dataclass(frozen=True)
class _Started(Plant):
    """The plant of a program that runs already."""

    robot: Robot
    process: _Process

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Tells it that a pass begins."""
        return _pass(self.process, pose, sample_time)


def _pass(process: _Process, pose: Pose, sample_time: float) -> Step:
    """Starts a pass of a process."""
    process.tell("start", *pose, sample_time)
    said = returned = pose  # the last pose as the program says it, and as it is taken here
    anchor: tuple[Pose, Pose] | None = None  # a pose that it says, and where that is here

    def step(pose: Pose, left: float, right: float) -> Pose:
        nonlocal said, returned, anchor
        if not (math.isfinite(left) and math.isfinite(right)):
            return math.nan, math.nan, math.nan  # what nobody can be told
        if pose != returned:  # a disturbance has moved it, of which the program does not know
            anchor = said, pose
        x, y, heading = process.ask(left, right)
        heading += math.tau * round((said[2] - heading) / math.tau)  # it may be wrapped
        said = returned = x, y, heading
        if anchor is not None:
            returned = _moved(said, *anchor)
        return returned

    return step


def _moved(pose: Pose, before: Pose, after: Pose) -> Pose:
    """Returns a pose on a platform that has been moved from one pose to another."""
    turned = after[2] - before[2]
    cos, sin = math.cos(turned), math.sin(turned)
    x, y = pose[0] - before[0], pose[1] - before[1]
    return after[0] + (x * cos - y * sin), after[1] + (x * sin + y * cos), pose[2] + turned


class _Process:
    """A program that runs, and ends with this object at the latest.

    It has a process group of its own: what a terminal sends to the group of hilc it does not get,
    and whatever it has started ends with it.
    """

    def __init__(self, plant: ProgramPlant) -> None:
        self._name, self._timeout = plant.command[0], plant.timeout
        self._heard, self._last_words = b"", b""
        self._samples = self._passes = 0
        path = plant.executable()
        try:
            self._process = subprocess.Popen(
                plant.command,
                executable=path,
                cwd=plant.folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                bufsize=0,
                process_group=0,
            )
        except OSError as error:
            reason = error.strerror or str(error)
            raise PlantError(self._name, f"cannot be started in {plant.folder}: {reason}") from None
        self.end = weakref.finalize(self, _end, self._process)
        assert self._process.stdin is not None and self._process.stdout is not None
        assert self._process.stderr is not None
        self._input = self._process.stdin.fileno()
        self._errors = self._process.stderr.fileno()
        self._streams = select.poll()
        for stream in (self._process.stdout.fileno(), self._errors):
            self._streams.register(stream, select.POLLIN)

    def tell(self, *words: str | float) -> None:
        """Writes the line that begins a pass."""
        self._passes, self._samples = self._passes + 1, 0
        self._write(words)

    def ask(self, left: float, right: float) -> Pose:
        """Writes wheel speeds and reads the pose that comes of them.

        Raises:
            PlantError: There is no such answer in time.
        """
        self._write((left, right))
        deadline = time.monotonic() + self._timeout
        while b"\n" not in self._heard:
            if len(self._heard) > _LONGEST:
                self._fail(f"its answer is longer than {_LONGEST} bytes", self._heard)
            left_over = deadline - time.monotonic()
            if left_over <= 0:
                self._fail(
                    f"has not answered within {self._timeout:g} s; does it write each answer out "
                    "at once (flush)? A slow one needs a larger robot.plant.timeout"
                )
            self._listen(min(left_over, _LONGEST_WAIT))
        line, _, self._heard = self._heard.partition(b"\n")
        self._samples += 1
        return self._pose(line)

    def _pose(self, line: bytes) -> Pose:
        words = line.split()
        if len(words) != 3 or not all(map(_NUMBER.fullmatch, words)):
            self._fail("must answer with three numbers, x y heading", line)
        x, y, heading = map(float, words)
        if not math.isfinite(x + y + heading):
            self._fail("must answer with finite numbers", line)
        return x, y, heading

    def _write(self, words: tuple[str | float, ...]) -> None:
        self._listen(0.0)
        if self._heard:
            self._fail("has written what nobody asked for", self._heard.partition(b"\n")[0])
        line = " ".join(word if isinstance(word, str) else repr(float(word)) for word in words)
        try:
            os.write(self._input, f"{line}\n".encode())
        except OSError:
            self._fail_at_its_end()

    def _listen(self, patience: float) -> None:
        """Takes in what it says; waits so many seconds if that is nothing."""
        for stream, _ in self._streams.poll(1000 * patience):
            found = os.read(stream, _AT_ONCE)
            if not found:
                self._streams.unregister(stream)
            if stream == self._errors:
                self._last_words = (self._last_words + found)[-_LAST_WORDS:]
            elif found:
                self._heard += found
            else:
                self._fail_at_its_end()

    def _fail_at_its_end(self) -> NoReturn:
        """Raises what there is to say of a program that takes or says nothing any more."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE)
        self._hear_last_words()
        code = self._process.returncode
        if code is None:
            self._fail("has closed its input or output before it was told to end")
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        self._fail(f"has ended with {how} before it was told to")

    def _hear_last_words(self) -> None:
        """Takes in what is left on standard error."""
        errors = select.poll()
        errors.register(self._errors, select.POLLIN)
        while errors.poll(0):
            found = os.read(self._errors, _AT_ONCE)
            if not found:
                break
            self._last_words = (self._last_words + found)[-_LAST_WORDS:]

    def _fail(self, problem: str, got: bytes | None = None) -> NoReturn:
        """Raises what is wrong, where, and the last that it said on standard error."""
        shown = "" if got is None else f", got {_text(got)!r}"
        last_words = self._last_words.strip()
        said = f"; on standard error it said: {_text(last_words)}" if last_words else ""
        where = f"in sample {self._samples} of pass {self._passes}"
        raise PlantError(self._name, f"{problem}{shown} ({where}){said}")


def _text(said: bytes) -> str:
    """Returns what a program said as a text that a terminal may be given."""
    return printable(shortened(" | ".join(said.decode(errors="replace").splitlines()), 200))


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends a program: by the end of its input, or it is told to, or it is killed."""
    assert process.stdin is not None and process.stdout is not None and process.stderr is not None
    process.stdin.close()
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            process.wait(_GRACE)
            break
        except subprocess.TimeoutExpired:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, number)
    process.wait()
    process.stdout.close()
    process.stderr.close()
