"""Random changes of files: bits, slices, numbers, tokens, nesting, encodings and magic numbers."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable
from random import Random

MOST_BYTES = 256 * 1024
NUMBERS = [
    b"9" * 400,
    b"0." + b"0" * 400 + b"1",
    b"1e" + b"9" * 30,
    *b"0 -0 -0.0 1 -1 0.5 1e-308 5e-324 1e15 1e38 1e39 1e308 -1e308 1e309 -1e999 1e-999 NaN nan "
    b"-nan Infinity -inf 127 255 256 32768 65535 65536 1000000 2147483647 2147483648 -2147483648 "
    b"4294967295 4294967296 9007199254740993 9223372036854775807 9223372036854775808 "
    b"-9223372036854775808 18446744073709551615 18446744073709551616 0x7fffffff 1e 1.2.3 1,5 --1 "
    b"0.1e+-1 00 3.14159265358979 6.283185307 180 360 90.00000001".split(),
]
WORDS = (
    b'"" null true false [] {} [[]] "\\u0000" "\\ud800" \xff\xfe \xef\xbb\xbf \x00 \xc3\x28 \r \n '
    b"\t , ; ' \" \\ / // /* */ # % & < > &#0; &#x110000; &lt; ]]> <!-- --> <![CDATA[ <!DOCTYPE "
    b"../../x /dev/zero /proc/self/mem file:///etc/hostname package://a//b . .. =1+1 \xe2\x80\xae"
).split(b" ")
MAGICS = (
    b"\x89MCAP0\r\n",
    b"PAR1",
    b"\x28\xb5\x2f\xfd",
    b"\x04\x22\x4d\x18",
    b"\x1f\x8b\x08\x00",
    b"PK\x03\x04",
    b"solid ",
    b"SOLID",
    b"<?xml version='1.0' encoding='UTF-7'?>",
    b"\x93NUMPY\x01\x00",
    b"\x7fELF",
    b"%PDF-1.7",
    b"\xff\xfe",
    b"\xfe\xff",
    b"\xef\xbb\xbf\xef\xbb\xbf",
    b"\x00\x00\x00\x00",
)
# Openings of nested values, with what closes them.
NESTINGS = (
    (b"[", b"]"),
    (b'{"a":', b"}"),
    (b'{"motions":[', b"]}"),
    (b"<a>", b"</a>"),
    (b'<frame name="a">', b"</frame>"),
    (b'<link name="a">', b"</link>"),
    (b"(", b")"),
    (b"{", b"}"),
    (b"-", b""),
    (b"!", b""),
    (b"new int[]{", b"}"),
    (b"if(true)", b""),
    (b"f(", b")"),
    (b"a.b.", b""),
    (b"List<", b">"),
    (b"/*", b"*/"),
    (b'"', b'"'),
    (b"1+", b""),
)
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
TOKEN = re.compile(rb'"[^"\n]*"|-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?|\w+|[^\w\s]')
# Balanced values without inner brackets of the same type, and elements of XML on one line.
VALUE = re.compile(rb"\{[^{}]*\}|\[[^\[\]]*\]|\([^()]*\)|<[^<>]*>|[^\n]*\n")
# Bytes that a search for a match looks at.
NEARBY = 8192
PACKED = ("<d", "<f", "<Q", "<I", "<H", "<B")
SCALES = (-1, 1e-9, 1e-3, 0.5, 0.99, 1.01, 2, 10, 1e3, 1e6, 1e12)
EXTREMES = (0.0, -0.0, 1e308, -1e308, 5e-324, float("nan"), float("inf"), float("-inf"), 1e9)


def place(rng: Random, length: int) -> int:
    """Offset in a file; heads and tails of files, which have headers and indices, are preferred."""
    low, high = rng.choice(((0, length), (0, length), (0, 256), (length - 1024, length)))
    return rng.randint(max(low, 0), min(high, length))


def span(rng: Random, data: bytes) -> tuple[int, int]:
    """Start and end of a slice, which is short in most cases."""
    start = place(rng, len(data))
    length = rng.choice((1, 4, 16, 64, 256, 4096))
    return start, min(start + rng.randint(1, length), len(data))


def match(rng: Random, pattern: re.Pattern[bytes], data: bytes) -> tuple[int, int]:
    """Start and end of a random match, or of a slice if nothing nearby matches.

    A search over megabytes without a line end would take minutes.
    """
    start = place(rng, len(data))
    found = pattern.search(data, start, start + NEARBY) or pattern.search(data, 0, NEARBY)
    return found.span() if found and found.group() else span(rng, data)


def flip_bits(rng: Random, data: bytes, _: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8, 64)) if data else 0):
        changed[min(place(rng, len(data)), len(data) - 1)] ^= 1 << rng.randrange(8)
    return bytes(changed)


def truncate(rng: Random, data: bytes, _: bytes) -> bytes:
    end = place(rng, len(data))
    return data[:end] if rng.random() < 0.8 else data[end:]


def delete_slice(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = span(rng, data)
    return data[:start] + data[end:]


def duplicate_slice(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = span(rng, data)
    return data[:end] + data[start:]


def move_slice(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = span(rng, data)
    rest = data[:start] + data[end:]
    target = place(rng, len(rest))
    return rest[:target] + data[start:end] + rest[target:]


def replace_number(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = match(rng, NUMBER, data)
    return data[:start] + rng.choice(NUMBERS) + data[end:]


def scale_number(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = match(rng, NUMBER, data)
    try:
        number = float(data[start:end]) * rng.choice(SCALES)
    except ValueError:
        return data[:start] + data[end:]
    return data[:start] + repr(number).encode() + data[end:]


def replace_token(rng: Random, data: bytes, other: bytes) -> bytes:
    start, end = match(rng, TOKEN, data)
    first, last = match(rng, TOKEN, rng.choice((data, other)))
    token = rng.choice((rng.choice(WORDS), rng.choice(NUMBERS), data[first:last], b""))
    return data[:start] + token + data[end:]


def insert_word(rng: Random, data: bytes, _: bytes) -> bytes:
    start = place(rng, len(data))
    return data[:start] + rng.choice(WORDS) + data[start:]


def copy_value(rng: Random, data: bytes, other: bytes) -> bytes:
    start, end = match(rng, VALUE, data)
    source = rng.choice((data, data, other))
    first, last = match(rng, VALUE, source)
    return data[:start] + source[first:last] + data[rng.choice((start, end)) :]


def delete_value(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = match(rng, VALUE, data)
    return data[:start] + data[end:]


def repeat(rng: Random, data: bytes, _: bytes) -> bytes:
    start, end = span(rng, data) if rng.random() < 0.5 else match(rng, VALUE, data)
    count = rng.choice((10, 100, 1000, 50_000))
    return data[:end] + data[start:end] * min(count, MOST_BYTES // max(end - start, 1)) + data[end:]


def containers(value: object) -> list[dict | list]:
    """All objects and arrays in a JSON value that are not empty."""
    if not isinstance(value, dict | list) or not value:
        return []
    inner = value.values() if isinstance(value, dict) else value
    return [value, *(each for item in inner for each in containers(item))]


def changed_json(rng: Random, value: object) -> object:
    """A JSON value with one change of a number, an element or a key."""
    all_containers = containers(value)
    target, source = rng.choice(all_containers), rng.choice(all_containers)
    values = list(source.values() if isinstance(source, dict) else source)
    # A copy, since a container must not contain itself.
    copy = json.loads(json.dumps(rng.choice(values)))
    key = rng.choice(list(target) if isinstance(target, dict) else range(len(target)))
    choice = rng.randrange(5)
    if isinstance(target[key], float | int) and choice < 3:
        target[key] *= rng.choice(SCALES)
    elif choice == 0:
        del target[key]
    elif isinstance(target, list) and choice < 4:
        target[key:key] = [copy] * rng.choice((1, 1, 2, 20))
    else:
        target[key] = copy
    return value


def change_json(rng: Random, data: bytes, other: bytes) -> bytes:
    """Changes one value, and keeps the syntax of JSON; changes a number in other texts."""
    try:
        return json.dumps(changed_json(rng, json.loads(data)), indent=1).encode()
    except (ValueError, IndexError, OverflowError, RecursionError):
        return scale_number(rng, data, other)


def splice(rng: Random, data: bytes, other: bytes) -> bytes:
    if rng.random() < 0.2:
        return data + other
    return data[: place(rng, len(data))] + other[place(rng, len(other)) :]


def nest(rng: Random, data: bytes, _: bytes) -> bytes:
    opening, closing = rng.choice(NESTINGS)
    depth = min(rng.choice((20, 130, 1000, 20_000, 100_000)), MOST_BYTES // len(opening + closing))
    start, end = match(rng, rng.choice((VALUE, TOKEN, NUMBER)), data)
    ends = closing * rng.choice((depth, depth, 0))
    return data[:start] + opening * depth + data[start:end] + ends + data[end:]


def wrong_magic(rng: Random, data: bytes, _: bytes) -> bytes:
    magic = rng.choice(MAGICS)
    rest = data[rng.choice((0, len(magic))) :]
    return magic + rest if rng.random() < 0.8 else data[: -len(magic)] + magic


def encode(rng: Random, data: bytes, _: bytes) -> bytes:
    text = data.decode("latin-1")
    return text.encode(rng.choice(("utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8-sig")))


def change_line_ends(rng: Random, data: bytes, _: bytes) -> bytes:
    ends = rng.choice((b"\r", b"\r\n", b"\n\n", b"\x0b", b" ", b"\xe2\x80\xa8", b""))
    return data.replace(b"\n", ends)


def change_separators(rng: Random, data: bytes, _: bytes) -> bytes:
    old, new = rng.choice((",;", ";,", ",\t", "\t;", ".,", " ,", ": ", "\"'"))
    return data.replace(old.encode(), new.encode(), rng.choice((-1, 1, 20)))


def pack(rng: Random, data: bytes, _: bytes) -> bytes:
    """Overwrites some bytes with an extreme binary number."""
    layout = rng.choice(PACKED)
    if layout in "<d<f":
        number: float = rng.choice(EXTREMES)
        number = number if layout == "<d" or abs(number) < 3e38 or number - number != 0 else 3e38
    else:
        bits = 8 * struct.calcsize(layout)
        powers = (1 << rng.randrange(bits), 1 << (bits - 1), 1 << bits, 0)
        number = (rng.choice(powers) + rng.choice((-1, 0, 1))) % (1 << bits)
    packed = struct.pack(layout, number)
    start = place(rng, max(len(data) - len(packed), 0))
    return data[:start] + packed + data[start + len(packed) :]


def add_to_byte(rng: Random, data: bytes, _: bytes) -> bytes:
    changed = bytearray(data)
    if data:
        index = min(place(rng, len(data)), len(data) - 1)
        changed[index] = (changed[index] + rng.choice((-16, -2, -1, 1, 2, 16, 127))) % 256
    return bytes(changed)


Operator = Callable[[Random, bytes, bytes], bytes]
COMMON: list[Operator] = [
    flip_bits,
    truncate,
    delete_slice,
    duplicate_slice,
    move_slice,
    repeat,
    splice,
    wrong_magic,
]
# Operators of texts that keep most of the grammar are more frequent.
OF_TEXT: list[Operator] = [
    *COMMON,
    *[change_json] * 8,
    *[replace_number, scale_number, replace_token, copy_value] * 3,
    *[delete_value, insert_word, nest] * 2,
    encode,
    change_line_ends,
    change_separators,
]
OF_BINARY: list[Operator] = [*COMMON, *[pack, add_to_byte, flip_bits] * 5, replace_token, encode]


def mutated(
    rng: Random, data: bytes, others: list[bytes], is_binary: bool
) -> tuple[bytes, list[str]]:
    """A file after one to three operators, and the names of these operators."""
    names = []
    for _ in range(rng.choice((1, 1, 1, 1, 2, 2, 3))):
        operator = rng.choice(OF_BINARY if is_binary else OF_TEXT)
        data = operator(rng, data, rng.choice(others))[: 2 * MOST_BYTES]
        names.append(operator.__name__)
    return data, names
