"""A small gear measurement that each test may spoil."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.load import load_measurement

RATE = 20000.0
SPEED = 188.49555921538757  # rad/s, 1800 rpm


class Bench:
    """A folder with run_1.csv and the content of its measurement.yaml."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        time = np.arange(400) / RATE
        error = 8.0 + 2.0 * np.sin(2 * np.pi * 600 * time) + 0.3 * np.cos(2 * np.pi * 2313.7 * time)
        self.columns = {"t": time, "dte": error, "T1": 150 + np.sin(40 * time), "theta1": SPEED * time}
        self.content = {
            "system": "gear_pair",
            "parameters": {"module": {"value": 3, "unit": "mm"}, "torque_gain": {"value": 1.0}},
            "records": [
                {
                    "file": "run_1.csv",
                    "role": "fit",
                    "channels": {
                        "time": {"column": "t", "unit": "s"},
                        "transmission_error": {"column": "dte", "unit": "um"},
                        "pinion_torque": {"column": "T1", "unit": "N*m"},
                        "gear_torque": "balanced",
                        "pinion_angle": {"column": "theta1", "unit": "rad"},
                    },
                }
            ],
        }

    @property
    def record(self) -> dict:
        return self.content["records"][0]

    @property
    def channels(self) -> dict:
        return self.record["channels"]

    def add_record(self, **changes: object) -> dict:
        record = {**copy.deepcopy(self.content["records"][0]), **changes}
        self.content["records"].append(record)
        return record

    def write_csv(self, name: str = "run_1.csv") -> Path:
        lines = [",".join(self.columns)]
        lines += [",".join(f"{value:.17g}" for value in row) for row in zip(*self.columns.values(), strict=True)]
        return self.write_lines(lines, name)

    def write_lines(self, lines: list[str], name: str = "run_1.csv") -> Path:
        path = self.folder / name
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return path

    def load(self):
        if not (self.folder / self.record["file"]).exists():
            self.write_csv()
        return self.load_as_it_is()

    def load_as_it_is(self):
        path = self.folder / "measurement.yaml"
        path.write_text(yaml.safe_dump(self.content, sort_keys=False), encoding="utf-8")
        return load_measurement(path)

    def problems(self, write: bool = True) -> list[str]:
        """The problems that loading raises, as texts."""
        with pytest.raises(InputError) as caught:
            self.load() if write else self.load_as_it_is()
        return [str(problem) for problem in caught.value.problems]

    def only_problem(self, write: bool = True) -> str:
        problems = self.problems(write)
        assert len(problems) == 1, problems
        return problems[0]

    def kinds(self) -> list[str]:
        """The kinds of the findings that make a data problem."""
        return [finding.kind for finding in self.load().findings if finding.severity == "data_problem"]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)
