# Our pictures beside those of Cycles, Blender's renderer, of the same spheres in the same light: docs/reports/cycles.md.
# The Python module of Blender is that of blender.mk. Offers cycles.

.PHONY: cycles

## cycles: a metal, a rough plastic and a rough translucent sphere beside Cycles: docs/reports/cycles.md (needs what blender-test needs; ten minutes)
cycles:
	@command -v python3 >/dev/null || { echo "cycles: no python3 found; install it (Debian: apt install python3)" >&2; exit 1; }
	$(CARGO) build --release --package sample-surface --package gather --quiet
	python3 -B tests/blender/beside.py --programs $(BIN) --folder $(OUT)/cycles --environment $(OUT)/blender/environment --report docs/reports
