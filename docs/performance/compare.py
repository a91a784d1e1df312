"""Medians over rounds of what Takt and its peers took, and the ratios of each build of Takt to each peer.

python compare.py FIGURES UNIT

One line a figure: build, name, value. A name that ends in "value" is a result to compare, not a time.
"""

import statistics
import sys

file, unit = sys.argv[1:]
figures = {}
with open(file) as lines:
    for line in lines:
        build, name, value, *_ = line.split()
        figures.setdefault(name, {}).setdefault(build, []).append(float(value))
for name, builds in figures.items():
    is_time = not name.endswith("value")
    medians = {build: statistics.median(values) for build, values in builds.items()}
    suffix = f" {unit}" if is_time else ""
    print(name + ": " + ", ".join(f"{build} {median:.9g}{suffix}" for build, median in medians.items()))
    if not is_time:
        continue
    for ours in (build for build in builds if build.startswith("takt")):
        for peer in (build for build in builds if not build.startswith("takt")):
            ratios = sorted(mine / theirs for mine, theirs in zip(builds[ours], builds[peer]))
            print(f"    {ours} over {peer}: {statistics.median(ratios):.3f} ({ratios[0]:.3f} to {ratios[-1]:.3f} by round)")
