"""How the live page keeps up: first paint, first answers, and updates a second while dragging.

``python -m benchmarks.live_page [CASE] [--seconds S]`` with Playwright and a Chromium on the path.
A contact is dragged to and fro along the outline with one pointer event a frame; counted are frames
drawn, answers about the contacts and levels, which are planned meanwhile.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")

SERVE = "import sys; from experiments.cli import main; sys.exit(main())"

DRAG = """seconds => new Promise(done => {
  const drawing = document.querySelector('.contacts.drawing');
  const disc = document.querySelector("[data-contact='0'] .disc");
  const box = disc.getBoundingClientRect();
  const x = box.x + box.width / 2, y = box.y + box.height / 2;
  const send = (kind, target, dx) => target.dispatchEvent(new PointerEvent(kind, { bubbles: true,
    pointerId: 1, clientX: x + dx, clientY: y, button: 0, isPrimary: true }));
  drawing.setPointerCapture = () => {};
  send('pointerdown', disc, 0);
  const before = icage.counts(), begun = performance.now();
  let frames = 0, longest = 0, last = begun;
  const frame = now => {
    frames += 1;
    longest = Math.max(longest, now - last);
    last = now;
    send('pointermove', drawing, 60 * Math.sin(frames / 30));
    const passed = (now - begun) / 1000;
    if (passed < seconds) { requestAnimationFrame(frame); return; }
    const after = icage.counts();
    send('pointerup', drawing, 0);
    const rate = key => (after[key] - before[key]) / passed;
    done({ frames: frames / passed, longest, moves: rate('moves'), answers: rate('standings'),
      levels: rate('levels') });
  };
  requestAnimationFrame(frame);
})"""


def until(page: Any, expression: str) -> None:
    """Wait for something in the page to be true."""
    while not page.evaluate(expression):
        page.wait_for_timeout(10)


def main() -> None:
    """Print the times and rates."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", nargs="?", default="pliers")
    parser.add_argument("--seconds", type=float, default=5.0)
    args = parser.parse_args()
    program = next(filter(None, map(shutil.which, NAMES)))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        begun = time.perf_counter()
        server = subprocess.Popen(
            [sys.executable, "-c", SERVE, "explore", args.case, "--no-open"],
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert server.stdout is not None
            page.goto(server.stdout.readline().strip())
            page.wait_for_selector(".contacts .grip[points]")
            told = {"first paint": time.perf_counter() - begun}
            for words, key in (("contacts", "standing"), ("levels", "levels"), ("all", "document")):
                until(page, f"icage.state().{key} !== null")
                told[words] = time.perf_counter() - begun
            print("seconds from the command to:", {k: round(v, 2) for k, v in told.items()})
            found = page.evaluate(DRAG, args.seconds)
            print("a second, while dragging:", {k: round(v, 1) for k, v in found.items()})
        finally:
            server.terminate()
            server.wait()
            browser.close()


if __name__ == "__main__":
    main()
