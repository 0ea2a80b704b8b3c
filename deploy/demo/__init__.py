"""The web demo: the dashboard served to many visitors, within limits."""
