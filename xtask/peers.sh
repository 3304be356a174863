#!/usr/bin/env bash
# Computes reference tables again with the programs that they came from, and compares them with the tables that the tests use.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/python"
"$work/python/bin/pip" install --quiet optiland==0.6.3 pyyaml tmm==0.2.0
same() {
    "$work/python/bin/python" - "$1" "$2" <<'PYTHON'
import csv, sys
ours, theirs = (list(csv.reader(open(name, encoding="utf-8"))) for name in sys.argv[1:])
assert len(ours) == len(theirs), f"{len(ours)} rows, but {len(theirs)} when computed again"
worst = 0.0
for a, b in zip(ours, theirs):
    for x, y in zip(a, b, strict=True):
        if x != y:
            worst = max(worst, abs(float(x) - float(y)) / max(1.0, abs(float(x))))
print(f"{sys.argv[1]}: {len(ours)} rows, within {worst:.1e}")
sys.exit(worst > 1e-12)
PYTHON
}
failed=0
for name in ghost-rays:ghost_rays thin-films:thin_films; do
    PYTHONWARNINGS=ignore "$work/python/bin/python" "xtask/${name#*:}.py" >"$work/table.csv"
    same "tests/data/${name%%:*}.csv" "$work/table.csv" || failed=1
done
exit $failed
