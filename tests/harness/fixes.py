"""Fixes of which a test says only what matters to it, by names such as `epoch` and `tractor_x`."""

from dataclasses import fields, replace

from drawbar.messages import Fixes, ReceiverReport


def fixes_of(otherwise=0, **given):
    """Return fixes with these values; both receivers are heard, and all else is `otherwise`."""
    report = ReceiverReport(**dict.fromkeys((each.name for each in fields(ReceiverReport)), otherwise) | {"heard": 1})
    own = dict.fromkeys((each.name for each in fields(Fixes)), otherwise)
    return altered(Fixes(**own | {"tractor": report, "trailer": report}), **given)


def altered(fixes, **given):
    """Return fixes with other values."""
    for body in ("tractor", "trailer"):
        names = [name for name in given if name.startswith(f"{body}_")]
        inner = {name.removeprefix(f"{body}_"): given.pop(name) for name in names}
        fixes = replace(fixes, **{body: replace(getattr(fixes, body), **inner)})
    return replace(fixes, **given)
