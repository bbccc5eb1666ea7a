"""``python -m hilc_cli``."""

from hilc_cli.cli.main import main

main()
