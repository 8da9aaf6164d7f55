"""Sentences of boards come to the port of their replies: they are handed on with stamp and sender, replies are not."""

import socket

import pytest

from drawbar.machine.hardware.sentences import RelayedSentences, SentenceRelay
from drawbar.transports.base import Received

SENTENCE = b"$PANDA,120000.00*00\r\n"
REPLY = bytes.fromhex("80817EFD08")


class Line:
    """A socket of boards, as far as a relay asks it."""

    connected, trouble = True, "of the line"

    def __init__(self):
        self.arrived, self.sent, self.closed = [], [], False

    def fileno(self):
        return 7

    def read(self):
        arrived, self.arrived = self.arrived, []
        return arrived

    def write_to(self, data, peer):
        self.sent.append((data, peer))
        return True

    def close(self):
        self.closed = True


@pytest.fixture
def path(tmp_path):
    return str(tmp_path / "sentences")


def test_sentences_are_handed_on_as_they_came_and_replies_stay(path):
    line = Line()
    relay, heard = SentenceRelay(line, path), RelayedSentences(path)
    sentence = Received(12.345, SENTENCE, "192.168.5.126:5120")
    reply = Received(12.346, REPLY, "192.168.5.126:8888")
    line.arrived = [sentence, reply, sentence]
    assert relay.read() == [reply]
    assert heard.read() == [sentence, sentence]
    assert heard.read() == []
    assert relay.write_to(b"x", ("192.168.5.126", 8888))
    assert line.sent == [(b"x", ("192.168.5.126", 8888))]
    assert (relay.connected, relay.trouble, relay.fileno()) == (True, "of the line", 7)
    assert not heard.write_to(b"x", ("0.0.0.0", 0))
    assert "2233" in heard.trouble
    relay.close()
    heard.close()
    assert line.closed
    RelayedSentences(path).close()  # the path is free again


def test_replies_are_heard_whether_or_not_anybody_takes_the_sentences(path):
    line, reply = Line(), Received(1.0, REPLY, "192.168.5.126:8888")
    relay = SentenceRelay(line, path)
    line.arrived = [Received(1.0, SENTENCE, "192.168.5.126:5120"), reply]
    assert relay.read() == [reply], "nobody is there"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as deaf:
        deaf.bind(path)
        line.arrived = [Received(1.0, SENTENCE, "192.168.5.126:5120")] * 5000 + [reply]
        assert relay.read() == [reply], "somebody is there who does not read"
    relay.close()
