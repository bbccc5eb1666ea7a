"""Results of all kinds as one page for a browser, which needs no network."""
