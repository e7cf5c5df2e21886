"""Prints one line for each check."""

failures = []


def equal(what, found, expected):
    true(what, found == expected, f"found {found!r}, expected {expected!r}")


def true(what, holds, otherwise=""):
    print(f"  {'ok  ' if holds else 'FAIL'} {what}{'' if holds else ': ' + str(otherwise)}")
    if not holds:
        failures.append(what)
