"""Sheets of many panels, as large as a journal prints them."""
