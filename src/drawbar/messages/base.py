"""Base of all messages: what each begins with."""

from dataclasses import dataclass

from drawbar.messages.fields import Count, Time


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """What every record begins with."""

    sequence: Count = 0
    """one more than in the sender's last record of this kind, modulo 2³²"""
    time: Time
    """of sending, ns"""
    valid_until: Time
    """ns; later the record means nothing"""
