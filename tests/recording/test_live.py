"""The channels of a drive's log, live: what a viewer on this computer is told is what the file holds."""

import asyncio
import json
import struct
import sys
import threading
from contextlib import closing

import aiohttp
import pytest
from mcap.reader import make_reader

from drawbar.config import load_configuration
from drawbar.errors import HardwareError
from drawbar.geometry import LocalFrame
from drawbar.messages import CommandMessage, Mode
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import RawBytes
from drawbar.recording.header import run_header
from drawbar.recording.live import Live
from drawbar.recording.message_layout import message_reader, message_schema
from drawbar.recording.scene import Scene
from drawbar.simulation import Simulation, build_path
from drawbar.transports.tapped import Direction

PATIENCE = 120.0


@pytest.fixture
def live():
    live = Live(0)
    yield live
    live.close()


def command(sequence):
    return CommandMessage(
        sequence=sequence,
        time=10**9,
        valid_until=2 * 10**9,
        mode=Mode.IDLE,
        tractor_angle=0.1,
        trailer_angle=0.0,
        speed=1.0,
    )


async def _watch(port, topic, subscribed):
    """Subscribe to one topic; return all channels by topic, and the first message."""
    channels = {}
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(f"ws://127.0.0.1:{port}", protocols=["foxglove.sdk.v1"]) as socket,
    ):
        async for message in socket:
            if message.type is aiohttp.WSMsgType.BINARY and message.data[0] == 1:
                assert struct.unpack_from("<I", message.data, 1)[0] == 7
                return channels, message.data[13:]
            words = json.loads(message.data) if message.type is aiohttp.WSMsgType.TEXT else {}
            if words.get("op") == "advertise":
                channels |= {channel["topic"]: channel for channel in words["channels"]}
                if topic in channels and not subscribed.is_set():
                    wish = {"id": 7, "channelId": channels[topic]["id"]}
                    await socket.send_json({"op": "subscribe", "subscriptions": [wish]})
                    subscribed.set()
    raise AssertionError("the server has closed the connection")


def test_a_viewer_is_told_what_the_file_holds(live, tmp_path):
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    with closing(Simulation(configuration).steps()) as steps:
        record = next(steps)
    frame = LocalFrame(latitude=50.0, longitude=4.0)
    header = run_header(configuration, path, None, seed=0, frame=frame)
    scene, subscribed, found = Scene(path=path, vehicle=configuration.vehicle, frame=frame), threading.Event(), []

    def watch():
        found.append(asyncio.run(asyncio.wait_for(_watch(live.port, "/command", subscribed), PATIENCE)))

    with DriveLog(tmp_path / "log.mcap", header, scene, live) as log:
        log.add_message(command(0))
        log.add_step(10**9, record)
        log.add_raw(RawBytes(time=1, device="sensors", direction=Direction.IN, data=b"\x00"))
        viewer = threading.Thread(target=watch)
        viewer.start()
        sequence = 0
        while viewer.is_alive():
            subscribed.wait(0.02)
            sequence += 1
            log.add_message(command(sequence))
            viewer.join(0.02)
    channels, data = found[0]
    assert message_reader(message_schema(CommandMessage))(data)["tractor_angle"] == 0.1
    with (tmp_path / "log.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    with_schema = [channel for channel in summary.channels.values() if channel.schema_id]
    schemas = {channel.topic: summary.schemas[channel.schema_id].name for channel in with_schema}
    assert {topic: channel["schemaName"] for topic, channel in channels.items()} == schemas
    fixes = {"/tractor/fix", "/trailer/fix"}
    assert {"/step", "/path", "/bodies", "/command", "/tf", "/plan"} | fixes == set(schemas)


@pytest.mark.skipif(sys.platform != "linux", reason="reads Linux's table of sockets")
def test_only_this_computer_is_served_and_a_port_that_is_taken_is_reported(live):
    with open("/proc/net/tcp") as table:
        rows = [line.split()[1] for line in table if line.split()[1].endswith(f":{live.port:04X}")]
    assert rows == [f"0100007F:{live.port:04X}"]
    with pytest.raises(HardwareError, match="--live-port"):
        Live(live.port)
