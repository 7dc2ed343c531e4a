"""The report of a run as one self-contained HTML page, made of the files that the run has left."""

REPORT = "report.html"
REPORTED = {"train": "training", "evaluate": "evaluation", "identify": "identification"}  # task -> module of its report
