"""Tests of learning on a real robot."""
