# SPDX-License-Identifier: AGPL-3.0-or-later
"""dragged_difference.py PLAN OBJECT OTHER STEP_MM STEPS

Drags an object of a plan to the left as a page does, and prints as JSON what each picture of its difference to
another object states: {"steps": [{"to", "only_moved_mm3", "only_other_mm3", "common_mm3"}], "pictures": how many
of them differ}. The program is OCTOTOMY_PROGRAM."""
import json
import os
import sys

from window import Server, Window


def main(plan, moved, other, step_mm, steps):
    server = Server(os.environ["OCTOTOMY_PROGRAM"], ".", plan)
    try:
        window = Window(server)
        window.ask("evaluate")
        said, pictures = [], set()
        for step in range(1, int(steps) + 1):
            preview = {"object": moved, "of": moved, "move": {"by": {"left_mm": float(step_mm) * step}},
                       "against": [], "difference": other}
            header, parts = window.ask("pane", pane=0, kind="view", view="anterior", size=[160, 120], dragging=True,
                                       objects=[{"id": moved}, {"id": other}], preview=preview)
            window.send_bytes(json.dumps({"do": "shown", "pane": 0, "frame": header["id"]}).encode())
            said.append(header["difference"])
            pictures.add(parts["jpeg"])
        print(json.dumps({"steps": said, "pictures": len(pictures)}))
    finally:
        server.kill()


if __name__ == "__main__":
    main(*sys.argv[1:])
