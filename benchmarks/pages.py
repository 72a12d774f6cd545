"""Measure the page that `wsgen validate --html` writes about many robots, in headless Chromium.

    python -m benchmarks.pages [RUNS]

The robots are those of `benchmarks.robots`, those that fail included. The page is opened in a new
tab each time; what is measured is when the browser has loaded it, and when a person who scrolls to
the last robot sees its plots. The second one has to start plotly.js once.
"""

from __future__ import annotations

import gzip
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.robots import MOST, WSGEN, list_robots

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from chromium import Chromium, open_chromium

LARGEST, LONGEST = 10e6, 2.0  # bytes; s
LAST = "[...document.querySelectorAll('.motion')].at(-1)"
LOADED = "performance.getEntriesByType('navigation')[0].loadEventEnd / 1000"


def chosen_robots() -> list[str]:
    """As many as are wanted, from all packages alike."""
    robots = list_robots()
    return [robots[number * len(robots) // MOST] for number in range(min(MOST, len(robots)))]


def measure(chromium: Chromium, page: Path) -> tuple[float, float, float]:
    """Seconds until the page is loaded, CPU and wall-clock, and until its last plots are seen."""
    tab = chromium.open()
    tab.call("Performance.enable", timeDomain="threadTicks")
    tab.go(page.as_uri())
    metrics = tab.call("Performance.getMetrics")["metrics"]
    (cpu,) = (one["value"] for one in metrics if one["name"] == "TaskDuration")
    loaded = tab.evaluate(LOADED)
    started = time.perf_counter()
    tab.evaluate(f"{LAST}.scrollIntoView({{behavior: 'instant'}})")
    tab.wait_for(f"{LAST}.querySelector('.plot').dataset.drawn")
    plotted = time.perf_counter() - started
    tab.close()
    return cpu, loaded, plotted


def main() -> None:
    """Measure and print a table in Markdown."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    robots = chosen_robots()
    with tempfile.TemporaryDirectory(prefix="wsgen-benchmark-") as scratch:
        page = Path(scratch) / "report.html"
        subprocess.run(
            [WSGEN, "validate", "-q", "-j", str(os.cpu_count()), *robots, "--html", str(page)],
            stdout=subprocess.DEVNULL,
            check=False,  # some robots fail
        )
        data = page.read_bytes()
        with open_chromium() as chromium:
            measured = [measure(chromium, page) for _ in range(runs)]
    cpu, loaded, plotted = (statistics.median(one) for one in zip(*measured, strict=True))
    print(f"{len(robots)} robots, median of {runs} runs\n")
    print("| | | at most |\n|---|---|---|")
    print(f"| size | {len(data) / 1e6:.1f} MB | {LARGEST / 1e6:g} MB |")
    print(f"| size, compressed as web servers do | {len(gzip.compress(data)) / 1e6:.1f} MB | |")
    print(f"| loaded, CPU time of the page | {cpu:.2f} s | {LONGEST:g} s |")
    print(f"| loaded, wall-clock | {loaded:.2f} s | {LONGEST:g} s |")
    print(f"| first plots after scrolling | {plotted:.2f} s | |")


if __name__ == "__main__":
    main()
