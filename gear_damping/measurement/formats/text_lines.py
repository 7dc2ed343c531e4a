"""The lines of a text table as cells: its encoding, the sign between cells, and an end that was not written."""

import csv
import gzip
import io
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem, reading
from gear_damping.measurement.formats.cells import unit_in
from gear_damping.measurement.formats.number_texts import are_decimals_alone, is_written
from gear_damping.measurement.formats.table import refuse_size, unreadable

HEAD = 100  # rows among which the header is looked for
ENDING = 2**16  # bytes of the end of a file by which the sign between its cells is found: some thousand rows
_DELIMITERS = (";", "\t", "|", ",")  # in the order in which they are taken for it; blanks where none stands
ONE_COLUMN = "\x1f"  # the unit separator of ASCII, which no line holds: blanks part words of a name there, no cells
_ALONE = 80  # last lines that are asked whether they hold a number each
_NUMBER, IS_COMMENT = re.compile(r"\d"), re.compile(r"\s*(#|%|//)")
BEGINS = re.compile(r"^[\s;,|\"(]*[+-]?[.,]?\d")  # a line of values, which headers and remarks seldom look like
_RULED = re.compile(rb"^[ \t]*\|[ \t|:+-]+$|^[ \t]*\||[ \t]*\|[ \t]*$", re.MULTILINE)  # of a table as in Markdown
_POWER = re.compile(rb"(?<=[\d.])\*\^(?=[+-]?\d)")  # the exponent of Mathematica
# rows in brackets, as Python and Mathematica have them, perhaps behind `array(` or `data =`; what is between rows, and
# what stands before the first and behind the last
_LISTS = re.compile(rb"\s*(?:[\w.]+\s*[=(]\s*){0,2}(?:\[\s*\[|\{\s*\{)(?=[^\]}:\"]*[\]}])")
_BETWEEN_ROWS = re.compile(rb"[\]}]\s*[,;]?\s*[\[{]")
_AROUND = re.compile(rb"^[^\[{]*[\[{]\s*[\[{]|[\]}]\s*[\]}].*\Z", re.DOTALL)
# numbers in the brackets of MATLAB, below comments: `data = [0 1; 2 3];`
_MATRIX = re.compile(
    rb"\A(?P<above>(?:[ \t]*(?:%[^\n]*)?\n)*)[ \t]*[A-Za-z]\w*[ \t]*=[ \t]*\[(?P<rows>[-+.,;\w \t\n]*)\][ \t]*;?\s*\Z"
)
_HIGH = re.compile(rb"[\x80-\xff]")  # a byte of no English letter
_LETTERS = re.compile(rb"(?:[\x81-\x9f][\x40-\x7e\x80-\xfc]){2,}")  # signs, kana and most kanji of Shift-JIS
_CODED = 4096  # bytes by which the code of a text is seen, an even number
_NO_LETTER = re.compile(rb"[\0-\x08\x0e-\x19\x1b-\x1f]")  # what no text holds, and binary numbers do
_OF_WIDE = 0.5  # of the high bytes of letters of two: as few may be zero where names are long and of no English letters
_ARROW, _LONG = (
    re.compile(rb"^(\d{1,2}:\d{2}:\d{2}\.\d+) -> ", re.MULTILINE),
    1000,
)  # before a line of a serial monitor; bytes of one
_LOGGED = re.compile(
    rb"^(\d{4}-\d\d-\d\d[ T]\d\d:\d\d:\d\d),(\d{3})[ \t]+(?=[-+.\d])", re.MULTILINE
)  # `…:19,663 -0.015`
_LINE_END = re.compile(rb"\r+\n|\r")  # also written twice by a text mode, or alone as computers of the nineties did


def _last_lines(utf8: bytes) -> list[str]:
    """The whole lines of the end of a text; what a line's middle begins with says nothing of its cells."""
    ending = utf8[-ENDING:]
    _, found, whole = ending.partition(b"\n")
    return (whole if found and len(utf8) > ENDING else ending).decode("utf-8", "replace").splitlines()


