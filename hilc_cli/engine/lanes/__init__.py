"""Many experiments side by side in compiled code."""
