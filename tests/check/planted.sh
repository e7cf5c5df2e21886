#!/usr/bin/env bash
# Plants errors one by one into a copy of the tree; `make check` must fail for each.
#
#     tests/check/planted.sh [NAME...]      all, or those named; the table goes to standard output
#
# WORK is the folder of the copy, CARGO_TARGET_DIR that of its build: both are kept for the next run.
set -euo pipefail
cd "$(dirname "$0")/../.."

work=${WORK:-out/planted}
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/$work/target}
mkdir -p "$work"
work=$(cd "$work" && pwd)

# Errors of the sizes that `make check` detects (docs/check.md).
# name | file | extended regular expression | replacement
planted=(
  'nothing|README.md|^# |# '
  'skin2-sigma_a-green-1-percent|data/media/skin2.json|\[0.013, 0.07, 0.145\]|[0.013, 0.0707, 0.145]'
  'skin2-sigma_a-blue-1-percent|data/media/skin2.json|\[0.013, 0.07, 0.145\]|[0.013, 0.07, 0.14645]'
  'skin2-sigma_s-blue-2-percent|data/media/skin2.json|\[1.09, 1.59, 1.79\]|[1.09, 1.59, 1.8258]'
  'texture-2-percent|crates/tint/src/lib.rs|\.map\(f64::sqrt\)|.powf(0.49)'
  'skin2-eta-1-percent|data/media/skin2.json|"eta": 1.3|"eta": 1.313'
  '1-over-K-1-percent|crates/sums/src/summation.rs|sum / drawn.max\(1\) as f64|sum * 1.01 / drawn.max(1) as f64'
  'triangle-pdf-2-percent|pipeline/sample-surface/src/choice.rs|pdf_area \* self.factor\(index\)|pdf_area * self.factor(index) * 1.02'
  'lost-fresnel-entry|crates/bssrdf/src/lanes/entry.rs|if m > 0.0 \{ value \} else|if m > 0.0 \&\& value > 0.0 { 1.0 } else'
  'lost-cosine|crates/scene/src/light/area.rs|let factor = at.normal.dot\(direction\) \* |let factor = '
  'lost-fresnel-mirror|pipeline/gather/src/path.rs|branch.throughput \*= 1.0 - transmittance;|branch.throughput *= 1.0;'
  'lost-fresnel-exit|pipeline/gather/src/path.rs|state.throughput \*= transmittance;|state.throughput *= 1.0;'
  'triangle-pdf-2-percent-of-half|pipeline/sample-surface/src/choice.rs|pdf_area \* self.factor\(index\)|pdf_area * self.factor(index) * if 2 * index < self.links.len() { 1.02 } else { 1.0 }'
  'wholemilk-eta-2-percent|data/media/wholemilk.json|"eta": 1.3|"eta": 1.326'
  'candle_wax-eta-5-percent|data/media/candle_wax.json|"eta": 1.43|"eta": 1.5015'
  'marble-eta-3-percent|data/media/marble.json|"eta": 1.5|"eta": 1.545'
  'jade-eta-1-percent|data/media/jade.json|"eta": 1.6|"eta": 1.616'
  'cherry-eta-2-percent|data/media/cherry.json|"eta": 1.4|"eta": 1.428'
  'orange-eta-1-percent|data/media/orange.json|"eta": 1.4|"eta": 1.414'
  'lime-eta-1-percent|data/media/lime.json|"eta": 1.4|"eta": 1.414'
  'C_E-1-percent|crates/bssrdf/src/medium.rs|, fresnel::c_e\(eta\)\)|, 1.01 * fresnel::c_e(eta))'
  'C_phi-1-percent|crates/bssrdf/src/medium.rs|\(fresnel::c_phi\(eta\),|(1.01 * fresnel::c_phi(eta),'
  'diffusion-coefficient-1-percent|crates/bssrdf/src/medium.rs|1.0 / \(3.0 \* self.reduced_extinction|1.01 / (3.0 * self.reduced_extinction'
)

# The copy is of the working tree, not of the last commit. All of its files are new, because cargo compares times. A
# copy of an earlier run has the mark and is removed; a folder without the mark is not.
mark=$work/tree/.planted
if [ -e "$work/tree" ] && [ ! -e "$mark" ]; then
    echo "$work/tree: this script did not make it; give another folder as WORK" >&2
    exit 2
fi
rm -rf "$work/tree" && mkdir "$work/tree" && touch "$mark"
git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -m -C "$work/tree"
ln -s "$CARGO_TARGET_DIR" "$work/tree/target"

build() {
    (cd "$work/tree" && cargo build --release --quiet -p sample-surface -p gather -p compare)
}

# `true` stands in for cargo, since a full build would also make what the check does not need; make keeps what is
# unchanged.
check() {
    mkdir -p "$work/out"
    if [ -d "$work/out/nothing" ] && [ "$1" != nothing ]; then cp -al "$work/out/nothing" "$work/out/$1"; fi
    set -- CARGO=true OUT="$work/out/$1"
    make -C "$work/tree" --silent -j"$(nproc)" check-images THREADS=1 "$@" && make -C "$work/tree" check "$@"
}

# Builds and checks the copy with one error; prints the result of the check.
plant() {
    IFS='|' read -r name file pattern replacement <<<"$1"
    # Media are read by the running programs, which are built before the error is planted and not again.
    if [[ $file == data/* ]]; then build; fi
    sed -E -i "s|$pattern|$replacement|" "$work/tree/$file"
    if [ "$name" != nothing ] && cmp -s "$file" "$work/tree/$file"; then
        echo "$name: the pattern is not in $file any more" >&2
        return 2
    fi
    if [[ $file != data/* ]]; then build; fi
    code=0
    check "$name" >"$work/$name.log" 2>"$work/$name.err" || code=$?
    if [ "$name" != nothing ]; then rm -rf "$work/out/$name"; fi
    # A restored medium keeps its old time, so that nothing is built for it; restored code gets a new one, so that it is
    # built.
    if [[ $file == data/* ]]; then cp -p "$file" "$work/tree/$file"; else cp "$file" "$work/tree/$file"; fi
    echo "| $name | $([ $code = 0 ] && echo passed || echo failed) | $(verdicts "$work/$name.log") |"
    if [ "$name" = nothing ]; then [ $code = 0 ]; else [ $code != 0 ] && grep -q '^FAIL' "$work/$name.log"; fi
}

# The first failure of each scene, shortened.
verdicts() {
    sed -nE 's/^FAIL ([a-z]+)[^ ]* ([^;]*).*/\1: \2/p' "$1" | paste -sd ';' | sed 's/;/; /g'
}

missed=()
for entry in "${planted[@]}"; do
    name=${entry%%|*}
    if [ $# -gt 0 ] && ! printf '%s\n' "$@" | grep -qx -- "$name"; then continue; fi
    plant "$entry" || missed+=("$name")
done
if [ ${#missed[@]} -gt 0 ]; then
    echo "not as they should be: ${missed[*]}" >&2
    exit 1
fi