class Text:
    """The content of a file as UTF-8, and the sign between its cells.

    `width` is the number of cells of its last row, `cut` what is noted of an end that is left out.
    """

    def __init__(self, path: Path, raw: bytes) -> None:
        self.path = path
        text, self.cut = _whole_lines(_utf8(path, raw))
        self.utf8 = _POWER.sub(b"e", _without_brackets(_LINE_END.sub(b"\n", text)))
        self.utf8 = _with_clocks_apart(self.utf8)
        ending = _last_lines(self.utf8)
        kept = [line for line in ending if line.strip(" \r" + "".join(_DELIMITERS)) and not IS_COMMENT.match(line)]
        last = _typical([line for line in kept if _NUMBER.search(line)] or kept[-1:])
        if ends := _line_end(last):
            self.utf8, last = (
                re.sub(rb"%s[ \t]*(?=\r?\n|$)" % re.escape(ends).encode(), b"", self.utf8),
                last.rstrip().rstrip(ends),
            )
        self.delimiter = _sign_of(last)
        if self.delimiter == ",":
            self.delimiter = _beside_decimal_commas(kept[-HEAD:], last)
        if self.delimiter == " " and _are_alone(kept):
            self.delimiter = ONE_COLUMN
        if self.delimiter == "|" and last.lstrip().startswith("|"):
            self.utf8, last = _RULED.sub(b"", self.utf8), _RULED.sub(b"", last.encode()).decode()
        self.width = max((k + 1 for k, cell in enumerate(next(self._cells([last]), [])) if cell.strip()), default=0)

    def open(self) -> io.TextIOWrapper:
        """A handle at the begin of the text."""
        return io.TextIOWrapper(io.BytesIO(self.utf8), "utf-8", newline="")

    def _cells(self, lines: Any) -> Iterator[list[str]]:
        return csv.reader(lines, delimiter=self.delimiter, skipinitialspace=True)

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Every row that is not blank, comments too, with its line number."""
        reader = self._cells(self.open())
        try:
            for row in reader:
                if any(cell.strip() for cell in row):
                    yield reader.line_num, [cell for cell in row if cell] if self.delimiter == " " else row
        except csv.Error as error:
            rule = f"line {reader.line_num} is no row of a table ({error})"
            raise InputError(Problem("file", rule, str(self.path), "export it again")) from None


def _with_clocks_apart(text: bytes) -> bytes:
    """Lines behind a clock and an arrow, as Arduino's serial monitor shows them, with the clock as a cell of its own.

    Beside names it is `clock`. The clock of Python's logging, whose comma parts no cells, is one too.
    """
    last = text.rstrip()[-_LONG:].split(b"\n")[-1]
    if found := _LOGGED.match(last):
        sign = _sign_of(last[found.end() :].decode("utf-8", "replace")).encode()
        return _LOGGED.sub(rb"\1.\2" + sign, text)
    found = _ARROW.match(last)
    if found is None:
        return text
    sign = _sign_of(last[found.end() :].decode("utf-8", "replace")).encode()
    text = re.sub(_ARROW.pattern + rb"(?=[^\W\d])", b"clock" + sign, text, flags=re.MULTILINE)
    return _ARROW.sub(rb"\1" + sign, text)


def _sign_of(line: str) -> str:
    return next((sign for sign in _DELIMITERS if sign in line), " ")


def _is_alone(line: str) -> bool:
    """Whether a line has one cell."""
    return _sign_of(line) == " " and " " not in line.strip()


def _are_alone(lines: list[str]) -> bool:
    """Whether the last lines that begin with a number have one cell each, perhaps with a unit behind a blank."""
    values = [line.strip() for line in lines if BEGINS.match(line)][-_ALONE:]
    return bool(values) and all(_is_alone(line) or unit_in(line) for line in values)


def _typical(lines: list[str]) -> str:
    """The last of the lines that have the sign of most of those that begin with a number.

    Headers hold all kinds of signs, numbers only one; so do remarks behind some of them, and below.
    """
    values = [line for line in lines if BEGINS.match(line)] or lines
    if values and not _is_alone(values[-1]):  # rows that were cut say nothing of it
        values = [line for line in values if not _is_alone(line)]
    signs = [_sign_of(line) for line in reversed(values)]
    usual = Counter(signs).most_common(1)[0][0] if signs else ""
    return next((line for line in reversed(values) if _sign_of(line) == usual), "")


def _beside_decimal_commas(lines: list[str], last: str) -> str:
    """What parts the cells of a text whose lines hold commas and no other sign: blanks, where each number has one."""
    numbers = last.split()
    if len(numbers) > 1 and all("," in one and is_written(one) for one in numbers):
        return " "
    return ONE_COLUMN if are_decimals_alone(lines[-_ALONE:]) else ","


def _line_end(line: str) -> str:
    """The sign that stands behind the last cell of a row and between no two of them; else ""."""
    body, last = line.rstrip()[:-1], line.rstrip()[-1:]
    others = [sign for sign in _DELIMITERS if sign in body]
    is_decimal = others == [","] and body.count(",") == 1 and "." not in body
    return last if last in _DELIMITERS and others and last not in others and not is_decimal else ""


def bytes_of(path: Path, max_bytes: int) -> bytes:
    """The bytes of a file, of one in gzip unpacked; raises InputError where they cannot be read or are too many."""
    if path.suffix.lower() != ".gz":
        with reading(path):
            return path.read_bytes()
    with unreadable(path, "not a readable gzip file", "pack it again, or unpack it"), gzip.open(path) as file:
        raw = file.read(max_bytes + 1)
        refuse_size(path, len(raw), max_bytes)
    return raw


def _utf8(path: Path, raw: bytes) -> bytes:
    """The text in UTF-8; older programs write µ, ° and ² in the code page of Windows, and Japanese in Shift-JIS."""
    wide = "utf-16" if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else _wide_without_a_mark(raw)
    if b"\0" in raw.rstrip(b"\0")[:4096] and not wide:
        packed = path.suffix.lower() == ".gz"
        remedy = "unpack it: of what gzip packs only text is read" if packed else "export it as CSV"
        raise InputError(Problem("file", "not a text file", str(path), remedy))
    try:
        return (
            raw[: len(raw) // 2 * 2].decode(wide).encode()
            if wide
            else raw.removeprefix(b"\xef\xbb\xbf").decode().encode()
        )
    except UnicodeDecodeError:
        return raw.decode("cp932" if _is_shift_jis(raw) else "cp1252", "replace").encode()


def _wide_without_a_mark(raw: bytes) -> str:
    """The code of a text of two bytes a letter that does not say their order; "" of any other.

    Numbers and the signs between them have a zero in one of the two and none in the other.
    """
    head = raw[:_CODED]
    for high, code in enumerate(("utf-16-be", "utf-16-le")):
        upper, lower = head[high::2], head[1 - high :: 2]
        letters = [low for up, low in zip(upper, lower, strict=False) if up == 0]
        if len(letters) > _OF_WIDE * len(lower) and not _NO_LETTER.search(bytes(letters)):
            return code
    return ""


def _is_shift_jis(raw: bytes) -> bool:
    """Whether a text can be Shift-JIS, and most of its bytes of other letters are of two such letters or more together.

    Those of two bytes begin with one that in the code page of Windows is a sign, as a quotation mark, and no letter.
    """
    try:
        raw.decode("cp932")
    except UnicodeDecodeError:
        return False
    together = sum(len(_HIGH.findall(run)) for run in _LETTERS.findall(raw))
    return 2 * together > len(_HIGH.findall(raw))


def _without_brackets(text: bytes) -> bytes:
    """Rows in brackets, `{{0, 1}, {2, 3}}`, `[[0 1] [2 3]]` or `a = [0 1; 2 3];`, as lines; any other text as it is."""
    if (matrix := _MATRIX.match(text)) is not None:
        return matrix["above"] + re.sub(rb"[ \t]*;[ \t]*\n?", b"\n", matrix["rows"].strip()) + b"\n"
    if not _LISTS.match(text):
        return text
    rows = _BETWEEN_ROWS.split(_AROUND.sub(b"", text))
    return b"\n".join(b" ".join(row.split()) for row in rows) + b"\n"


def _whole_lines(text: bytes) -> tuple[bytes, str]:
    """A text without the zeros that a recorder which lost its power left, nor a line that they cut; what is noted."""
    text = text.removesuffix(b"\x1a")  # as DOS ends a file
    whole = text.rstrip(b"\0\r\n ")
    if b"\0" not in text[len(whole) :]:
        return text, ""
    is_cut = not text[len(whole) :].startswith((b"\n", b"\r"))
    kept = whole[: whole.rfind(b"\n") + 1] if is_cut else whole
    line = " and the line before them" if is_cut else ""
    return kept, f"{text.count(0)} bytes of zero at its end{line} are left out"
