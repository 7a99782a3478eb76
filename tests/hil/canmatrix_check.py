#!/usr/bin/python3
"""Decode frames by a DBC file with canmatrix and compare with what is expected.

Usage: canmatrix_check.py DBC EXPECTED
EXPECTED has lines "MESSAGE DATA FIELD VALUE WORD", WORD being - if there is none. Status 0 if all agree; the number of
values compared is printed.
"""

import sys

import canmatrix.formats


def main():
    dbc, expected = sys.argv[1:]
    matrix = canmatrix.formats.loadp_flat(dbc)
    compared = 0
    wrong = 0
    decoded_line = None
    for line in open(expected, encoding="ascii"):
        message, data, field, value, word = line.rstrip("\n").split(" ", 4)
        if decoded_line != (message, data):
            decoded = matrix.frame_by_name(message).decode(bytes.fromhex(data))
            decoded_line = (message, data)
        signal = decoded[field]
        compared += 1
        same_value = abs(float(signal.phys_value) - float(value)) <= 1e-9 * max(1.0, abs(float(value)))
        same_word = word == "-" or signal.named_value == word
        if not (same_value and same_word):
            wrong += 1
            print(f"{line.rstrip()}: canmatrix says {signal.phys_value} {signal.named_value}")
    print(f"compared {compared}")
    return 1 if wrong else 0


sys.exit(main())
