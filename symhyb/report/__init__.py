"""The result for people and for scripts: sentences, pictures, one HTML page, JSON and CSV."""

from symhyb.report.contract import exit_status, to_json
from symhyb.report.files import write_diagnosis, write_report, write_simulation
from symhyb.report.page import render_page

__all__ = [
    "exit_status",
    "render_page",
    "to_json",
    "write_diagnosis",
    "write_report",
    "write_simulation",
]
