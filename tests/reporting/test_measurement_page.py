"""The reference of docs/measurement.md says what the declarations say."""

from pathlib import Path

from gear_damping.measurement.layout import FILES
from gear_damping.reporting.measurement_page import BEGIN, END, main, reference, with_reference
from gear_damping.schema.mappings import inner_model, names

PAGE = Path(__file__).resolve().parents[2] / "docs" / "measurement.md"


def test_the_page_is_what_the_declarations_say():
    text = PAGE.read_text(encoding="utf-8")
    assert with_reference(text) == text, "docs/measurement.md is not what the declarations say: run 'make docs'"


def test_the_reference_holds_every_key():
    said = reference()

    def look(model):
        for name, info in names(model).items():
            assert f"| `{name}` |" in said, name
            if inner := inner_model(info):
                look(inner)

    for model in FILES.values():
        look(model)


def test_what_stands_around_the_reference_is_kept(tmp_path):
    page = tmp_path / "measurement.md"
    page.write_text(f"# Mine\n\nbefore\n\n{BEGIN}\nstale\n{END}\n\nafter\n")
    assert main(["--folder", str(tmp_path)]) == 0
    text = page.read_text()
    assert text.startswith("# Mine\n\nbefore\n\n")
    assert text.endswith(f"{END}\n\nafter\n")
    assert "stale" not in text
    assert "| `lowpass` |" in text
