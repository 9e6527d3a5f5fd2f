"""The version of the package, which files and reports say."""

__version__ = "0.1.0"
