"""Hands calls of truecut to a HyperQueue server and waits until each has ended, well or not.

Reads {"server": folder or null, "name": text, "tasks": [{"args": [...], "stderr": file}]} from standard input. Exit
codes: 3 the package is missing, 4 there is no server.
"""

import json
import sys

try:
    from hyperqueue import Client, Job
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(3)

plan = json.load(sys.stdin)
try:
    client = Client(plan["server"])
except Exception as error:  # the package raises nothing more special
    print(error, file=sys.stderr)
    sys.exit(4)
# a task that fails must not take the others with it
job = Job(max_fails=None, name=plan["name"])
for task in plan["tasks"]:
    job.program(task["args"], stdout=None, stderr=task["stderr"])
submitted = client.submit(job)
client.wait_for_jobs([submitted], raise_on_error=False)
client.forget(submitted)
