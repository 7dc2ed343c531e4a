"""Names of classes and systems in a sentence."""

VOWELS = "aeiouAEIOU"


def with_article(name: str) -> str:
    """A name behind its indefinite article: `an oscillator`, `a gear_pair`."""
    return f"{'an' if name[:1] in VOWELS else 'a'} {name}"
