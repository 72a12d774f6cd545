import json
from pathlib import Path

from reporting.test_json_report import keys
from wsgen.reporting.json_report import render_templates
from wsgen.templating.template import load_template


def test_the_documentation_lists_every_key() -> None:
    page = Path(__file__).parents[2] / "docs" / "templates.md"
    section = page.read_text(encoding="utf-8").split("## For programs")[1]
    listed = {line.split("`")[1] for line in section.splitlines() if line.startswith("| `")}
    assert listed == keys(json.loads(render_templates([load_template("simple")])))
