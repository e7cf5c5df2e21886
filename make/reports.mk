# Reports: documents with measured tables, plots and raw data, which the package reports writes to docs/reports. Offers
# accuracy, curve, curve-full and scale.

.PHONY: accuracy curve curve-full scale

REPORTS := $(CARGO) run --release --quiet --package reports -- --output docs/reports

## accuracy: what the models are worth, against random walks: docs/reports/accuracy.md and its pictures (two hours; exact images stay in OUT)
accuracy: build
	$(REPORTS) accuracy --programs $(BIN) --truths '$(OUT)/truth'

# The folder in which `make curve` finds bunny.glb and dragon.glb, with peers/ in the folder above. Without them it
# renders a scene of data/.
MESHES ?= data/scenes
CURVE  := $(REPORTS) speed --meshes $(MESHES) --programs $(BIN) --truths '$(OUT)/truth'

## curve: time against error: docs/reports/speed.md with its plots and raw data (minutes; MESHES=folder of bunny.glb, dragon.glb)
curve: build
	$(CURVE)

## curve-full: the same with larger clouds and more runs (an hour)
curve-full: build
	$(CURVE) --full

## scale: what sizes cost, and what that says of farms: docs/reports/scale.md (minutes)
scale: build
	$(REPORTS) scale --programs $(BIN)
