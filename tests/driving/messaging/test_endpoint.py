"""Endpoints: no call waits, what is queued keeps its order, and what is lost is counted."""

from drawbar.driving.messaging.endpoint import LARGEST_QUEUE, Endpoint


def test_no_send_waits_and_what_nobody_takes_is_counted(tmp_path):
    one, other = Endpoint(str(tmp_path / "1")), Endpoint(str(tmp_path / "2"))
    one.send(str(tmp_path / "2"), b"hello")
    one.send(str(tmp_path / "3"), b"nobody")
    assert list(other.receive()) == [b"hello"]
    assert one.lost == 1
    for _ in range(100_000):
        one.send(str(tmp_path / "2"), bytes(1000))
        if one.lost > 1:
            break
    assert one.lost == 2
    one.close()
    other.close()
    assert list(tmp_path.iterdir()) == []


def test_what_is_queued_arrives_in_order_however_late_it_is_read(tmp_path, capfd):
    one, other = Endpoint(str(tmp_path / "1")), Endpoint(str(tmp_path / "2"))
    sent = [bytes((number % 256,)) * 2000 for number in range(1500)]
    for data in sent:
        one.send_queued(str(tmp_path / "2"), data)
    taken = list(other.receive())
    assert len(taken) < len(sent)
    while len(taken) < len(sent):
        one.send_queued(str(tmp_path / "2"), b"more")
        taken += [data for data in other.receive() if data != b"more"]
    assert taken == sent
    assert one.lost == 0
    for _ in range(LARGEST_QUEUE // 2000 + 1000):
        one.send_queued(str(tmp_path / "2"), bytes(2000))
    assert one.lost > 0
    assert (
        capfd.readouterr().err == "1: the 2 does not keep up, and what it has not taken is lost; end other programs\n"
    )
    for each in (other, one):
        each.close()
