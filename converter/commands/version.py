"""The version of this program."""


def version() -> str:
    """As the installed package says, or a note that it is not installed."""
    from importlib.metadata import PackageNotFoundError
    from importlib.metadata import version as installed

    try:
        return installed("whitted")
    except PackageNotFoundError:
        return "(run from its source folder, not installed)"
