"""The report of a run as one self-contained HTML page, made of the files that the run has left."""

REPORT = "report.html"
REPORTED = {  # task -> module of its report; task=explain has a page of its own
    "train": "training", "evaluate": "evaluation", "identify": "identification", "simulate": "simulation",
    "plan": "test_plan", "inspect": "inspection", "paper": "paper_study",
}  # fmt: skip
