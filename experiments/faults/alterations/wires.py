"""What happens to bytes on their way."""

RECEIVERS = ("tractor receiver", "trailer receiver")
BOARDS = ("tractor board", "trailer board")
SET_POINTS = ("tractor set point", "trailer set point")


def off(chance, start):
    return lambda now, data: []


def garbage(chance, start):
    return lambda now, data: [(0.0, chance.randbytes(len(data)))]


def delayed(by):
    return lambda chance, start: lambda now, data: [(by, data)]


def intermittent(share):
    return lambda chance, start: lambda now, data: [] if chance.random() < share else [(0.0, data)]


def duplicated(chance, start):
    return lambda now, data: [(0.0, data), (0.01, data)]


def reordered(chance, start):
    return lambda now, data: [(0.25 if chance.random() < 0.2 else 0.0, data)]


def bit_errors(share):
    def flip(data, chance):
        if chance.random() >= share:
            return data
        bit = chance.randrange(8 * len(data))
        spoilt = bytearray(data)
        spoilt[bit // 8] ^= 1 << bit % 8
        return bytes(spoilt)

    return lambda chance, start: lambda now, data: [(0.0, flip(data, chance))]


def silent_for(seconds):
    return lambda chance, start: lambda now, data: [] if now < start + seconds else [(0.0, data)]


def nan_positions(trial):
    trial.alter_links(RECEIVERS, lambda chance, start: lambda now, data: [(0.0, without_latitude(data))])


def without_latitude(data):
    """Return NMEA whose latitudes are the letters nan, with right checksums."""
    lines = []
    for line in data.split(b"\r\n"):
        body = line[1:].partition(b"*")[0].split(b",")
        if body[0].endswith(b"GGA"):
            body[2] = b"nan"
            text, total = b",".join(body), 0
            for byte in text:
                total ^= byte
            line = b"$" + text + f"*{total:02X}".encode()
        lines.append(line)
    return b"\r\n".join(lines)


def receivers_silent(trial):
    trial.device("receivers-silent")


def one_receiver_silent(trial):
    trial.device("receiver-silent")


def receivers_silent_for_1_s(trial):
    trial.alter_links(RECEIVERS, silent_for(1.0))


def receivers_silent_for_10_s(trial):
    trial.watched = 25.0
    trial.alter_links(RECEIVERS, silent_for(10.0))


def receivers_garbage(trial):
    trial.device("receivers-garbage")


def receivers_bit_errors(trial):
    trial.alter_links(RECEIVERS, bit_errors(0.2))


def receivers_lose_a_fifth(trial):
    trial.alter_links(RECEIVERS, intermittent(0.2))


def receivers_late(trial):
    trial.alter_links(RECEIVERS, delayed(0.4))


def receivers_very_late(trial):
    trial.alter_links(RECEIVERS, delayed(1.2))


def receivers_duplicated(trial):
    trial.alter_links(RECEIVERS, duplicated)


def receivers_reordered(trial):
    trial.alter_links(RECEIVERS, reordered)


def sensors_late(trial):
    trial.alter_links(["sensors"], delayed(0.35))


def board_silent(trial):
    trial.device("board-silent")


def boards_lose_a_fifth(trial):
    trial.alter_links(BOARDS, intermittent(0.2))


def boards_garbage(trial):
    trial.alter_links(BOARDS, garbage)


def board_bit_errors(trial):
    trial.alter_links(BOARDS, bit_errors(0.05))


def set_points_lost(trial):
    trial.alter_links(SET_POINTS[:1], off)


def set_points_lose_a_fifth(trial):
    trial.alter_links(SET_POINTS, intermittent(0.2))


def set_points_duplicated(trial):
    trial.alter_links(SET_POINTS, duplicated)


def set_points_late(trial):
    trial.alter_links(SET_POINTS, delayed(0.3))


def controller_bit_errors(trial):
    trial.alter_links(["controller"], bit_errors(0.05))


def controller_replayed(trial):
    trial.alter_links(["controller"], duplicated)


def controller_late(trial):
    trial.alter_links(["controller"], delayed(0.3))


def operator_garbage(trial):
    """Let every operator's message be followed by a hundred datagrams of nonsense."""
    trial.alter_links(
        ["operator"],
        lambda chance, start: (
            lambda now, data: [
                (0.0, data),
                *((0.001 * i, chance.randbytes(chance.randrange(200))) for i in range(1, 100)),
            ]
        ),
    )
