"""The tasks that read a measurement, and where its file lies. Nothing is imported here that takes long."""

from pathlib import Path

from gear_damping.config.locate import conf_folder

MEASURED = ("identify", "explain", "inspect")
INSPECT = "inspect"
YAML_SUFFIXES = (".yaml", ".yml")


def declares(file: Path, task: str) -> bool:
    """Whether what the task is given is a measurement.yaml: task=inspect takes bare files of data too."""
    return task in MEASURED and file.is_file() and (task != INSPECT or file.suffix.lower() in YAML_SUFFIXES)


def measurement_file(text: str) -> Path:
    """The measurement file; one that comes with the package is found from any folder."""
    path = Path(text)
    packaged = conf_folder().parent / path
    return packaged if not path.exists() and text.startswith("conf/") and packaged.exists() else path
