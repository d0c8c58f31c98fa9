"""Check yawbench.dbc against the codec with cantools, in both directions.

usage: dbc_check.py DBC COUNT SEED < frames.jsonl > made.jsonl

Reads frames of the codec, one JSON object a line:
    {"id": 257, "fd": false, "brs": false, "data": "1843...", "signals": {"state": "RUN", ...}}
and exits with 1 at the first one that cantools reads differently. Then writes COUNT frames for
every message of the DBC in the same form, encoded by cantools (strict) from random and extreme
values, for the codec to read. The CRCs are computed here, as the DBC's comments describe them.
"""

import json
import random
import sys

import cantools


def crc8(data):
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def crc_of(message, data):
    """The CRC of a payload, None when the message has none."""
    if "crc" not in message.signal_tree:
        return None
    data_id = message.dbc.attributes["DataID"].value.to_bytes(2, "big")
    width = message.get_signal_by_name("crc").length // 8
    return (crc8 if width == 1 else crc16)(data_id + data[width:])


def is_fd_with_switch(message):
    # Older versions of cantools know no message.is_fd; 14 is StandardCAN_FD.
    values = {name: item.value for name, item in message.dbc.attributes.items()}
    return values.get("VFrameFormat") == 14, values.get("CANFD_BRS") == 1


def same(signal, found, expected):
    if isinstance(expected, str):
        return str(found) == expected
    if not isinstance(found, (int, float)):
        return False
    return abs(found - expected) <= 1e-3 * signal.scale


def check(database, line):
    frame = json.loads(line)
    message = database.get_message_by_frame_id(frame["id"])
    data = bytes.fromhex(frame["data"])
    if (frame["fd"], frame["brs"]) != is_fd_with_switch(message):
        sys.exit(f"{message.name}: frame format differs: {line}")
    found = message.decode(data, allow_truncated=False)
    if found.pop("crc", None) != crc_of(message, data):
        sys.exit(f"{message.name}: crc differs: {line}")
    if set(found) != set(frame["signals"]):
        sys.exit(f"{message.name}: signals differ: {found}")
    for name, expected in frame["signals"].items():
        if not same(message.get_signal_by_name(name), found[name], expected):
            sys.exit(f"{message.name}.{name}: cantools reads {found[name]!r}, sent {expected!r}")


def draw(rng, message, signal):
    """A value for a signal: named where it has names, else a number up to its limits."""
    names = list((signal.choices or {}).values())
    if signal.name == "sender":
        return message.frame_id & 0xF
    if signal.name == "counter":
        names = []
    if names and signal.name != "code" and signal.scale == 1 and len(names) > 1:
        return str(rng.choice(names))
    if names and rng.random() < 0.2:
        return str(rng.choice(names))
    low = round(signal.minimum / signal.scale)
    high = round(signal.maximum / signal.scale)
    code = rng.choice([low, high, rng.randint(low, high), rng.randint(low, high)])
    # A number that has a name is read as the name.
    return str(signal.choices[code]) if code in (signal.choices or {}) else code * signal.scale


def make(rng, message):
    values = {s.name: draw(rng, message, s) for s in message.signals if s.name != "crc"}
    if "crc" in message.signal_tree:
        blank = message.encode({**values, "crc": 0}, strict=True)
        data = message.encode({**values, "crc": crc_of(message, blank)}, strict=True)
    else:
        data = message.encode(values, strict=True)
    fd, brs = is_fd_with_switch(message)
    frame = {"id": message.frame_id, "fd": fd, "brs": brs, "data": data.hex(), "signals": values}
    print(json.dumps(frame))


def main():
    path, count, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    database = cantools.database.load_file(path, strict=True)
    checked = 0
    for line in sys.stdin:
        check(database, line)
        checked += 1
    rng = random.Random(seed)
    for message in database.messages:
        for _ in range(count):
            make(rng, message)
    print(f"cantools {cantools.__version__}: {checked} frames checked", file=sys.stderr)


main()
