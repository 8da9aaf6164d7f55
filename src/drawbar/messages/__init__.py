"""Messages between the processes of `drawbar drive` (docs/messages.md); `records.py` makes bytes of them.

Times are the machine's monotonic clock in ns, the same in all of its processes; angles in rad, left positive.
"""

from drawbar.messages.base import Message
from drawbar.messages.controller import CommandMessage, ControllerState, Mode
from drawbar.messages.fixes import Fixes, ReceiverReport
from drawbar.messages.gate import GateState, SupervisorState
from drawbar.messages.heartbeat import Heartbeat, Role
from drawbar.messages.kinds import KIND_OF, KINDS, Kind
from drawbar.messages.operator import Action, OperatorMessage

__all__ = [
    "KINDS",
    "KIND_OF",
    "Action",
    "CommandMessage",
    "ControllerState",
    "Fixes",
    "GateState",
    "Heartbeat",
    "Kind",
    "Message",
    "Mode",
    "OperatorMessage",
    "ReceiverReport",
    "Role",
    "SupervisorState",
]
