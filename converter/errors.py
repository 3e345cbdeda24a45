"""Errors that several parts raise."""


class ExportError(Exception):
    """A scene cannot be written for another program; the message says why."""
