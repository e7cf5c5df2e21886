#!/usr/bin/env bash
# Runs `make check` repeatedly with new seeds, and counts its failures.
#
#     tests/check/alarms.sh [RUNS]      200 by default; the result goes to standard output
#
# OUT/alarms.log keeps the output of each run, so that a second start continues.
set -euo pipefail
cd "$(dirname "$0")/../.."

runs=${1:-200}
# Smaller seeds are those of the reference and of `make check` itself.
first=2000
out=${OUT:-out}
log=$out/alarms.log
mkdir -p "$out"
touch "$log"

for ((run = 0; run < runs; run++)); do
    seed=$((first + 8 * run))
    if grep -q "^end $seed$" "$log"; then continue; fi
    # A program that cannot judge says so on standard error and leaves no verdict, which is counted below.
    make --silent check CHECK_SEED="$seed" OUT="$out" | sed "s/^/$seed /" >>"$log" || true
    echo "end $seed" >>"$log"
    rm -rf "$out/check/s$seed-n8"
done

# The smallest p-value of each run, corrected for the number of its tests: uniform, or somewhat larger, since the tests
# of one image are correlated.
awk -v runs="$runs" '
    $2 == "FAIL" { failed[$1] = 1 }
    $2 == "PASS" {
        for (i = 3; i <= NF; i++) {
            if ($i ~ /^p=/) p = substr($i, 3) + 0
            if ($i ~ /^tests=/) tests[$1] += substr($i, 7)
        }
        if (!($1 in least) || p < least[$1]) least[$1] = p
    }
    $2 == "PASS" || $2 == "FAIL" { verdicts[$1]++ }
    END {
        for (seed in verdicts) { judged++; if (verdicts[seed] != 5) broken++ }
        print judged " runs, " length(failed) " failed, " broken + 0 " without all verdicts"
        for (seed in least) { k = int(10 * (1 - (1 - least[seed]) ^ tests[seed])); bins[k > 9 ? 9 : k]++ }
        for (k = 0; k < 10; k++) printf "corrected p %.1f to %.1f: %d runs\n", k / 10, (k + 1) / 10, bins[k]
        exit judged < runs || length(failed) > 0 || broken > 0
    }' "$log"
