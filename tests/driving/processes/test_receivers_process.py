"""The receivers' process: what it says of the corrections, for the operator to read."""

import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.driving.messaging.datagrams import CorrectionsFailure, unpack
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import CONSOLE, ProcessOptions
from drawbar.driving.processes.shutdown import environment
from drawbar.driving.stand_in.demonstration import free_ports, with_stand_ins
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="drives are for Linux")


def test_why_no_corrections_come_is_said(tmp_path: Path) -> None:
    (port,) = free_ports(socket.SOCK_STREAM, 1)
    configuration = with_stand_ins(load_configuration("articulated"))
    corrections = CorrectionsSettings(host="127.0.0.1", port=port, mount="MP1")
    devices = configuration.devices.model_copy(update={"corrections": corrections})  # type: ignore[union-attr]
    file = tmp_path / "config.toml"
    file.write_text(configuration.model_copy(update={"devices": devices}).to_toml(), "utf-8")
    with tempfile.TemporaryDirectory() as folder:  # a socket's path is short
        options = ProcessOptions(folder=folder, run=str(tmp_path), configuration=str(file), stand_ins=False, pace=1)
        console = Endpoint(options.socket(CONSOLE))
        command = [sys.executable, "-m", "drawbar.driving.processes.receivers_main"]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(), text=True
        ) as process:
            assert process.stdin is not None
            assert process.stderr is not None
            process.stdin.write(options.model_dump_json())
            process.stdin.close()
            said = next((line for line in process.stderr if str(port) in line), "")
            shown: list[object] = []
            end = time.monotonic() + 30.0
            while (
                not any(isinstance(each, CorrectionsFailure) and each.text for each in shown) and time.monotonic() < end
            ):
                shown += map(unpack, console.receive())
                time.sleep(0.02)
            process.terminate()
        console.close()
    assert said.startswith(f"receivers: the caster 127.0.0.1:{port}: Connection refused; next attempt in 1 s")
    assert CorrectionsFailure(f"the caster 127.0.0.1:{port}: Connection refused") in shown
