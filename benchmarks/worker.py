"""A process that holds one engine: reads JSON lines, answers JSON lines, measures its own CPU time.

    {"op": "load", "module": ..., "engine": ..., "options": {...}}  builds the engine
    {"op": "run", "keep": path or null}                             runs it once

An engine is a function of a module: engine(**options) -> a function without arguments that returns an
array of results (or None); `items` says how many things one call made.
"""

import importlib
import json
import os
import resource
import sys
import time

ANSWERS = os.fdopen(os.dup(1), "w")  # what a library prints must not mix with the answers
os.dup2(2, 1)


def main() -> None:
    call = None
    for line in sys.stdin:
        order = json.loads(line)
        try:
            if order["op"] == "load":
                module = importlib.import_module(f"benchmarks.engines.{order['module']}")
                call = getattr(module, order["engine"])(**order["options"])
                answer = {"ok": True}
            else:
                answer = measured(call, order["keep"])
        except Exception as problem:  # whatever a peer raises is its result, to be shown
            answer = {"ok": False, "why": f"{type(problem).__name__}: {problem}"[:300]}
        print(json.dumps(answer), file=ANSWERS, flush=True)


def measured(call, keep: str | None) -> dict:
    wall, cpu = time.perf_counter(), time.process_time()
    result = call()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    if keep is not None and result is not None:
        import numpy as np

        np.save(keep, np.asarray(result))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return {"ok": True, "cpu": cpu, "wall": wall, "peak_gib": peak}


if __name__ == "__main__":
    main()
