# Scenes out of Blender (docs/blender.md), made by the Python module of Blender and rendered by our programs. The module
# is installed once, to OUT/blender/environment. Offers blender-test.

.PHONY: blender-test

## blender-test: scenes made, exported and lit by Blender's Python module (needs Python 3.11 and a network once; 400 MB; a minute)
blender-test:
	@command -v python3 >/dev/null || { echo "blender-test: no python3 found; install it (Debian: apt install python3)" >&2; exit 1; }
	$(CARGO) build --release --package sample-surface --package gather --quiet
	python3 -B tests/blender/run.py --programs $(BIN) --folder $(OUT)/blender
