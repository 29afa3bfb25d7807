"""Numbers in text are parsed as Python parses them, to the last bit."""

import random
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segcore.errors import InvalidMesh
from segcore.io.text.number_kernels import parse_floats
from segcore.io.text.words import find_words, plain_text, without_comments

decimals = st.one_of(
    st.floats(allow_nan=False).map(repr),
    st.floats(width=32, allow_nan=False).map(repr),
    st.floats(-1e6, 1e6).map("{:.8f}".format),
    st.floats(allow_nan=False, allow_infinity=False).map("{:.25e}".format),
    st.from_regex(r"[-+]?(\d{1,25}\.?\d{0,25}|\.\d{1,25})([eE][-+]?\d{1,4})?", fullmatch=True).filter(str.isascii),
)


@given(st.lists(decimals, min_size=1, max_size=20))
def test_floats_are_those_of_python(texts: list[str]) -> None:
    words = find_words(" \n".join(texts).encode())
    np.testing.assert_array_equal(words.floats(0, words.count), [float(text) for text in texts])


def test_many_random_numbers_are_read_without_python() -> None:
    rng = random.Random(7)
    texts = [repr(rng.uniform(-1, 1) * 10 ** rng.randint(-60, 60)) for _ in range(20_000)]
    words = find_words("\n".join(texts).encode())
    values, unread = np.empty(words.count), np.empty(words.count, dtype=bool)
    assert parse_floats(words.characters, words.start, values, unread) < len(texts) / 20
    np.testing.assert_array_equal(values[~unread], np.array([float(text) for text in texts])[~unread])


@given(st.integers(-(10**18) + 1, 10**18 - 1))
def test_the_middle_between_two_floats_and_its_neighbours(number: int) -> None:
    halves = [repr(number), f"{number}.5", f"{number}.50000000000000001", f"{number}.49999999999999999"]
    words = find_words(" ".join(halves).encode())
    assert words.floats(0, 4).tolist() == [float(text) for text in halves]


@given(st.lists(st.integers(-(10**30), 10**30), min_size=1, max_size=9))
def test_whole_numbers_are_exact_as_long_as_they_fit(numbers: list[int]) -> None:
    words = find_words(" ".join(map(str, numbers)).encode())
    values = words.numbers(0, words.count)
    if all(abs(number) < 10**18 for number in numbers):
        assert (values.dtype, values.tolist()) == (np.int64, numbers)
    else:
        assert values.tolist() == [float(number) for number in numbers]


@pytest.mark.parametrize(
    "word", ["", "-", ".", "+.", "1e", "1e+", "e5", "1.2.3", "1_0", "0x10", "1d5", "--1", "1-", "infin"]
)
def test_a_word_that_is_not_a_number_is_refused_with_its_line(word: str) -> None:
    words = find_words(f"1\n\n2 {word or '?'} 3".encode())
    with pytest.raises(InvalidMesh, match="Line 3"):
        words.floats(0, words.count)


@given(st.text(" \t\r\n\vab1", max_size=60), st.integers(1, 30), st.integers(0, 5))
def test_words_and_lines_are_those_of_python(text: str, times: int, begin: int) -> None:
    words = find_words((text * times).encode(), begin)
    rest = (text * times)[begin:]
    assert [words.word(i) for i in range(words.count)] == rest.split()
    lines = [line for line in rest.split("\n") if line.split()]
    assert np.diff(words.line_start).tolist() == [len(line.split()) for line in lines]
    assert words.lines_with(b"ab").tolist() == [line.split()[0] == "ab" for line in lines]


@given(st.text(" #\nab", max_size=60))
def test_comments_become_spaces_and_no_word_moves(text: str) -> None:
    lines = [line.partition("#")[0].ljust(len(line)) for line in text.split("\n")]
    assert without_comments(text.encode()).decode() == "\n".join(lines)


@given(st.binary(max_size=600))
def test_text_with_a_control_character_is_refused_with_its_byte(data: bytes) -> None:
    found = re.search(rb"[\x00-\x08\x0e-\x1f]", data.rstrip(b"\0\x1a"))
    if found is None:
        assert plain_text(data).split() == data.rstrip(b"\0\x1a").removeprefix(b"\xef\xbb\xbf").split()
    else:
        with pytest.raises(InvalidMesh, match=f"^Byte {found.start()}:"):
            plain_text(data)
