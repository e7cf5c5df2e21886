# Reports: documents with measured tables, plots and raw data, which programs write. Offers accuracy, curve, curve-full and
# scale.

.PHONY: accuracy curve curve-full scale

## accuracy: what the models are worth, against random walks: docs/accuracy.md and its pictures (minutes)
accuracy:
	$(CARGO) run --release --quiet --package pipeline-tests --bin accuracy -- docs

# The folder in which `make curve` finds bunny.glb and dragon.glb, with peers/ in the folder above. Without them it renders a
# scene of data/.
MESHES ?= data/scenes
CURVE  := $(CARGO) run --release --quiet --package pipeline-tests --bin curve -- --meshes $(MESHES) --programs $(BIN) --output docs

## curve: time against error: docs/speed.md with its plots and raw data (minutes; MESHES=folder of bunny.glb, dragon.glb)
curve: build
	$(CURVE)

## curve-full: the same with larger clouds and more runs (an hour)
curve-full: build
	$(CURVE) --full

## scale: what sizes cost, and what that says of farms: docs/scale.md (minutes)
scale: build
	$(CURVE) --scale
