"""Completion of example names by a real bash, whose words end at colons."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

BIN = Path(sys.executable).parent


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "cursor", "found"),
    [
        ("hilc run example : fig6", 4, {"fig6a", "fig6i"}),
        ("hilc run example :", 3, {"fig3-circle", "figure-eight"}),
        ("hilc run exam", 2, {"example:fig3-circle"}),
        ("hilc check example : fig6", 4, {"fig6a", "fig6i"}),
        ("hilc plot --ki", 2, {"--kind"}),
        ("hilc compare --table m", 3, {"markdown"}),
    ],
)
def test_bash_gets_what_it_can_put_behind_the_cursor(
    words: str, cursor: int, found: set[str]
) -> None:
    done = subprocess.run(
        [BIN / "hilc"],
        env={
            "PATH": f"{BIN}:/usr/bin:/bin",
            "_HILC_COMPLETE": "complete_bash",
            "COMP_WORDS": words,
            "COMP_CWORD": str(cursor),
        },
        capture_output=True,
        text=True,
        timeout=30,
    )
    completions = set(done.stdout.split())
    assert found <= completions
    last = words.split()[-1].lstrip(":")
    assert all(completion.startswith(last) for completion in completions)
