"""The part of a page that a benchmark writes, between two marks."""

from pathlib import Path


def put(text: str, page: Path, begin: str, end: str) -> None:
    """Put a text between its marks; what stands around them stays."""
    whole = page.read_text(encoding="utf-8")
    head, tail = whole.split(begin)[0], whole.split(end)[1]
    page.write_text(f"{head}{begin}\n\n{text}\n\n{end}{tail}", encoding="utf-8")
