"""Writes vectors.json: frames of foreign.dbc with their values, as cantools has them.

    python3 dbc/tests/codec/vectors.py

Raw values are drawn with a fixed seed and from the ends of each signal. cantools makes the payload
of them, and gives the physical values that the payload has.
"""

import json
import math
import pathlib
import random

import cantools

FOLDER = pathlib.Path(__file__).parent
FRAMES = 40


def raw_values(signal, number, draw):
    """One raw value: the ends of the signal first, then anything."""
    if signal.is_float:
        # Numbers that a float of 32 bits holds.
        return [0.0, 1.5, -2.25][number] if number < 3 else draw.randint(-(2**20), 2**20) / 1024
    low = -(2 ** (signal.length - 1)) if signal.is_signed else 0
    high = low + 2**signal.length - 1
    return [low, high, 0][number] if number < 3 else draw.randint(low, high)


def page(message, number):
    """The signals of one page of a message, and the selectors that choose it."""
    if message.name == "Pages":
        return [["Position", {"Page": 1}], ["Speed", {"Page": 2}]][number % 2]
    if message.name == "Nested":
        return ["Deep", {"Outer": 3, "Inner": [20, 24, 22, 30][number % 4]}]
    return [None, {}]


def main():
    database = cantools.database.load_file(FOLDER / "foreign.dbc", strict=True)
    draw = random.Random(2611)
    vectors = []
    for message in database.messages:
        for number in range(FRAMES):
            chosen, selectors = page(message, number)
            raw = dict(selectors)
            for signal in message.signals:
                is_here = signal.multiplexer_ids is None or signal.name == chosen
                if is_here and signal.name not in raw:
                    raw[signal.name] = raw_values(signal, number, draw)
            data = message.encode(raw, scaling=False, strict=False)
            values = message.decode(data, decode_choices=False)
            assert all(math.isfinite(value) for value in values.values())
            absent = [s.name for s in message.signals if s.name not in values]
            vectors.append({
                "message": message.name,
                "id": message.frame_id,
                "is_extended": message.is_extended_frame,
                "data": data.hex(),
                "values": {name: float(value) for name, value in values.items()},
                "absent": absent,
            })
    text = ",\n".join(json.dumps(vector) for vector in vectors)
    (FOLDER / "vectors.json").write_text(f"[\n{text}\n]\n")


if __name__ == "__main__":
    main()
